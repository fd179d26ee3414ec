#!/usr/bin/env bash
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# Fuzzes every parser and protocol (fuzz/) for so many minutes each, with AddressSanitizer and UBSan.
# Needs clang. What is found lies in build/fuzz/found; put it into fuzz/corpus/TARGET when it is
# mended, where every test run replays it. Inputs that reach new code are kept in build/fuzz/corpus.
#
# Usage: scripts/fuzz.sh MINUTES [TARGET...]
set -euo pipefail
cd "$(dirname "$0")/.."
minutes="${1:?how many minutes for each target?}"
shift
targets=("$@")
if [ "${#targets[@]}" -eq 0 ]; then
  for source in fuzz/corpus/*/; do targets+=("$(basename "$source")"); done
fi
cmake --preset fuzz
cmake --build --preset fuzz --target "${targets[@]/#/fuzz_}"
mkdir -p build/fuzz/found
[ -d /dev/shm ] && export TMPDIR=/dev/shm
failed=0
for target in "${targets[@]}"; do
  kept="build/fuzz/corpus/$target"
  mkdir -p "$kept"
  dictionary=()
  [ -f "fuzz/dict/$target.dict" ] && dictionary=("-dict=fuzz/dict/$target.dict")
  log="build/fuzz/$target.log"
  if ! "build/fuzz/fuzz/fuzz_$target" "$kept" "fuzz/corpus/$target" "${dictionary[@]}" \
    -max_total_time="$(awk "BEGIN { print int(60 * $minutes) }")" -artifact_prefix="build/fuzz/found/$target-" \
    -malloc_limit_mb=600 -rss_limit_mb=1500 -timeout=10 -max_len=8192 -print_final_stats=1 \
    >"$log" 2>&1; then
    failed=1
    echo "$target: FOUND SOMETHING, see $log and build/fuzz/found"
    continue
  fi
  echo "$target: $(awk '/number_of_executed_units/ { print $2 }' "$log") executions, nothing found"
done
exit "$failed"
