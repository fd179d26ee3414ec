#!/usr/bin/env bash
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# Installs the Debian packages of packages-debian.txt that are missing, those for tests with --tests
# only; does nothing (and needs no network and no rights) when all are there.
set -euo pipefail
list="$(dirname "$0")/packages-debian.txt"
missing=()
while read -r package purpose; do
  [[ -z "$package" || "$package" == \#* ]] && continue
  [[ "$purpose" == tests && "${1:-}" != --tests ]] && continue
  # Node.js from elsewhere brings its own npm, and Debian's conflicts with it: any npm will do.
  [[ "$package" =~ ^(nodejs|npm)$ ]] && command -v npm >/dev/null && continue
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
done <"$list"
[[ ${#missing[@]} -eq 0 ]] && exit 0

sudo=()
if [[ $EUID -ne 0 ]]; then
  command -v sudo >/dev/null || { echo "Missing packages: ${missing[*]}. Install them as root, then run this again." >&2; exit 1; }
  sudo=(sudo)
fi
echo "Installing ${#missing[@]} missing packages: ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
"${sudo[@]}" apt-get update -q
"${sudo[@]}" apt-get install -q -y --no-install-recommends "${missing[@]}"
