#!/usr/bin/env bash
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# Runs the product's mapping iteration and that of the rasterizer prototype alternately and prints
# the ratios: benchmarks/race.sh SGS_BINARY [ROUNDS]. The prototype is built from
# SGS_PROTOTYPES/raster.cpp (default: ../shared/prototypes beside the repository).
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
sgs=${1:?usage: race.sh SGS_BINARY [ROUNDS]}
rounds=${2:-5}
prototypes=${SGS_PROTOTYPES:-$here/../../shared/prototypes}
if [[ ! -f $prototypes/raster.cpp ]]; then
  echo "skipped: no raster.cpp in $prototypes (set SGS_PROTOTYPES)"
  exit 0
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
flags="-O3 -std=c++20 -w -Wno-psabi"
g++ $flags -march=native "$prototypes/raster.cpp" -o "$work/raster" -lpthread
g++ $flags -mavx2 -mfma -mbmi -mbmi2 -mpopcnt "$prototypes/raster.cpp" -o "$work/raster-avx2" -lpthread
python3 "$here/race.py" "$sgs" "$work" "$rounds"
