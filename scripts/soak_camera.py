#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""A live session for a long time from a camera that is none, with four viewers and ten unplugs.

Usage: scripts/soak_camera.py SGS_EXECUTABLE FOLDER_OF_FAKES [--minutes 30] [--unplugs 10] [--fps 30]

FOLDER_OF_FAKES is tests/fake_cameras of a build folder. The fake of librealsense2 plays a rendered
room to and fro at 640x480. Judged, each on a line of its own:
  frames dropped, by tracking or by the camera's program
  memory, from the first third of the time to its end: within 3 %
  handles and threads, before the first unplug and after the last
  the camera's program: at most 8 % of a core
Exits with 1 where one of them is missed. A busy machine drops frames: run it alone. Memory is only
printed where it runs for less than ten minutes: the map is still growing.
"""
import argparse
import csv
import json
import os
import pathlib
import re
import signal
import statistics
import subprocess
import sys
import tempfile
import threading
import time

from soak import Client, Closed, port_of, status

ROOT = pathlib.Path(__file__).resolve().parent.parent
VIEWERS = 4
AWAY_S = 2  # that a camera is unplugged
MOST_MEMORY, MOST_CPU = 0.03, 0.08
JUDGED_MINUTES = 10
PROGRAM = "sgs-camera-realsense"


def render_scene(sgs, scratch, fps):
    """What the fake plays: some seconds of a room."""
    source = scratch / "room"
    command = [sgs, "synth", "room_desk", source, "--frames", str(4 * fps), "--quiet"]
    subprocess.run(command, check=True)
    sys.path.insert(0, str(ROOT / "tests/cameras"))
    sys.argv = [sys.argv[0], *3 * [str(sgs)]]  # what the tests' module takes
    from fake_cameras import Recorded, write_scene

    recorded = Recorded(source)
    recorded.times = [1000 + i / fps for i in range(len(recorded.times))]
    write_scene(scratch / "scene", recorded, recorded)


def stay(port, stop, seen, k):
    """A viewer of everything, who comes back when sent away."""
    while not stop.is_set():
        try:
            with Client(port, timeout=10) as client:
                panes = ["color", "depth", "render", "error"][: k + 1]
                client.send({"type": "subscribe", "map": "splats", "panes": panes})
                while not stop.is_set():
                    client.receive()
                    seen[k] += 1
        except (Closed, OSError):
            time.sleep(0.2)


def helper_of(pid):
    """Process number of the camera's program, or None."""
    for child in pathlib.Path(f"/proc/{pid}/task").glob("*/children"):
        try:
            for one in child.read_text().split():
                if pathlib.Path(f"/proc/{one}/comm").read_text().strip() == PROGRAM[:15]:
                    return int(one)
        except OSError:
            continue
    return None


def cpu_seconds(pid):
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class Helper:
    """How much the camera's program works, over all that are started one after the other."""

    def __init__(self):
        self.pid, self.used_s, self.lived_s, self.last = None, 0.0, 0.0, None

    def look(self, parent):
        pid, now = helper_of(parent), time.monotonic()
        try:
            used = cpu_seconds(pid) if pid else None
        except (OSError, IndexError):
            used = None
        # The first look is left out: it loads the scene.
        if used is not None and pid == self.pid and self.last is not None:
            self.used_s += used - self.last[0]
            self.lived_s += now - self.last[1]
        self.pid, self.last = pid, None if used is None else (used, now)


def follow(process, minutes, samples, helper):
    until = time.monotonic() + 60 * minutes
    while process.poll() is None and time.monotonic() < until:
        try:
            samples.append(status(process.pid))
        except (OSError, AttributeError):
            break
        helper.look(process.pid)
        time.sleep(1)


def median_of(samples, key):
    return statistics.median(sample[key] for sample in samples)


def judge(name, value, good):
    print(f"{'ok    ' if good else 'MISSED'} {name}: {value}")
    return good


