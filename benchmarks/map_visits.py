#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""How soon, and how well, a camera finds itself in the map of an earlier run (docs/maps.md).

    map_visits.py --sgs build/release/apps/sgs/sgs --out DIR --map INPUT A:B --visit INPUT C:D [--starts 20]

Makes the map of frames A:B once, then begins at `--starts` frames of C:D, spread evenly, and follows
`--frames` frames from each. The visit is never aligned by itself: the map's run is aligned to its
truth (rigidly), and the same transform takes the visit's poses there. With --elsewhere the visit is
of another room: every start that is found is wrong. With --whole both stretches (of one recording)
are run in one piece, too, and the second one is judged in the same way. Where INPUT is a folder in
TUM layout with truth, it is told which starts saw within a second, by truth and depth, what some
frame of the map had seen (a third of their pixels): only those can be found by what is stored.
"""

import argparse
import csv
import hashlib
import json
import pathlib
import shutil
import subprocess

import numpy as np
from skimage.io import imread

SOON = 30  # frames: one second
SEEN = 1 / 3  # of a frame, by one frame of the map
WRONG_M, WRONG_DEG = 0.10, 5.0
TRUTH_GAP_S = 0.04


def rotation(q):
    x, y, z, w = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def poses(path):
    """Times and matrices of a TUM file; empty where it holds none."""
    rows = [line.split() for line in path.read_text().splitlines() if line and line[0] != "#"]
    table = np.array(rows, dtype=float).reshape(-1, 8)
    out = np.tile(np.eye(4), (len(table), 1, 1))
    for k, row in enumerate(table):
        out[k, :3, :3] = rotation(row[4:8])
        out[k, :3, 3] = row[1:4]
    return table[:, 0], out


def matched(times, truth_times):
    """Index of the nearest truth of each time, or -1."""
    if len(truth_times) == 0:
        return np.full(len(times), -1)
    after = np.clip(np.searchsorted(truth_times, times), 1, max(1, len(truth_times) - 1))
    before = after - 1
    after = np.minimum(after, len(truth_times) - 1)
    nearer = np.abs(truth_times[after] - times) < np.abs(truth_times[before] - times)
    index = np.where(nearer, after, before)
    return np.where(np.abs(truth_times[index] - times) <= TRUTH_GAP_S, index, -1)


def around(T):
    """Points that stand for poses: each camera and what lies a metre from it along its axes. So turns
    count, too: a short path alone hardly tells them."""
    return np.concatenate([T[:, :3, 3]] + [T[:, :3, 3] + T[:, :3, k] for k in range(3)])


class Depths:
    """Depth of a folder in TUM layout, on a coarse grid of pixels, with the true pose."""

    STEP, MOST_M, SAME = 16, 8.0, 0.05

    def __init__(self, folder, run_folder):
        self.folder = pathlib.Path(folder)
        rows = [r.split() for r in (run_folder / "camera.txt").read_text().splitlines()]
        self.camera = [float(n) for n in next(r for r in rows if r and r[0][0] != "#")]
        rows = [r.split() for r in (self.folder / "depth.txt").read_text().splitlines()]
        rows = [r for r in rows if r and r[0][0] != "#"]
        self.times = np.array([float(r[0]) for r in rows])
        self.names = [r[1] for r in rows]
        self.truth_times, self.truth = poses(self.folder / "groundtruth.txt")

    @staticmethod
    def of(folder, run_folder):
        """`run_folder`: of a run over frames of this recording."""
        there = all(
            (pathlib.Path(folder) / name).exists() for name in ("depth.txt", "groundtruth.txt")
        )
        return Depths(folder, run_folder) if there else None

    def at(self, time_s):
        """World to camera, depth image and the points of the grid in the world; empty without truth."""
        k = int(np.argmin(np.abs(self.times - time_s)))
        pose = matched(np.array([time_s]), self.truth_times)[0]
        if pose < 0:
            return None
        T = self.truth[pose]
        depth = imread(self.folder / self.names[k]) / self.camera[6]
        fx, fy, cx, cy = self.camera[:4]
        v, u = (a[:: self.STEP, :: self.STEP].ravel() for a in np.indices(depth.shape))
        z = depth[v, u]
        ok = (z > 0) & (z < self.MOST_M)
        u, v, z = u[ok], v[ok], z[ok]
        local = np.stack([(u - cx) / fx * z, (v - cy) / fy * z, z], 1)
        return np.linalg.inv(T), depth, local @ T[:3, :3].T + T[:3, 3]

    def share_seen(self, points, view):
        """Share of points that a view saw where they are."""
        T_camera_world, depth, _ = view
        if len(points) == 0:
            return 0.0
        local = points @ T_camera_world[:3, :3].T + T_camera_world[:3, 3]
        z = np.maximum(local[:, 2], 1e-6)
        fx, fy, cx, cy = self.camera[:4]
        u = np.round(local[:, 0] / z * fx + cx).astype(int)
        v = np.round(local[:, 1] / z * fy + cy).astype(int)
        h, w = depth.shape
        inside = (local[:, 2] > 0) & (u >= 0) & (v >= 0) & (u < w) & (v < h)
        there = depth[np.clip(v, 0, h - 1), np.clip(u, 0, w - 1)]
        return float(np.mean(inside & (there > 0) & (np.abs(there - z) < self.SAME * z)))


def most_seen(known, visited, map_times, visit_times):
    """The largest share of a frame of the visit that some frame of the map saw."""
    views = [view for t in map_times[::5] if (view := known.at(t))]
    frames = [frame for t in visit_times[::5] if (frame := visited.at(t))]
    return max((known.share_seen(f[2], view) for f in frames for view in views), default=0.0)


def rigid(source, target):
    """T with target = T source in the least squares."""
    ms, mt = source.mean(0), target.mean(0)
    u, _, vt = np.linalg.svd((target - mt).T @ (source - ms))
    s = np.diag([1, 1, np.sign(np.linalg.det(u @ vt))])
    out = np.eye(4)
    out[:3, :3] = u @ s @ vt
    out[:3, 3] = mt - out[:3, :3] @ ms
    return out


class Run:
    """What a run folder says."""

    def __init__(self, folder):
        self.times, self.poses = poses(folder / "trajectory.txt")
        self.truth_times, self.truth = poses(folder / "groundtruth.txt")
        with open(folder / "frames.csv", newline="") as text:
            rows = list(csv.DictReader(text))
        self.tracked = [k for k, row in enumerate(rows) if row["status"] in ("ok", "degenerate")]
        self.stamps = np.array([float(row["timestamp_s"]) for row in rows])

    def alignment(self, until_s=np.inf):
        """T_truth_map by the poses up to a time."""
        index = matched(self.times, self.truth_times)
        use = (index >= 0) & (self.times <= until_s)
        return rigid(around(self.poses[use]), around(self.truth[index[use]]))

    def errors(self, T_truth_map, since_s=-np.inf):
        """Metres and degrees of every tracked frame that has truth."""
        stamps = self.stamps[self.tracked]
        at = matched(stamps[stamps >= since_s], self.times)
        index = matched(self.times, self.truth_times)
        metres, degrees = [], []
        for k in at:
            if k < 0 or index[k] < 0:
                continue
            T = np.linalg.inv(self.truth[index[k]]) @ T_truth_map @ self.poses[k]
            metres.append(np.linalg.norm(T[:3, 3]))
            degrees.append(np.degrees(np.arccos(np.clip((np.trace(T[:3, :3]) - 1) / 2, -1, 1))))
        return np.array(metres), np.array(degrees)


def run(args, spec, frames, folder, *more):
    """Runs sgs, unless the folder is there; what it said on the way."""
    if (folder / "frames.csv").exists() and not args.anew:
        return ""
    shutil.rmtree(folder, ignore_errors=True)
    command = [
        args.sgs,
        "run",
        spec,
        "--frames",
        frames,
        "-o",
        str(folder),
        "--threads",
        "1",
        "--no-eval",
        "--quiet",
        *args.option,
        *more,
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode not in (0, 3):
        raise SystemExit(f"{' '.join(command)}\n{done.stderr}")
    return done.stderr.strip()


def rmse(values):
    return float(np.sqrt(np.mean(np.square(values)))) if len(values) else float("nan")


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--sgs", required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--map", nargs=2, metavar=("INPUT", "A:B"), required=True)
    parser.add_argument("--visit", nargs=2, metavar=("INPUT", "C:D"), required=True)
    parser.add_argument("--starts", type=int, default=20)
    parser.add_argument("--frames", type=int, default=60, help="that are followed from each start")
    parser.add_argument("--elsewhere", action="store_true", help="the visit is of another room")
    parser.add_argument("--whole", action="store_true", help="both in one piece, too")
    parser.add_argument("--anew", action="store_true", help="run again what is there already")
    parser.add_argument(
        "--option", action="append", default=[], help="of all runs, as --option=--seed=2"
    )
    args = parser.parse_args()
    run(args, *args.map, args.out / "map")
    saved = args.out / "map" / "map.sgsmap"
    before = hashlib.sha256(saved.read_bytes()).hexdigest()
    known = Run(args.out / "map")
    T_truth_map = known.alignment()
    first, last = (int(n) for n in args.visit[1].split(":"))
    starts = np.linspace(first, max(first, last - args.frames), args.starts).astype(int)
    soon = found = wrong = could = could_soon = 0
    room = Depths.of(args.map[0], args.out / "map")
    waits, metres, degrees = [], [], []
    for start in starts:
        folder = args.out / f"visit_{start}"
        said = run(
            args,
            args.visit[0],
            f"{start}:{min(last, start + args.frames)}",
            folder,
            "--localize",
            str(saved),
        )
        visit = Run(folder)
        at_once = bool(visit.tracked) and visit.tracked[0] <= SOON
        sight = ""
        visited = Depths.of(args.visit[0], folder)
        if room and visited and not args.elsewhere:
            seen = most_seen(room, visited, known.stamps, visit.stamps[: SOON + 1])
            could += seen >= SEEN
            could_soon += seen >= SEEN and at_once
            sight = f" ({100 * seen:.0f} % of it was seen)"
        if not visit.tracked:
            print(f"start {start}{sight}: not found. {said}", flush=True)
            continue
        found += 1
        waits.append(visit.tracked[0])
        soon += at_once
        m, d = visit.errors(T_truth_map) if not args.elsewhere else ([], [])
        is_wrong = args.elsewhere or (len(m) > 0 and (max(m) > WRONG_M or max(d) > WRONG_DEG))
        wrong += is_wrong
        metres.extend(m)
        degrees.extend(d)
        print(
            f"start {start}{sight}: found at frame {visit.tracked[0]}, {len(visit.tracked)} of "
            f"{len(visit.stamps)} tracked, {100 * rmse(m):.2f} cm"
            f"{', WRONG' if is_wrong else ''}",
            flush=True,
        )
    result = {
        "starts": len(starts),
        "found": found,
        "found_within_1_s": int(soon),
        "saw_something_mapped": int(could),
        "of_these_found_within_1_s": int(could_soon),
        "wrong": int(wrong),
        "median_wait_frames": float(np.median(waits)) if waits else None,
        "rmse_cm": 100 * rmse(metres),
        "largest_cm": 100 * max(metres, default=np.nan),
        "rmse_deg": rmse(degrees),
        "map_rmse_cm": 100 * rmse(known.errors(T_truth_map)[0]),
        "map_megabytes": saved.stat().st_size / 1e6,
        "map_byte_equal": hashlib.sha256(saved.read_bytes()).hexdigest() == before,
    }
    if args.whole:
        run(args, args.map[0], f"{args.map[1].split(':')[0]}:{last}", args.out / "whole")
        whole = Run(args.out / "whole")
        T = whole.alignment(until_s=known.stamps[-1])
        result["whole_rmse_cm"] = 100 * rmse(whole.errors(T, since_s=known.stamps[-1])[0])
    print(json.dumps(result, indent=1))


if __name__ == "__main__":
    main()
