#!/usr/bin/env bash
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# Installs what is missing, builds, and runs every test. Arguments go to ctest (e.g. -R dataset).
set -euo pipefail
cd "$(dirname "$0")"
scripts/install_packages.sh --tests
cmake --preset release -DSGS_BUILD_TESTS=ON
cmake --build --preset release
ctest --preset release --parallel "$(nproc)" "$@"
