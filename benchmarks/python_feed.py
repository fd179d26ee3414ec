# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""What feeding frames from Python costs against the executable, in frames per second.

    python_feed.py SGS_EXECUTABLE PACKAGE_FOLDER INPUT [--frames a:b] [--pairs N] [--set key=value]...

Both have all frames in memory before the clock starts (--preload); the runs alternate, and what counts
is the ratio of neighbours. On a machine that others use, frames per second say little: then compare the
CPU seconds of feeding arrays with those of feeding a recording's frames, which does in Python exactly
what the executable does.
"""
import argparse
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
parser.add_argument("sgs")
parser.add_argument("package")
parser.add_argument("input")
parser.add_argument("--frames", default="0:300")
parser.add_argument("--pairs", type=int, default=3)
parser.add_argument("--set", action="append", default=[], metavar="key=value")
options = parser.parse_args()
sys.path.insert(0, options.package)
import numpy as np  # noqa: E402
import sgs  # noqa: E402


def executable():
    with tempfile.TemporaryDirectory(prefix="sgs-feed-") as folder:
        command = [options.sgs, "run", options.input, "--frames", options.frames, "--preload"]
        command += ["--no-eval", "--json", "--quiet", "-o", str(pathlib.Path(folder) / "run")]
        for assignment in options.set:
            command += ["--set", assignment]
        done = subprocess.run(command, check=True, capture_output=True, text=True)
        return json.loads(done.stdout)["fps_wall"]


def fed(camera, feed_all):
    """Frames per second and CPU seconds per frame of a session."""
    config = sgs.Config()
    for assignment in options.set:
        key, value = assignment.split("=", 1)
        config[key] = value
    session = sgs.Session(camera, config)
    began, cpu = time.monotonic(), time.process_time()
    feed_all(session)
    session.finish()
    count = len(session.frames())
    return count / (time.monotonic() - began), (time.process_time() - cpu) / count


recording = sgs.open(options.input, frames=options.frames)
shared = list(recording)
arrays = [(np.array(f.color), np.array(f.depth), f.time) for f in shared]
raw = [(c, np.round(d * 5000).astype(np.uint16), t) for c, d, t in arrays]


def feed_shared(session):
    for frame in shared:
        session.feed(frame)


def feed_float32(session):
    for color, depth, stamp in arrays:
        session.feed(color, depth, stamp)


def feed_uint16(session):
    for color, depth, stamp in raw:
        session.feed(color, depth, stamp, depth_scale=5000)


WAYS = {"shared frames": feed_shared, "float32": feed_float32, "uint16": feed_uint16}
ratios = {name: [] for name in WAYS}
costs = {name: [] for name in WAYS}
for _ in range(options.pairs):
    reference = executable()
    print(f"executable           {reference:7.1f} frames/s")
    for name, feed_all in WAYS.items():
        speed, cpu = fed(recording.camera, feed_all)
        ratios[name].append(speed / reference)
        costs[name].append(cpu)
        print(
            f"Python, {name:13}{speed:7.1f} frames/s   CPU {1e3 * cpu:6.2f} ms a frame", flush=True
        )
for name in WAYS:
    cpu = statistics.median(costs[name]) / statistics.median(costs["shared frames"])
    print(
        f"{name:13} frames per second {statistics.median(ratios[name]):.3f} of the executable's, "
        f"CPU {cpu:.3f} of shared frames'"
    )
