#!/usr/bin/env bash
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# Builds everything with AddressSanitizer and UBSan, then with ThreadSanitizer, and runs with each: the
# unit and integration tests, a live session that is watched, and one that is stopped and gone on with.
# To be run before a release; nearly all of its time goes into building.
#
# Usage: scripts/sanitize.sh [asan|tsan|all] [MODULE...]
# With modules (e.g. `loops slam`) only their tests are built and run, and no session.
set -euo pipefail
cd "$(dirname "$0")/.."
which="${1:-all}"
[ "$#" -gt 0 ] && shift
modules=("$@")
[ "$which" = all ] && presets=(asan tsan) || presets=("$which")

export ASAN_OPTIONS="detect_stack_use_after_return=1:strict_string_checks=1"
export UBSAN_OPTIONS="print_stacktrace=1"
export LSAN_OPTIONS="suppressions=$PWD/scripts/sanitize-leaks.txt:print_suppressions=0"
export TSAN_OPTIONS="suppressions=$PWD/scripts/sanitize-threads.txt:second_deadlock_stack=1"

# A live session with everything that has a thread: viewers that come and go, loops, checkpoints. Then
# an offline one that is stopped and gone on with.
session() {
  local sgs="build/$1/apps/sgs/sgs" out run
  out="$(mktemp -d)"
  "$sgs" synth room_desk "$out/in" --frames 40 --quiet
  scripts/soak.py "$sgs" 1 "$out/in"
  "$sgs" run "$out/in" -o "$out/run" --checkpoint 1 --no-eval --quiet &
  run=$!
  until [ -f "$out/run/checkpoint.txt" ] || ! kill -0 "$run" 2>/dev/null; do sleep 0.2; done
  kill -INT "$run" 2>/dev/null || true
  wait "$run" || [ "$?" -eq 130 ]
  if grep -q interrupted "$out/run/state.toml"; then
    "$sgs" run --resume "$out/run" --no-eval --quiet
  fi
  rm -rf "$out"
}

for preset in "${presets[@]}"; do
  cmake --preset "$preset" -DSGS_BUILD_TESTS=ON
  if [ "${#modules[@]}" -gt 0 ]; then
    for module in "${modules[@]}"; do
      cmake --build --preset "$preset" --target "sgs_${module}_test"
      "build/$preset/src/sgs/sgs_${module}_test" --gtest_brief=1
    done
    continue
  fi
  cmake --build --preset "$preset"
  # Left out: what is about Python, packages and the house, or builds programs without the sanitizer.
  ctest --test-dir "build/$preset" --parallel "$(nproc)" --output-on-failure -E '^(cli|bags|readers|inputs|examples|viewer|faults|house)\.'
  session "$preset"
  echo "$preset: clean"
done
