#!/usr/bin/env bash
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# What to run before a commit; the tests house.* run its parts.
#   scripts/check.sh [--fix] [--sgs EXECUTABLE] [--node-modules FOLDER] [PART...]
# Parts, all by default:
#   format       C++ as clang-format writes it
#   prettier     TypeScript, JavaScript and CSS as prettier writes them
#   black        Python as black writes it
#   types        the report's scripts have no type errors (tsc)
#   spdx         every source file names its licence
#   layers       every #include obeys the layer table
#   references   what comments and documents refer to exists
#   generated    pages and tables written from declarations are up to date (needs an executable)
# --fix formats instead of complaining. Prettier and tsc come from FOLDER, by default the one in which
# a build of the viewer's page has put its packages. What a part needs and does not find, it says.
# Exit code: 0 fine, 1 something is wrong, 77 nothing was checked.
set -uo pipefail
cd "$(dirname "$0")/.."

fix=0
sgs=""
modules=""
parts=()
while [[ $# -gt 0 ]]; do
  case "$1" in
    --fix) fix=1 ;;
    --sgs) sgs="$2"; shift ;;
    --node-modules) modules="$2"; shift ;;
    -*) echo "unknown option $1 (see the head of scripts/check.sh)" >&2; exit 1 ;;
    *) parts+=("$1") ;;
  esac
  shift
done
[[ ${#parts[@]} -gt 0 ]] || parts=(format prettier black types spdx layers references generated)
for folder in web build/*/web/page; do
  [[ -z "$modules" && -d "$folder/node_modules" ]] && modules="$folder/node_modules"
done

kSkipped=77
# Programs of cameras and robots have no ending: `sgs` finds them by their names.
kPython=('*.py' 'sgs-camera-*' 'sgs-ros1')
skip() {
  echo "skipped: $*"
  return $kSkipped
}

# sources PATTERN...: files of the tree with such names.
sources() {
  local names=()
  for pattern in "$@"; do names+=(-o -name "$pattern"); done
  find . -maxdepth 1 -type f \( "${names[@]:1}" \)
  find ./*/ -path './build*' -prune -o -path ./runs/ -prune -o -name node_modules -prune -o -name dist -prune \
    -o -type f \( "${names[@]:1}" \) -print | sort
}

check_format() {
  command -v clang-format >/dev/null || { skip "no clang-format (Debian package clang-format)"; return; }
  if [[ $fix -eq 1 ]]; then
    sources '*.h' '*.cc' '*.inl' | xargs clang-format -i
  else
    sources '*.h' '*.cc' '*.inl' | xargs clang-format --dry-run --Werror
  fi
}

node_tool() {
  command -v node >/dev/null || { skip "no node (Debian package nodejs)"; return; }
  local tool="$modules/$1"
  [[ -n "$modules" && -f "$tool" ]] || { skip "no ${1%%/*}: the viewer's page has not been built here"; return; }
  node "$tool" "${@:2}"
}

check_prettier() {
  local what=--check
  [[ $fix -eq 0 ]] || what=--write
  mapfile -t files < <(sources '*.ts' '*.mjs' '*.js' '*.css')
  node_tool prettier/bin/prettier.cjs --log-level warn $what "${files[@]}"
}

check_black() {
  command -v black >/dev/null || { skip "no black (Debian package black)"; return; }
  local what=--check
  [[ $fix -eq 0 ]] || what=--quiet
  sources "${kPython[@]}" | xargs black --quiet --line-length 100 $what ||
    { echo "black would change files: scripts/check.sh --fix black"; return 1; }
}

check_types() {
  node_tool typescript/bin/tsc -p src/sgs/report/page
}

check_spdx() {
  sources '*.h' '*.cc' '*.inl' '*.ts' '*.mjs' '*.js' '*.css' '*.html' "${kPython[@]}" '*.sh' '*.cmake' CMakeLists.txt |
    xargs awk '
      FNR == 1 { if (file != "" && !named) print file ": no SPDX head"; file = FILENAME; named = 0 }
      FNR <= 5 && /SPDX-License-Identifier: Apache-2.0/ { named = 1 }
      END { if (!named) print file ": no SPDX head" }' | { ! grep .; }
}

check_layers() { python3 scripts/check_layers.py; }

check_references() {
  [[ -f scripts/check_references.py ]] || { skip "no scripts/check_references.py"; return; }
  python3 scripts/check_references.py
}

check_generated() {
  [[ -n "$sgs" ]] || { skip "no executable given (--sgs)"; return; }
  python3 scripts/update_generated.py --check "$sgs"
}

worst=$kSkipped
for part in "${parts[@]}"; do
  [[ "$(type -t "check_$part")" == function ]] || { echo "no such part: $part" >&2; exit 1; }
  output="$("check_$part" 2>&1)"
  case $? in
    0) result=ok; [[ $worst -eq 1 ]] || worst=0 ;;
    "$kSkipped") result="" ;;
    *) result=FAILED; worst=1 ;;
  esac
  printf '%-11s %s\n' "$part" "${result:-$output}"
  [[ "$result" != FAILED ]] || printf '%s\n' "$output" | sed 's/^/  /'
done
exit $worst
