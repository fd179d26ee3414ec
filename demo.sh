#!/usr/bin/env bash
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# Installs what is missing, builds, runs SLAM on a built-in degenerate sequence and prints the score
# table and the path of the report. Arguments go to `sgs run` (e.g. ./demo.sh --realtime).
set -euo pipefail
cd "$(dirname "$0")"
scripts/install_packages.sh
cmake --preset release -DSGS_BUILD_TESTS=OFF >/dev/null
cmake --build --preset release
build/release/apps/sgs/sgs run synth:nostructure_texture_near --frames 0:300 "$@"
