#!/usr/bin/env bash
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# Runs clang-tidy (checks and reasons: .clang-tidy) with the flags of build/dev, where each source is compiled alone.
#   scripts/tidy.sh              sources that differ from main
#   scripts/tidy.sh --all        all sources (an hour on two cores)
#   scripts/tidy.sh FILE|FOLDER  these
# Exit code 0 where there is nothing to say. Files with Highway kernels are left out: they include
# themselves once per instruction set, which clang-tidy takes for one file.
set -euo pipefail
cd "$(dirname "$0")/.."
build=${BUILD:-build/dev}
[[ -f $build/compile_commands.json ]] || { echo "First configure: cmake --preset dev" >&2; exit 1; }
command -v clang-tidy >/dev/null || { echo "clang-tidy is missing (Debian package clang-tidy)" >&2; exit 1; }

case "${1:-}" in
  --all) list=$(git ls-files src apps) ;;
  "") list=$(git diff --name-only --diff-filter=d "$(git merge-base HEAD "${BASE:-origin/main}")" -- src apps) ;;
  *) list=$(git ls-files -- "$@") ;;
esac
mapfile -t files < <(grep '\.cc$' <<<"$list" | grep -v '_test\.cc$')
chosen=()
for file in "${files[@]}"; do
  # Files that this configuration does not compile have no flags to be read with.
  grep -q "\"$PWD/$file\"" "$build/compile_commands.json" || continue
  grep -q 'foreach_target' "$file" || chosen+=("$file")
done
[[ ${#chosen[@]} -eq 0 ]] && { echo "No sources to check"; exit 0; }
printf '%s\0' "${chosen[@]}" | xargs -0 -P "$(nproc)" -n 1 clang-tidy -p "$build" --quiet \
  --extra-arg=-Wno-unknown-warning-option
