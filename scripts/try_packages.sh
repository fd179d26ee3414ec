#!/usr/bin/env bash
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# Installs the packages of a folder, uses them, removes them and looks for what is left. As root, on a
# Debian 12 that may be thrown away (scripts/test_packages_chroot.sh makes one; so does the Dockerfile).
#   scripts/try_packages.sh FOLDER
set -euo pipefail
folder=$(realpath "$1")
examples=$(realpath "$(dirname "$0")/../examples")
export DEBIAN_FRONTEND=noninteractive
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

install() { apt-get install -q -y --no-install-recommends "$@"; }
same() { cmp "$1/trajectory.txt" "$2/trajectory.txt" && cmp "$1/map.ply" "$2/map.ply"; }

apt-get update -q
echo "== Python, with two packages"
install "$folder"/{libsgs0,python3-sgs}_*.deb
python3 - <<'PYTHON'
import numpy as np, sgs
room = sgs.open("synth:room_desk", frames="0:20")
config = sgs.Config.preset("default")
config["mapper.iterations_per_frame"] = 1.5
with sgs.Session(room.camera, config, threads=2, live=False) as session:
    for f in room:
        r = session.feed(np.array(f.color), np.array(f.depth), f.time)
        print(r.status, r.T_world_camera[:3, 3], r.spectrum.eigenvalues, r.spectrum.weights)
snapshot = session.snapshot()
color, depth, alpha = snapshot.render(room.camera, r.T_world_camera)
print(snapshot.positions.shape, color.shape, depth.max(), alpha.max())
trajectory = session.trajectory()
session.save("fed")
print(sgs.evaluate(room.ground_truth, trajectory)["ate_rmse_m"], len(trajectory.times))
PYTHON
echo "== the program"
install "$folder"/{sgs,sgs-mesh,sgs-video,sgs-cameras,sgs-ros1,sgs-ros2}_*.deb
sgs --version
sgs run synth:room_desk --frames 0:20 -o run --quiet
same fed run
sgs export run mesh mesh.ply
test -s mesh.ply
sgs render run --video walk.mp4 --seconds 1 --quiet
test -s walk.mp4
test -s /usr/share/man/man1/sgs-run.1
bash -c 'source /usr/share/bash-completion/completions/sgs; COMP_WORDS=(sgs ru) COMP_CWORD=1; _sgs
         [[ ${COMPREPLY[*]} == run ]]'
echo "== cameras and robots"
families=$(sgs info --cameras)
for family in realsense orbbec k4a freenect openni2 ros1 ros2; do
  grep -q "^$family" <<<"$families" || { echo "no family $family in: $families"; exit 1; }
done
SGS_CAMERA_PROGRAMS=/usr/share/sgs/cameras sgs info --cameras | grep "pip install depthai"
! sgs run camera: 2>refused.txt
grep "no camera was found" refused.txt
/usr/libexec/sgs/sgs-ros2 --help >/dev/null
sgs run synth:room_desk --frames 0:20 -o published --quiet --ros2
same published run
/usr/libexec/sgs/sgs-ros1 --help >/dev/null
# Without a master the run goes on unpublished.
sgs run synth:room_desk --frames 0:20 -o unpublished --quiet --ros1
grep "no ROS master answers" unpublished/log.txt
same unpublished run
echo "== a program of one's own"
install "$folder"/libsgs-dev_*.deb cmake g++ make pkg-config
cmake -S "$examples/consumer" -B by-cmake
cmake --build by-cmake
mkdir by-pkg-config
# shellcheck disable=SC2046  # options are words
g++ -std=c++17 "$examples/consumer/slam.cc" $(pkg-config --cflags --libs sgs) -o by-pkg-config/slam
sgs synth room_desk room --frames 20 --quiet
sgs run room -o of-room --quiet --no-eval
for built in by-cmake by-pkg-config; do
  "$built/slam" room "$built-run" >poses.txt
  same "$built-run" of-room
done

echo "== removal"
names=(sgs sgs-mesh sgs-video sgs-cameras sgs-ros1 sgs-ros2 libsgs0 libsgs-dev python3-sgs)
dpkg -L "${names[@]}" | sort -u >installed.txt
apt-get purge -q -y "${names[@]}"
left=0
while read -r path; do
  # Folders of the system stay; ours and all files go.
  if [[ -e $path && ( ! -d $path || $path == *sgs* ) ]]; then echo "left behind: $path"; left=1; fi
done <installed.txt
[[ $left -eq 0 ]] && echo "Nothing is left of the packages"
exit $left
