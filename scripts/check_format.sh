#!/usr/bin/env bash
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# Checks clang-format and the SPDX heads of all C++ files; --fix formats instead of complaining.
set -euo pipefail
cd "$(dirname "$0")/.."
mapfile -t files < <(find src apps benchmarks tests -name '*.h' -o -name '*.cc' | sort)
if [[ "${1:-}" == "--fix" ]]; then
  clang-format -i "${files[@]}"
  exit 0
fi
status=0
clang-format --dry-run --Werror "${files[@]}" || status=1
for file in "${files[@]}"; do
  head -2 "$file" | grep -q 'SPDX-License-Identifier: Apache-2.0' || { echo "$file: no SPDX head"; status=1; }
done
exit $status
