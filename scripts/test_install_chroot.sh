#!/usr/bin/env bash
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# Does a bare Debian 12 with the packages of packages-debian.txt, and no others, build the project,
# install it, and build and run examples/ against the installation? Takes half an hour; needs root,
# debootstrap and the network. Not part of test.sh.
#   scripts/test_install_chroot.sh [FOLDER]           build and install in the chroot (default /tmp/sgs-chroot)
#   scripts/test_install_chroot.sh --prefix P FOLDER  take the installation P instead of building one
# A chroot that is already there is used again; packages are only ever added to it.
set -euo pipefail
cd "$(dirname "$0")/.."
prefix=
if [[ "${1:-}" == --prefix ]]; then prefix=$(realpath "$2"); shift 2; fi
root=${1:-/tmp/sgs-chroot}
source scripts/bare_debian.sh

rm -rf "$root/opt/sgs"
inside /src/scripts/install_packages.sh

if [[ -n $prefix ]]; then
  cp -r "$prefix" "$root/opt/sgs"
else
  inside 'cd /src && cmake --preset release -DSGS_BUILD_TESTS=OFF && cmake --build --preset release &&
          cmake --install build/release --prefix /opt/sgs'
fi
inside 'set -e; rm -rf /tmp/examples /tmp/room /tmp/fed /tmp/own
        cmake -G Ninja -S /src/examples -B /tmp/examples -DCMAKE_PREFIX_PATH=/opt/sgs
        cmake --build /tmp/examples --parallel "$(nproc)"
        /opt/sgs/bin/sgs synth room_desk /tmp/room --frames 8 --quiet
        /tmp/examples/feed_frames /tmp/room /tmp/fed
        /tmp/examples/own_tracker /tmp/room /tmp/room/groundtruth.txt /tmp/own
        test -s /tmp/fed/map.ply && test -s /tmp/own/trajectory.txt'
echo "The examples run in $root"
