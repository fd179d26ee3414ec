# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Kills runs with SIGKILL at random moments, goes on with them and compares the results.

Usage: resume_test.py SGS_EXECUTABLE [TIMES [INPUT ...]]

Every second run is killed again while it goes on. In the end trajectory and map must be those of a
run that nobody killed, to the bit, and no frame that was on the disk may be gone at any moment.
Prints where the runs went on and how long that took.
"""
import contextlib
import os
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import time

RESULTS = ("trajectory.txt", "trajectory_online.txt", "keyframes.txt", "map.ply", "config.toml")


class Failure(Exception):
    pass


def check(condition, what):
    if not condition:
        raise Failure(what)


def play(sgs, arguments, kill_after_s=None):
    """Runs sgs; returns its exit code (None: killed), seconds and what it said."""
    began = time.monotonic()
    process = subprocess.Popen(
        [sgs, "run", *map(str, arguments), "--no-eval", "--quiet"],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        said = process.communicate(timeout=kill_after_s)[1]
        return process.returncode, time.monotonic() - began, said
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        return None, time.monotonic() - began, ""


def lines_of(path):
    return path.read_bytes().count(b"\n") if path.exists() else 0


def resume(sgs, out, kill_after_s=None):
    before = lines_of(out / "frames.csv")
    code, seconds, said = play(sgs, ["--resume", out, "--checkpoint", 0.5], kill_after_s)
    check(code in (None, 0, 3), f"resume: exit code {code}\n{said}")
    check(lines_of(out / "frames.csv") >= before, "frames are gone that were on the disk")
    return code, seconds


def unfinished(out):
    return (out / "config.toml").exists() and "running" in (out / "state.toml").read_text()


def compare(out, whole):
    for name in RESULTS:
        same = (out / name).read_bytes() == (whole / name).read_bytes()
        check(same, f"{name} is not that of a run that nobody killed")
    check("finished" in (out / "state.toml").read_text(), "not finished")
    left = [p.name for p in out.rglob("*") if p.name.startswith("checkpoint") or p.suffix == ".tmp"]
    check(not left, f"left over: {left}")


def kill_and_resume(sgs, source, whole, whole_s, out, chance, again):
    code, killed_s, said = play(
        sgs, [source, "-o", out, "--checkpoint", 0.5], chance.uniform(0, whole_s)
    )
    check(code in (None, 0, 3), f"run: exit code {code}\n{said}")
    if not unfinished(out):
        return None
    if again:
        again = resume(sgs, out, chance.uniform(0, whole_s))[0] is None
    # Killed between its last word and its end, it leaves nothing to go on with.
    if again and not unfinished(out):
        return None
    if unfinished(out):
        code, seconds = resume(sgs, out)
        check(code is not None, "killed without a reason")
    compare(out, whole)
    frames = re.findall(r"goes on at frame (\d+)", (out / "log.txt").read_text())
    return {"killed after": killed_s, "went on at": frames, "killed again": again}


def main():
    sgs = str(pathlib.Path(sys.argv[1]).resolve())
    times = int(sys.argv[2]) if len(sys.argv) > 2 else 3
    inputs = sys.argv[3:]
    seed = int(os.environ.get("SGS_KILL_SEED", random.randrange(2**31)))
    chance = random.Random(seed)
    print(f"seed {seed} (SGS_KILL_SEED repeats it)")
    with tempfile.TemporaryDirectory(prefix="sgs-resume-") as folder:
        scratch = pathlib.Path(folder)
        if not inputs:
            inputs = [str(scratch / "input")]
            subprocess.run(
                [sgs, "synth", "room_desk", inputs[0], "--frames", "60", "--quiet"], check=True
            )
        wholes = {}
        for i, source in enumerate(inputs):
            code, seconds, said = play(sgs, [source, "-o", scratch / f"whole-{i}"])
            check(code in (0, 3), f"{source} cannot be run\n{said}")
            wholes[source] = (scratch / f"whole-{i}", seconds)
        done = went_on = 0
        while done < times:
            source = inputs[done % len(inputs)]
            whole, whole_s = wholes[source]
            out = scratch / "out"
            result = kill_and_resume(sgs, source, whole, whole_s, out, chance, done % 2 == 1)
            if result is None:
                continue  # killed before it had begun, or not at all
            done += 1
            went_on += any(int(frame) > 0 for frame in result["went on at"])
            print(result, flush=True)
    print(
        f"{done} of {done} runs came to the same bits, {went_on} of them went on from a checkpoint"
    )


if __name__ == "__main__":
    try:
        with contextlib.suppress(KeyboardInterrupt):
            main()
    except Failure as failure:
        sys.exit(f"FAILED: {failure}")
