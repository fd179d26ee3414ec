#!/usr/bin/env bash
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# Installs the packages of a folder, uses them, removes them and looks for what is left. As root, on a
# Debian 12 that may be thrown away (scripts/test_packages_chroot.sh makes one; so does the Dockerfile).
#   scripts/try_packages.sh FOLDER
set -euo pipefail
folder=$(realpath "$1")
export DEBIAN_FRONTEND=noninteractive
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

apt-get update -q
apt-get install -q -y --no-install-recommends "$folder"/{sgs,sgs-mesh,sgs-video,libsgs0,python3-sgs}_*.deb
echo "== the program"
sgs --version
sgs run synth:room_desk --frames 0:20 -o run --quiet
sgs export run mesh mesh.ply
test -s mesh.ply
sgs render run --video walk.mp4 --seconds 1 --quiet
test -s walk.mp4
test -s /usr/share/man/man1/sgs-run.1
bash -c 'source /usr/share/bash-completion/completions/sgs; COMP_WORDS=(sgs ru) COMP_CWORD=1; _sgs
         [[ ${COMPREPLY[*]} == run ]]'
echo "== Python"
python3 - <<'PYTHON'
import numpy as np, sgs
room = sgs.open("synth:room_desk", frames="0:20")
with sgs.Session(room.camera, threads=2) as session:
    for i, f in enumerate(room):
        r = session.feed(np.array(f.color), np.array(f.depth), f.time)
print(r.status, r.T_world_camera[:3, 3], r.spectrum.weights, session.snapshot().positions.shape)
session.save("fed")
assert open("fed/trajectory.txt").read() == open("run/trajectory.txt").read(), "not the program's bits"
PYTHON

echo "== removal"
names=(sgs sgs-mesh sgs-video libsgs0 python3-sgs)
dpkg -L "${names[@]}" | sort -u >installed.txt
apt-get purge -q -y "${names[@]}"
left=0
while read -r path; do
  # Folders of the system stay; ours and all files go.
  if [[ -e $path && ( ! -d $path || $path == *sgs* ) ]]; then echo "left behind: $path"; left=1; fi
done <installed.txt
[[ $left -eq 0 ]] && echo "Nothing is left of the packages"
exit $left
