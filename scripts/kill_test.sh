#!/usr/bin/env bash
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# Kills runs over three short sequences at random moments: first reads what each left behind
# (tests/faults/kill_test.py), then goes on with others and compares the bits (resume_test.py), and
# kills runs that go on with a map (continue_test.py).
# To be run before a release; takes some 20 s for each kill.
#
# Usage: scripts/kill_test.sh SGS [KILLS [RESUMES [RECORDING...]]]
# The sequences are rendered, or the first 60 frames of each RECORDING.
set -euo pipefail
root="$(cd "$(dirname "$0")/.." && pwd)"
sgs="$(realpath "$1")"
kills="${2:-100}"
resumes="${3:-20}"
frames=60
scratch="$(mktemp -d)"
trap 'rm -rf "$scratch"' EXIT

inputs=()
if [ "$#" -gt 3 ]; then
  for recording in "${@:4}"; do
    inputs+=("$scratch/in-${#inputs[@]}")
    "$sgs" convert "$recording" "${inputs[-1]}" --frames "0:$frames" --quiet
  done
else
  for scene in room_desk room_desk:hard corridor:hard; do
    inputs+=("$scratch/in-${#inputs[@]}")
    "$sgs" synth "$scene" "${inputs[-1]}" --frames "$frames" --quiet
  done
fi
python3 "$root/tests/faults/kill_test.py" "$sgs" "$kills" "${inputs[@]}"
python3 "$root/tests/faults/resume_test.py" "$sgs" "$resumes" "${inputs[@]}"
python3 "$root/tests/faults/continue_test.py" "$sgs" "$kills" "${inputs[0]}"
