#!/usr/bin/env bash
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# Runs the product's mapping iteration and that of a rasterizer prototype alternately and prints the
# ratios:
#
#   benchmarks/race.sh sgs_mapping_benchmark PROTOTYPE.cpp [ROUNDS]
#
# PROTOTYPE.cpp (or SGS_RACE_PROTOTYPE) is one C++ source. Built, it is called as `bench GAUSSIANS
# WIDTH DENSE SIGMA THREADS ...` and prints "TOTAL MILLISECONDS (min ...)"; see race.py.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
usage="usage: race.sh SGS_MAPPING_BENCHMARK PROTOTYPE.cpp [ROUNDS]"
product=${1:?$usage}
prototype=${2:-${SGS_RACE_PROTOTYPE:-}}
rounds=${3:-5}
[[ -n $prototype ]] || { echo "race.sh: name the source to race against. $usage, or set SGS_RACE_PROTOTYPE" >&2; exit 2; }
[[ -f $prototype ]] || { echo "race.sh: there is no file $prototype. $usage" >&2; exit 2; }
[[ -x $product ]] || { echo "race.sh: $product is no program: build the target sgs_mapping_benchmark" >&2; exit 2; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
flags="-O3 -std=c++20 -w -Wno-psabi"
g++ $flags -march=native "$prototype" -o "$work/raster" -lpthread
g++ $flags -mavx2 -mfma -mbmi -mbmi2 -mpopcnt "$prototype" -o "$work/raster-avx2" -lpthread
python3 "$here/race.py" "$product" "$work" "$rounds"
