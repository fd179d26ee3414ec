#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Runs live for a long time on looped input, with viewers coming and going, and watches the process.

Usage: scripts/soak.py SGS_EXECUTABLE MINUTES [RECORDING]

RECORDING is a folder in TUM layout (default: a synthetic one of 20 s, rendered first). It is played to
and fro, so that the camera never jumps and the map ends somewhere. Every few seconds the script notes
memory, handles, threads and the time that tracking takes; in the end it says how they have changed
since the map was full (taken to be after a third of the time). Exits with 1 where handles or threads
have grown, or the run did not end well. Memory, drift of the latency and dropped frames are printed to
be judged: on a busy machine they say more about the machine.
"""
import csv
import os
import pathlib
import random
import re
import statistics
import subprocess
import sys
import tempfile
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests/viewer"))
from ws_client import Client, Closed  # noqa: E402


def rows_of(path):
    lines = path.read_text().splitlines()
    return [line.split() for line in lines if line and not line.startswith("#")]


def make_loop(source, loop, seconds):
    """A recording that plays `source` to and fro for so long, by links to its pictures."""
    colors, depths = rows_of(source / "rgb.txt"), rows_of(source / "depth.txt")
    count = min(len(colors), len(depths))
    step = (float(colors[count - 1][0]) - float(colors[0][0])) / (count - 1)
    order = [*range(count), *range(count - 2, 0, -1)]
    loop.mkdir()
    for name in ("rgb", "depth"):
        (loop / name).symlink_to(source / name)
    for file in source.iterdir():
        if file.is_file() and file.name not in ("rgb.txt", "depth.txt", "groundtruth.txt"):
            (loop / file.name).symlink_to(file)
    with open(loop / "rgb.txt", "w") as rgb, open(loop / "depth.txt", "w") as depth:
        for i in range(int(seconds / step)):
            k = order[i % len(order)]
            print(f"{1000 + i * step:.6f} {colors[k][1]}", file=rgb)
            print(f"{1000 + i * step:.6f} {depths[k][1]}", file=depth)


def status(pid):
    text = pathlib.Path(f"/proc/{pid}/status").read_text()
    value = lambda key: int(re.search(rf"{key}:\s+(\d+)", text).group(1))
    return {
        "memory_mb": value("VmRSS") / 1024,
        "handles": len(os.listdir(f"/proc/{pid}/fd")),
        "threads": value("Threads"),
    }


def watch(port, stop):
    """One viewer after the other, each for some seconds, some of them leaving in the middle."""
    chance = random.Random(port)
    while not stop.is_set():
        try:
            with Client(port, timeout=10) as client:
                panes = chance.sample(["color", "depth", "render", "error"], chance.randrange(5))
                client.send(
                    {"type": "subscribe", "map": chance.choice(["splats", "none"]), "panes": panes}
                )
                until = time.monotonic() + chance.uniform(0.5, 8)
                while time.monotonic() < until and not stop.is_set():
                    client.receive()
        except (Closed, OSError):
            time.sleep(0.2)


def port_of(log):
    while True:
        found = re.search(r"http://[^:\s]+:(\d+)", log.read_text())
        if found:
            return int(found.group(1))
        time.sleep(0.1)


def follow(process, samples):
    while process.poll() is None:
        try:
            samples.append(status(process.pid))
        except (FileNotFoundError, ProcessLookupError, AttributeError):
            break
        time.sleep(2)


def quantile(values, share):
    return sorted(values)[min(len(values) - 1, int(share * len(values)))]


def report(samples, out):
    """What has changed since the first third; True where nothing leaks."""
    full = samples[len(samples) // 3 : -3]  # the last ones may see the end of the run
    part = max(1, len(full) // 10)
    first, last = full[:part], full[-part:]
    sound = True
    for key in ("memory_mb", "handles", "threads"):
        a, b = (statistics.median(s[key] for s in part) for part in (first, last))
        print(
            f"{key}: {a:.0f} -> {b:.0f} ({100 * (b / a - 1):+.1f} %), most {max(s[key] for s in full):.0f}"
        )
        # Viewers that happen to be there have handles.
        sound = sound and (key == "memory_mb" or b <= a + 8)
    with open(out / "frames.csv") as file:
        frames = list(csv.DictReader(file))
    cost = [float(row["track_ms"]) for row in frames if row["track_ms"]]
    third = len(cost) // 3
    for name, part in (("first", cost[:third]), ("last", cost[-third:])):
        print(
            f"tracking, {name} third: median {quantile(part, 0.5):.2f} ms, p95 {quantile(part, 0.95):.2f} ms"
        )
    part = max(1, len(frames) // 10)
    print("in tenths: memory (MB), mapping steps a frame, thousands of Gaussians, loops")
    for tenth in range(10):
        rows = frames[tenth * part : (tenth + 1) * part]
        seen = (
            samples[tenth * len(samples) // 10 : (tenth + 1) * len(samples) // 10] or samples[-1:]
        )
        steps = int(rows[-1]["mapping_iterations"]) - int(rows[0]["mapping_iterations"])
        print(
            f"  {statistics.median(s['memory_mb'] for s in seen):.0f}, {steps / len(rows):.1f}, "
            f"{int(rows[-1]['gaussians']) / 1000:.1f}, {rows[-1]['loops']}"
        )
    indices = int(frames[-1]["index"]) + 1
    print(f"frames: {indices} came, {indices - len(frames)} dropped")
    return sound


def recording(sgs, scratch):
    """The one that was named, or a rendered one."""
    if len(sys.argv) > 3:
        return pathlib.Path(sys.argv[3]).resolve()
    source = scratch / "input"
    subprocess.run([sgs, "synth", "office", source, "--frames", "600", "--quiet"], check=True)
    return source


def main():
    sgs, minutes = str(pathlib.Path(sys.argv[1]).resolve()), float(sys.argv[2])
    with tempfile.TemporaryDirectory(prefix="sgs-soak-") as folder:
        scratch = pathlib.Path(folder)
        make_loop(recording(sgs, scratch), scratch / "loop", 60 * minutes)
        log, out, samples, stop = scratch / "log", scratch / "out", [], threading.Event()
        with open(log, "w") as said:
            process = subprocess.Popen(
                [
                    sgs,
                    "run",
                    scratch / "loop",
                    "-o",
                    out,
                    "--realtime",
                    "--viewer",
                    "0",
                    "--no-eval",
                ],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=said,
            )
        port = port_of(log)
        viewers = [threading.Thread(target=watch, args=(port, stop), daemon=True) for _ in range(4)]
        for viewer in viewers:
            viewer.start()
        follow(process, samples)
        stop.set()
        code = process.wait()
        print(f"exit code {code}, {len(samples)} samples")
        if code not in (0, 3):
            print(log.read_text()[-2000:])
            return 1
        return 0 if report(samples, out) else 1


if __name__ == "__main__":
    sys.exit(main())
