#!/usr/bin/env bash
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# Do the packages work on a bare Debian 12, and go without a trace? Needs root, debootstrap and the
# network. Not part of test.sh.
#   scripts/test_packages_chroot.sh [FOLDER]               builds the packages in the chroot first
#   scripts/test_packages_chroot.sh --packages P [FOLDER]  takes the packages in P
# FOLDER (default /tmp/sgs-packages-chroot) is used again where it is there.
set -euo pipefail
cd "$(dirname "$0")/.."
packages=
if [[ "${1:-}" == --packages ]]; then packages=$(realpath "$2"); shift 2; fi
root=${1:-/tmp/sgs-packages-chroot}
source scripts/bare_debian.sh

rm -rf "$root/packages"
mkdir -p "$root/packages"
if [[ -n $packages ]]; then
  cp "$packages"/*.deb "$root/packages"
else
  inside 'cd /src && scripts/install_packages.sh && scripts/build_packages.sh /packages'
fi
inside '/src/scripts/try_packages.sh /packages'
