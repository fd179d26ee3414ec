# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Kills runs with SIGKILL at random moments and reads what they left behind.

Usage: kill_test.py SGS_EXECUTABLE [TIMES [INPUT ...]]

Every command that reads a run must work on what is there and say that it is not finished, and every
frame that was shown on the terminal a second before the kill must be in the folder. Prints how old
the oldest lost frame was, how old the map, and which moments were hit.
"""
import contextlib
import json
import os
import pathlib
import pty
import random
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time

PROMISE_S = 1.0


class Watched:
    """A run on a terminal of its own; knows when it showed how many frames."""

    def __init__(self, sgs, source, out, *arguments):
        self.shown = []
        self.text = ""
        primary, secondary = pty.openpty()
        self.process = subprocess.Popen(
            [sgs, "run", source, "-o", out, *arguments],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=secondary,
            cwd=out.parent,
        )
        os.close(secondary)
        self.primary = primary
        self.thread = threading.Thread(target=self.read)
        self.thread.start()

    def read(self):
        with contextlib.suppress(OSError):  # the other end is gone: the run has ended
            while block := os.read(self.primary, 4096):
                now = time.monotonic()
                self.text += block.decode(errors="replace")
                frames = re.findall(r"(\d+)/\d+ frames ", self.text[-400:])
                if frames:
                    self.shown.append((now, int(frames[-1])))

    def end(self, kill=False):
        if kill:
            self.process.send_signal(signal.SIGKILL)
        self.ended = time.monotonic()
        code = self.process.wait()
        self.thread.join()
        os.close(self.primary)
        return code


class Failure(Exception):
    pass


def check(condition, what):
    if not condition:
        raise Failure(what)


def sgs_says(sgs, *arguments):
    """Runs a reader; it must end well, or with a message that says how little is there."""
    done = subprocess.run(
        [sgs, *map(str, arguments)], capture_output=True, text=True, timeout=300, check=False
    )
    check(done.returncode in (0, 1), f"{arguments}: exit code {done.returncode}\n{done.stderr}")
    if done.returncode == 1:
        little = r"has not begun|no frame yet|first checkpoint|no keyframes|only just begun|not a folder|nowhere"
        check(re.search(little, done.stderr), f"{arguments}: {done.stderr}")
    return done


def view(sgs, out):
    """Starts the viewer on the folder and ends it when it is there, or takes its message."""
    with subprocess.Popen(
        [sgs, "view", out, "--port", "0"], stderr=subprocess.PIPE, text=True
    ) as process:
        text = ""
        for line in process.stderr:
            text += line
            if line.startswith("viewer"):
                process.send_signal(signal.SIGINT)
        code = process.wait()
    check(code in (0, 1, 130), f"view: exit code {code}\n{text}")
    check("viewer" in text or re.search("has not begun|only just begun", text), f"view: {text}")


def map_of(out):
    """Where the map lies: with the results, or in the checkpoint that counts."""
    name = out / "checkpoint.txt"
    return out / name.read_text().strip() / "map.ply" if name.exists() else out / "map.ply"


def lines_of(path):
    if not path.exists():
        return 0
    return max(0, path.read_bytes().count(b"\n") - 1)  # the first line is no frame


def look(sgs, out, scratch, frames_needed):
    """Everything that reads a run, on what is left of one. Returns the frames that are there."""
    if not (out / "state.toml").exists():
        check(frames_needed == 0, f"{frames_needed} frames were shown, and there is no folder")
        return 0
    state = (out / "state.toml").read_text()
    finished = 'state = "finished"' in state
    check(finished or 'state = "running"' in state, state)
    frames = lines_of(out / "frames.csv")
    check(frames >= frames_needed, f"{frames} frames are there, {frames_needed} were done")
    done = sgs_says(sgs, "eval", out, "--json", "--quiet")
    if not finished:
        check("was killed" in done.stderr or "begun" in done.stderr, done.stderr)
    if done.returncode == 0:
        metrics = json.loads(done.stdout)
        check(metrics["state"] == ("finished" if finished else "killed"), metrics["state"])
        check(metrics["frames_tracked"] + metrics["frames_lost"] <= frames, "frames from nowhere")
        check((metrics["psnr_db"] is not None) == map_of(out).exists(), "scores and map")
    if (out / "trajectory.txt").exists():
        check(sgs_says(sgs, "export", out, "tum", scratch / "x.tum").returncode == 0, "tum")
    if map_of(out).exists():
        check(sgs_says(sgs, "export", out, "ply", scratch / "x.ply").returncode == 0, "ply")
        sgs_says(sgs, "render", out, "-o", scratch / "r", "--every", 50, "--quiet")
    view(sgs, out)
    return frames


def kill_once(sgs, source, out, scratch, after_s):
    run = Watched(sgs, source, out, "--no-eval")
    began = time.monotonic()
    with contextlib.suppress(subprocess.TimeoutExpired):
        run.process.wait(after_s)
    run.end(kill=True)
    killed_at = run.ended
    killed_s = time.time() - (time.monotonic() - killed_at)
    kept = map_of(out)
    map_age = killed_s - kept.stat().st_mtime if kept.exists() else None
    promised = [n for t, n in run.shown if t <= killed_at - PROMISE_S]
    frames = look(sgs, out, scratch, max(promised, default=0))
    lost = [killed_at - t for t, n in run.shown if n > frames]
    return {
        "after": killed_at - began,
        "frames": frames,
        "shown": max((n for _, n in run.shown), default=0),
        "lost_age": max(lost, default=0),
        "map_age": map_age,
    }


def main():
    sgs = str(pathlib.Path(sys.argv[1]).resolve())
    times = int(sys.argv[2]) if len(sys.argv) > 2 else 4
    inputs = sys.argv[3:]
    seed = int(os.environ.get("SGS_KILL_SEED", random.randrange(2**31)))
    chance = random.Random(seed)
    print(f"seed {seed} (SGS_KILL_SEED repeats it)")
    with tempfile.TemporaryDirectory(prefix="sgs-kill-") as folder:
        scratch = pathlib.Path(folder)
        if not inputs:
            inputs = [str(scratch / "input")]
            subprocess.run(
                [sgs, "synth", "room_desk", inputs[0], "--frames", "60", "--quiet"], check=True
            )
        lengths = {}
        for source in inputs:
            began = time.monotonic()
            whole = Watched(sgs, source, scratch / "whole", "--no-eval")
            check(whole.end() in (0, 3), f"{source} cannot be run")
            lengths[source] = time.monotonic() - began
        results = []
        out = scratch / "out"  # the same each time: a killed run may not mix with the one before
        for i in range(times):
            source = inputs[i % len(inputs)]
            result = kill_once(sgs, source, out, scratch, chance.uniform(0, 1.05 * lengths[source]))
            results.append(result)
            print(" ".join(f"{k} {v:.2f}" for k, v in result.items() if v is not None), flush=True)
    print(
        f"{times} kills: oldest lost frame {max(r['lost_age'] for r in results):.2f} s, oldest map "
        f"{max((r['map_age'] or 0) for r in results):.1f} s"
    )


if __name__ == "__main__":
    try:
        main()
    except Failure as failure:
        sys.exit(f"FAILED: {failure}")
