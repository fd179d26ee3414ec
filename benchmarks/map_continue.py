#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""A map that is gone on with, against one uninterrupted run (docs/maps.md).

    map_continue.py --sgs build/release/apps/sgs/sgs --out DIR INPUT 0:300:600

Runs frames A:B, goes on with that map by B:C (--continue), and runs A:C in one piece. Told are the
error of the trajectory (positions, one rigid alignment of all), of both sessions together and of the
second one in the world of the first, and the PSNR of the frames of either session against the map that
there is in the end. Poses of the first session move with the views of the map next to them in time.
What is there already is not run again.
"""

import argparse
import hashlib
import json
import pathlib
import re
import shutil
import subprocess

import numpy as np
from map_visits import Run, matched, poses, rigid, rmse


def run(args, frames, folder, *more):
    if (folder / "metrics.json").exists():
        return
    shutil.rmtree(folder, ignore_errors=True)
    command = [args.sgs, "run", args.input, "--frames", frames, "-o", str(folder), "--quiet"]
    subprocess.run([*command, "--threads", "1", *args.option, *more], check=True)


def views_of(args, saved):
    """Times and poses of the views of a map's first session."""
    told = subprocess.run(
        [args.sgs, "info", str(saved), "--json"], check=True, capture_output=True, text=True
    )
    rows = [v for v in json.loads(told.stdout)["places"] if v["session"] == 0]
    path = saved.parent / "views.txt"
    path.write_text("".join(f"{v['time_s']} {' '.join(map(str, v['pose']))}\n" for v in rows))
    return poses(path)


def moves(before, after):
    """World moves by the time of a view of the first session, for those that both maps have."""
    index = matched(after[0], before[0])
    ok = index >= 0
    moved = after[1][ok] @ np.linalg.inv(before[1][index[ok]])
    return after[0][ok], moved


def quaternion(r):
    w = np.sqrt(max(0, 1 + np.trace(r))) / 2
    return (r[2, 1] - r[1, 2]) / 4 / w, (r[0, 2] - r[2, 0]) / 4 / w, (r[1, 0] - r[0, 1]) / 4 / w, w


def move_poses(path, times, moved):
    """Rewrites a trajectory: each pose moves as the view next to it in time did."""
    stamps, T = poses(path)
    lines = []
    for t, pose in zip(stamps, T):
        now = moved[np.argmin(np.abs(times - t))] @ pose
        numbers = (*now[:3, 3], *quaternion(now[:3, :3]))
        lines.append(f"{t:.6f} {' '.join(f'{n:.9f}' for n in numbers)}\n")
    path.write_text("".join(lines))


def psnr(args, folder):
    """dB of a run's frames against its map."""
    subprocess.run(
        [args.sgs, "eval", str(folder), "--quiet"], check=True, stdout=subprocess.DEVNULL
    )
    return json.loads((folder / "metrics.json").read_text())["psnr_db"]


def part_of(folder, frames, out):
    """The run, as if it had only had these frames."""
    shutil.rmtree(out, ignore_errors=True)
    shutil.copytree(folder, out, ignore=shutil.ignore_patterns("*.sgsmap", "renders", "*.html"))
    config = out / "config.toml"
    text, count = re.subn(r"(?m)^frames = .*$", f'frames = "{frames}"', config.read_text())
    assert count == 1
    config.write_text(text)
    return out


def ate(stamps, T, truth_times, truth):
    index = matched(stamps, truth_times)
    ok = index >= 0
    a, b = T[ok, :3, 3], truth[index[ok], :3, 3]
    fit = rigid(a, b)
    return rmse(np.linalg.norm(a @ fit[:3, :3].T + fit[:3, 3] - b, axis=1))


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--sgs", required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("input")
    parser.add_argument("frames", metavar="A:B:C")
    parser.add_argument("--option", action="append", default=[], help="of all runs")
    args = parser.parse_args()
    first, middle, last = args.frames.split(":")
    out = args.out
    out.mkdir(parents=True, exist_ok=True)
    run(args, f"{first}:{middle}", out / "map")
    saved = out / "map" / "map.sgsmap"
    before = hashlib.sha256(saved.read_bytes()).hexdigest()
    run(args, f"{middle}:{last}", out / "more", "--continue", str(saved))
    run(args, f"{first}:{last}", out / "whole")
    times, moved = moves(views_of(args, saved), views_of(args, out / "more" / "map.sgsmap"))

    old = part_of(out / "map", f"{first}:{middle}", out / "old_in_new")
    for name in ("trajectory.txt", "keyframes.txt"):
        move_poses(old / name, times, moved)
    shutil.copy(out / "more" / "map.ply", old / "map.ply")

    one, two, whole = Run(old), Run(out / "more"), Run(out / "whole")
    both_times = np.concatenate([one.times, two.times])
    both = np.concatenate([one.poses, two.poses])
    truth = whole.truth_times, whole.truth
    same = np.isin(np.round(whole.times, 4), np.round(both_times, 4))
    result = {
        "ate_cm": 100 * ate(both_times, both, *truth),
        "ate_whole_cm": 100 * ate(whole.times[same], whole.poses[same], *truth),
        "second_in_world_of_first_cm": 100 * rmse(two.errors(one.alignment())[0]),
        "old_views_moved_by_cm": 100
        * float(np.max(np.linalg.norm([m[:3, 3] for m in moved], axis=1), initial=0)),
        "frames_lost": len(two.stamps) - len(two.tracked),
        "psnr_first_db": psnr(args, old),
        "psnr_second_db": json.loads((out / "more" / "metrics.json").read_text())["psnr_db"],
        "map_byte_equal": hashlib.sha256(saved.read_bytes()).hexdigest() == before,
    }
    for name, frames in (("first", f"{first}:{middle}"), ("second", f"{middle}:{last}")):
        part = part_of(out / "whole", frames, out / f"whole_{name}")
        result[f"psnr_whole_{name}_db"] = psnr(args, part)
    result["psnr_first_before_db"] = json.loads((out / "map" / "metrics.json").read_text())[
        "psnr_db"
    ]
    print(json.dumps(result, indent=1))


if __name__ == "__main__":
    main()
