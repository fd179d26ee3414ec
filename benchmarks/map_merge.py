#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Maps of parts of a recording joined into one, against one uninterrupted run (docs/maps.md).

    map_merge.py --sgs build/release/apps/sgs/sgs --out DIR INPUT 0:220 190:410 380:600

Runs each part by itself and all of it in one piece, and joins the maps of the parts (`sgs merge`).
Told is the error of the views' positions against the recording's truth, one rigid alignment each: of
every part, of the joined map, and of the map in one piece. What is there already is not run again.
"""

import argparse
import json
import pathlib
import subprocess

import numpy as np
from map_continue import run
from map_visits import matched, poses, rigid, rmse


def views(args, saved):
    """Times and positions of a map's views."""
    told = subprocess.run(
        [args.sgs, "info", str(saved), "--json"], check=True, capture_output=True, text=True
    )
    rows = json.loads(told.stdout)["places"]
    return np.array([v["time_s"] for v in rows]), np.array([v["pose"][:3] for v in rows])


def error(args, saved, truth):
    times, points = views(args, saved)
    true_times, true_poses = truth
    index = matched(times, true_times)
    ok = index >= 0
    true_points = true_poses[index[ok], :3, 3]
    fit = rigid(points[ok], true_points)
    off = np.linalg.norm(points[ok] @ fit[:3, :3].T + fit[:3, 3] - true_points, axis=1)
    return f"{100 * rmse(off):.2f} cm over {ok.sum()} views, largest {100 * off.max():.2f} cm"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sgs", required=True)
    parser.add_argument("--out", required=True, type=pathlib.Path)
    parser.add_argument("--option", action="append", default=[], help="of the runs")
    parser.add_argument("input")
    parser.add_argument("parts", nargs="+", help="a:b, frames a to b-1")
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    folders = []
    for part in args.parts:
        folders.append(args.out / part.replace(":", "-"))
        run(args, part, folders[-1])
    first, last = args.parts[0].split(":")[0], args.parts[-1].split(":")[1]
    whole = args.out / "whole"
    run(args, f"{first}:{last}", whole)
    joined = args.out / "joined.sgsmap"
    merge = [args.sgs, "merge", *map(str, folders), "-o", str(joined), "--threads", "1"]
    subprocess.run(merge, check=True)
    truth = poses(whole / "groundtruth.txt")
    for name, saved in [
        *((f.name, f / "map.sgsmap") for f in folders),
        ("joined", joined),
        ("in one piece", whole / "map.sgsmap"),
    ]:
        print(f"{name:<14}{error(args, saved, truth)}")


if __name__ == "__main__":
    main()