def report(args, out, samples, helper, seen):
    metrics = json.loads((out / "metrics.json").read_text())
    log = (out / "log.txt").read_text()
    with open(out / "frames.csv") as file:
        frames = list(csv.DictReader(file))
    lost = sum(row["status"] == "lost" for row in frames)
    by_program = sum(int(n) for n in re.findall(r"(\d+) images were dropped", log))
    unplugged = log.count("the camera was unplugged")
    print(f"{len(frames)} frames, {lost} lost, {len(samples)} samples; unplugged {unplugged} times")
    print(f"messages to each viewer: {', '.join(map(str, seen))}")
    sound = judge(
        "frames dropped by tracking", metrics["frames_dropped"], metrics["frames_dropped"] == 0
    )
    sound &= judge("images dropped by the camera's program", by_program, by_program == 0)
    sound &= judge("unplugs", f"{unplugged} of {args.unplugs}", unplugged == args.unplugs)
    sound &= judge("viewers that were served", sum(n > 0 for n in seen), all(seen))
    tenth = max(1, len(samples) // 10)
    before, after = samples[tenth : 2 * tenth], samples[-tenth:]
    for key in "handles", "threads":
        a, b = median_of(before, key), median_of(after, key)
        sound &= judge(key, f"{a:.0f} -> {b:.0f}", b <= a)
    third = len(samples) // 3
    a, b = median_of(samples[third : third + tenth], "memory_mb"), median_of(after, "memory_mb")
    words = f"{a:.0f} -> {b:.0f} MB ({100 * (b / a - 1):+.1f} %)"
    if args.minutes < JUDGED_MINUTES:
        print(f"       memory: {words}, not judged")
    else:
        sound &= judge("memory", words, abs(b / a - 1) <= MOST_MEMORY)
    share = helper.used_s / max(helper.lived_s, 1e-9)
    sound &= judge("the camera's program", f"{100 * share:.1f} % of a core", share <= MOST_CPU)
    return sound


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sgs", type=pathlib.Path)
    parser.add_argument("fakes", type=pathlib.Path)
    parser.add_argument("--minutes", type=float, default=30)
    parser.add_argument("--unplugs", type=int, default=10)
    parser.add_argument("--fps", type=int, default=30)
    args = parser.parse_args()
    sgs, fake = args.sgs.resolve(), args.fakes.resolve() / "fake_realsense_whole.so"
    with tempfile.TemporaryDirectory(prefix="sgs-soak-") as folder:
        scratch = pathlib.Path(folder)
        (scratch / "state").mkdir()
        render_scene(sgs, scratch, args.fps)
        # The last unplug lies well before the end.
        every = int(0.9 * 60 * args.minutes * args.fps / (args.unplugs + 1)) if args.unplugs else 0
        environment = {
            **os.environ,
            "SGS_REALSENSE_LIBRARY": str(fake),
            "FAKE_CAMERA_SCENE": str(scratch / "scene"),
            "FAKE_CAMERA_STATE": str(scratch / "state"),
            "FAKE_CAMERA_RATE": str(args.fps),
            "FAKE_CAMERA_LOOP": "1",
            "FAKE_CAMERA_UNPLUG_EVERY": str(every),
            "FAKE_CAMERA_UNPLUGS": str(args.unplugs),
            "FAKE_CAMERA_AWAY_S": str(AWAY_S),
        }
        log, out, stop, seen = scratch / "log", scratch / "out", threading.Event(), [0] * VIEWERS
        command = [
            sgs,
            "run",
            f"camera:realsense,fps={args.fps}",
            "-o",
            out,
            "--viewer",
            "0",
            "--no-eval",
        ]
        samples, helper = [], Helper()
        with open(log, "w") as said:
            quiet = subprocess.DEVNULL
            process = subprocess.Popen(
                command, stdin=quiet, stdout=quiet, stderr=said, env=environment
            )
        port = port_of(log)
        viewers = [
            threading.Thread(target=stay, args=(port, stop, seen, k), daemon=True)
            for k in range(VIEWERS)
        ]
        for viewer in viewers:
            viewer.start()
        follow(process, args.minutes, samples, helper)
        process.send_signal(signal.SIGINT)
        stop.set()
        code = process.wait()
        if code != 130:
            print(f"exit code {code}\n{log.read_text()[-3000:]}")
            return 1
        return 0 if report(args, out, samples, helper, seen) else 1


if __name__ == "__main__":
    sys.exit(main())
