# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Kills runs that go on with a map, with SIGKILL at random moments, and looks at both maps.

Usage: continue_test.py SGS_EXECUTABLE [TIMES [INPUT]]

The map that the run began with must be as it was, byte by byte; what lies in the run's own folder is
a whole map of two sessions, or none. Every second kill falls into the last tenth of the run, where
the map is written.
"""
import hashlib
import json
import os
import pathlib
import random
import subprocess
import sys
import tempfile
import time

SMALL = ("--max-width", "320", "--threads", "1", "--no-eval", "--quiet")


def main():
    sgs = str(pathlib.Path(sys.argv[1]).resolve())
    times = int(sys.argv[2]) if len(sys.argv) > 2 else 4
    seed = int(os.environ.get("SGS_KILL_SEED", random.randrange(2**31)))
    chance = random.Random(seed)
    print(f"seed {seed} (SGS_KILL_SEED repeats it)")
    with tempfile.TemporaryDirectory(prefix="sgs-continue-") as folder:
        scratch = pathlib.Path(folder)
        source = sys.argv[3] if len(sys.argv) > 3 else str(scratch / "input")
        if len(sys.argv) <= 3:
            subprocess.run(
                [sgs, "synth", "room_desk", source, "--frames", "60", "--quiet"], check=True
            )

        def command(frames, out, *more):
            return [sgs, "run", source, "--frames", frames, "-o", str(out), *SMALL, *more]

        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        subprocess.run(command("0:30", scratch / "first"), check=True, **quiet)
        old = scratch / "first" / "map.sgsmap"
        expected = hashlib.sha256(old.read_bytes()).hexdigest()
        out = scratch / "out"
        going_on = command("30:60", out, "--continue", str(old))
        began = time.monotonic()
        subprocess.run(going_on, check=True, **quiet)
        length = time.monotonic() - began
        whole = 0
        for i in range(times):
            new = out / "map.sgsmap"
            new.unlink(missing_ok=True)
            after = chance.uniform(0.9 * length if i % 2 else 0, 1.02 * length)
            with subprocess.Popen(going_on, **quiet) as process:
                try:
                    process.wait(after)
                except subprocess.TimeoutExpired:
                    process.kill()
                process.wait()
            if hashlib.sha256(old.read_bytes()).hexdigest() != expected:
                sys.exit(f"FAILED: killed after {after:.3f} s, the old map has changed")
            if new.exists():
                whole += 1
                told = subprocess.run(
                    [sgs, "info", str(new), "--json"], capture_output=True, text=True, check=False
                )
                if told.returncode != 0 or len(json.loads(told.stdout)["sessions"]) != 2:
                    sys.exit(f"FAILED: killed after {after:.3f} s, half a map: {told.stderr}")
    print(f"{times} kills: the old map is whole; {whole} times the new one was there, whole")


if __name__ == "__main__":
    main()
