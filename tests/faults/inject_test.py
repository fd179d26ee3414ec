# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Lets the n-th call of one kind fail in a short run, for n = 1, 2, 3, ...

Usage: inject_test.py SGS_EXECUTABLE INJECT_LIBRARY [POINTS [KIND ...]]

Kinds: memory, large (memory of 64 KiB or more), write, sync, rename, read (comes back with half),
thread. Of kinds with more calls than POINTS (default 20) as many are taken, evenly spread. Each fault
comes once and, but for memory and read, also for good. Whatever fails: no crash, no hang, a message, and what was computed or on the disk
before is there, in the run folder or where the message says.
"""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

KINDS = ("memory", "large", "write", "sync", "rename", "read", "thread")
FRAMES = 8
LONGEST_S = 120


class Failure(Exception):
    pass


def check(condition, what):
    if not condition:
        raise Failure(what)


class Sgs:
    def __init__(self, executable, library, scratch):
        self.executable, self.library, self.scratch = executable, library, scratch

    def __call__(self, *arguments, fault=None, stays=False, start=None):
        """Runs sgs with a fault; returns exit code, what it said and how many calls there were."""
        # Without the pool every block comes from the C library, and each request is a failure point.
        environment = dict(os.environ, TMPDIR=str(self.scratch / "tmp"), SGS_PAGE_POOL="0")
        count = self.scratch / "count"
        count.unlink(missing_ok=True)
        if fault:
            environment.update(LD_PRELOAD=self.library, SGS_FAULT=fault, SGS_FAULT_COUNT=str(count))
            if stays:
                environment["SGS_FAULT_STAYS"] = "1"
            if start:
                environment["SGS_FAULT_FROM"] = start
        try:
            done = subprocess.run(
                [self.executable, *map(str, arguments)],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                text=True,
                errors="replace",
                env=environment,
                cwd=self.scratch,
                timeout=LONGEST_S,
                check=False,
            )
        except subprocess.TimeoutExpired:
            raise Failure(f"{fault}: hangs") from None
        calls = int(count.read_text()) if count.exists() and count.read_text().strip() else 0
        return done.returncode, done.stderr, calls


def places(out, said):
    """The folders in which results may lie."""
    kept = re.findall(r"was kept in (\S+)", said)
    return [out, *map(pathlib.Path, kept)]


def there(name, folders):
    return any((folder / name).exists() for folder in folders)


class Run:
    """A run of a few small frames."""

    start = "lock.txt"

    def __init__(self, sgs, recording, out):
        self.sgs, self.out = sgs, out
        self.arguments = ["run", recording, "-o", out, "--max-width", 160, "--no-eval", "--quiet"]

    def prepare(self):
        subprocess.run(["rm", "-rf", self.out], check=True)

    def verify(self, code, said):
        if not (self.out / "state.toml").exists():
            return check(code == 1, "no folder and no failure")
        state = (self.out / "state.toml").read_text()
        if code == 0:
            check('state = "finished"' in state, f"exit code 0, and yet {state}")
            lines = (self.out / "frames.csv").read_text().count("\n")
            check(lines == FRAMES + 1, f"{lines - 1} frames")
        if 'state = "running"' in state:
            return None
        # It has ended well enough to say so: then there is something to show for it.
        begun = (self.out / "config.toml").exists()
        if begun and "frames = 0" not in state:
            for name in ("trajectory.txt", "frames.csv"):
                check(there(name, places(self.out, said)), f"{name} is nowhere\n{said}")
        return None


class Eval:
    """Scoring of a run that is there: its results stay, whatever happens."""

    start = "config.toml"

    def __init__(self, sgs, recording, out):
        self.sgs, self.out = sgs, out
        code, said, _ = sgs("run", recording, "-o", out, "--max-width", 160, "--no-eval", "--quiet")
        check(code in (0, 3), said)
        self.arguments = ["eval", out, "--quiet"]
        self.before = self.results()

    def results(self):
        names = ("trajectory.txt", "map.ply", "keyframes.txt", "frames.csv", "state.toml")
        return {name: (self.out / name).read_bytes() for name in names}

    def prepare(self):
        pass

    def verify(self, _code, _said):
        check(self.results() == self.before, "a result has changed")
        scores = self.out / "metrics.json"
        if scores.exists():
            json.loads(scores.read_text())


class Resume:
    """Going on with a run that had stopped: then or later it comes to the bits of a whole one."""

    start = "lock.txt"

    def __init__(self, sgs, recording, scratch):
        self.sgs, self.out, self.stopped = sgs, scratch / "again", scratch / "stopped"
        small = ["--max-width", 160, "--no-eval", "--quiet"]
        code, said, _ = sgs("run", recording, "-o", scratch / "whole", *small)
        check(code in (0, 3), said)
        self.whole = self.results(scratch / "whole")
        # A lack of memory in the middle is a run that stops with a checkpoint; where the middle is
        # depends on how often memory is asked for before and after the frames.
        arguments = ["run", recording, "-o", self.stopped, *small]
        calls = sgs(*arguments, fault="memory:0", start=self.start)[2]
        tries = 40
        for part in sorted(range(1, tries), key=lambda part: abs(2 * part - tries)):
            subprocess.run(["rm", "-rf", self.stopped], check=True)
            sgs(*arguments, fault=f"memory:{calls * part // tries}", start=self.start)
            if (self.stopped / "checkpoint.txt").exists():
                break
        check((self.stopped / "checkpoint.txt").exists(), "no run that can be gone on with")
        self.arguments = ["run", "--resume", self.out, "--no-eval", "--quiet"]

    @staticmethod
    def results(out):
        names = ("trajectory.txt", "map.ply", "keyframes.txt")
        return {name: (out / name).read_bytes() for name in names}

    def prepare(self):
        subprocess.run(["rm", "-rf", self.out], check=True)
        subprocess.run(["cp", "-r", self.stopped, self.out], check=True)

    def verify(self, code, said):
        if 'state = "finished"' not in (self.out / "state.toml").read_text():
            check(code != 0, f"exit code 0, and yet not finished\n{said}")
            code, said, _ = self.sgs(*self.arguments)
            check(code in (0, 3), f"it cannot be gone on with any more: exit code {code}\n{said}")
        check(self.results(self.out) == self.whole, "other bits than those of a whole run")


class Refine:
    """Learning a map on: the run is untouched, and the best map is somewhere."""

    start = "lock.txt"

    def __init__(self, sgs, recording, source, out):
        self.sgs, self.source, self.out = sgs, source, out
        code, said, _ = sgs("run", recording, "-o", source, "--max-width", 160, "--no-eval")
        check(code in (0, 3), said)
        self.arguments = ["refine", source, "-o", out, "--steps", 20, "--no-eval", "--quiet"]
        self.before = self.results()

    def results(self):
        return {path: path.read_bytes() for path in sorted(self.source.iterdir()) if path.is_file()}

    def prepare(self):
        subprocess.run(["rm", "-rf", self.out], check=True)

    def verify(self, code, said):
        check(self.results() == self.before, "the run that was refined has changed")
        state = self.out / "state.toml"
        ended = state.exists() and "frames = 0" not in state.read_text()
        if code == 0 or (ended and 'state = "running"' not in state.read_text()):
            for name in ("map.ply", "trajectory.txt", "frames.csv"):
                check(there(name, places(self.out, said)), f"{name} is nowhere\n{said}")


def try_point(scenario, kind, number, stays):
    scenario.prepare()
    code, said, _ = scenario.sgs(
        *scenario.arguments, fault=f"{kind}:{number}", stays=stays, start=scenario.start
    )
    check(code in (0, 1, 3), f"exit code {code}\n{said}")
    check(code != 1 or said.strip(), "failed without a word")
    scenario.verify(code, said)
    code, said, _ = scenario.sgs("export", scenario.out, "tum", scenario.sgs.scratch / "left.tum")
    check(code in (0, 1), f"what is left cannot be read: exit code {code}\n{said}")


def main():
    executable, library = (str(pathlib.Path(p).resolve()) for p in sys.argv[1:3])
    most = int(sys.argv[3]) if len(sys.argv) > 3 else 20
    kinds = sys.argv[4:] or KINDS
    failed = 0
    with tempfile.TemporaryDirectory(prefix="sgs-inject-") as folder:
        scratch = pathlib.Path(folder)
        (scratch / "tmp").mkdir()
        sgs = Sgs(executable, library, scratch)
        recording = scratch / "recording"
        sgs("synth", "room_desk", recording, "--frames", FRAMES, "--quiet")
        for scenario in (
            Run(sgs, recording, scratch / "out"),
            Eval(sgs, recording, scratch / "old"),
            Resume(sgs, recording, scratch),
            Refine(sgs, recording, scratch / "source", scratch / "refined"),
        ):
            name = type(scenario).__name__.lower()
            for kind in kinds:
                scenario.prepare()
                calls = sgs(*scenario.arguments, fault=f"{kind}:0", start=scenario.start)[2]
                points = min(most, calls)
                numbers = sorted({1 + i * (calls - 1) // max(1, points - 1) for i in range(points)})
                for stays in (False, True) if kind not in ("memory", "read") else (False,):
                    bad = 0
                    for number in numbers:
                        try:
                            try_point(scenario, kind, number, stays)
                        except Failure as failure:
                            bad += 1
                            print(
                                f"FAILED: {name}, {kind}:{number}{' for good' * stays}: {failure}"
                            )
                    failed += bad
                    print(
                        f"{name}: {kind}{' for good' * stays}: {len(numbers)} of {calls} points, "
                        f"{bad} failed",
                        flush=True,
                    )
                    for rest in (scratch / "tmp").iterdir():
                        subprocess.run(["rm", "-rf", rest], check=True)
    return failed


if __name__ == "__main__":
    sys.exit(1 if main() else 0)
