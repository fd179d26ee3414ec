#!/usr/bin/env bash
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# Builds the Debian packages: sgs, sgs-mesh, sgs-video, sgs-cameras, sgs-ros1, sgs-ros2, libsgs0, libsgs-dev, python3-sgs.
#   scripts/build_packages.sh [FOLDER]   into FOLDER (default build/packages/debs)
# What a build needs, scripts/install_packages.sh installs.
set -euo pipefail
cd "$(dirname "$0")/.."
folder=${1:-build/packages/debs}
cmake --preset release -B build/packages -DSGS_BUILD_TESTS=OFF -DCMAKE_INSTALL_PREFIX=/usr
cmake --build build/packages
mkdir -p "$folder"
cpack --config build/packages/CPackConfig.cmake -B "$folder"
rm -rf "$folder/_CPack_Packages"
ls -sh "$folder"/*.deb
