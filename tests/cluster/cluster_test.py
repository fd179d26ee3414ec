#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""A suite made by many workers is the suite made by one. Usage: cluster_test.py SGS [TEST...]"""

import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest

SGS = ""
SUITE = """
[[sequence]]
name = "desk"
scene = "room_desk"
[[sequence]]
name = "fold"
scene = "fold"
"""
RUNS = 4


class Cluster(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory()
        self.addCleanup(self.place.cleanup)
        self.folder = pathlib.Path(self.place.name)
        (self.folder / "mine.toml").write_text(SUITE)

    def command(self, output, *more, frames=8):
        return [
            SGS,
            *f"bench mine.toml --variants gicp --levels clean --seeds 1,2 --frames {frames}".split(),
            *("-o", output, *map(str, more)),
        ]

    def bench(self, output, *more, code=0):
        done = subprocess.run(
            self.command(output, *more),
            cwd=self.folder,
            capture_output=True,
            text=True,
            timeout=600,
        )
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def start(self, output, *more, frames=8):
        return subprocess.Popen(
            self.command(output, *more, frames=frames),
            cwd=self.folder,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def finish(self, process):
        shown, said = process.communicate(timeout=600)
        self.assertEqual(process.returncode, 0, said)
        return shown

    def assert_each_run_once(self, output):
        self.assertEqual(len(list((self.folder / output).glob("*/metrics.json"))), RUNS)
        self.assertEqual(list((self.folder / output / "running").iterdir()), [])

    def states(self, output):
        claims = sorted((self.folder / output / "claims").iterdir())
        return [(c.name, re.search(r"state (\w+)", c.read_text())[1]) for c in claims]

    def test_shards_lists_and_killed_workers_give_the_same_table(self):
        table = self.bench("alone").stdout
        self.assertRegex(table, r"(?m)^clean gicp( +\d+\.\d\d \(\d+\.\d\d\)( \d+%)?){2}$")

        shards = [self.start("shards", "--shard", f"{i}/3") for i in range(3)]
        for shard in shards:
            self.assertEqual(self.finish(shard), "")
        self.assertEqual(self.bench("shards", "--collect").stdout, table)
        self.assert_each_run_once("shards")

        lines = self.bench("listed", "--list").stdout.splitlines()
        self.assertEqual(len(lines), RUNS)
        one = self.bench("listed", "--collect", code=1)
        self.assertIn(f"{RUNS} of {RUNS} runs are not done", one.stderr)
        for line in lines:
            subprocess.run(line, shell=True, cwd=self.folder, check=True, stderr=subprocess.DEVNULL)
        self.assertEqual(self.bench("listed", "--collect").stdout, table)

        killed = self.start("claims")
        running = self.folder / "claims" / "running"
        while not list(running.glob("*/log.txt")) and killed.poll() is None:
            time.sleep(0.01)
        os.kill(killed.pid, signal.SIGKILL)
        killed.communicate()
        self.assertEqual(len(list(running.iterdir())), 1)
        others = [self.start("claims"), self.start("claims")]
        for other in others:
            self.assertEqual(self.finish(other), table)
        self.assert_each_run_once("claims")
        taken_over = [name for name, _ in self.states("claims") if name.endswith(".1")]
        self.assertEqual(len(taken_over), 1, self.states("claims"))

    def test_two_workers_on_one_run(self):
        one = ("--filter", "^fold-.*-1$")
        first, second = self.start("one", *one), self.start("one", *one)
        self.assertEqual(self.finish(first), self.finish(second))
        self.assertEqual(self.states("one"), [("fold-clean-gicp-1.0", "done")])

    # A worker that is stopped for longer than its lease is taken for dead; when it comes back it
    # finds that its run is another's and leaves everything alone.
    def test_a_worker_that_sleeps_too_long_loses_its_run(self):
        one = ("--filter", "^fold-.*-1$", "--lease", 1)
        sleeper = self.start("slept", *one, frames=200)
        while not list(self.folder.glob("slept/running/*/log.txt")) and sleeper.poll() is None:
            time.sleep(0.01)
        os.kill(sleeper.pid, signal.SIGSTOP)
        table = self.finish(self.start("slept", *one, frames=200))
        made = (self.folder / "slept" / "fold-clean-gicp-1" / "metrics.json").stat().st_mtime_ns
        os.kill(sleeper.pid, signal.SIGCONT)
        sleeper.communicate(timeout=600)
        after = (self.folder / "slept" / "fold-clean-gicp-1" / "metrics.json").stat().st_mtime_ns
        self.assertEqual(made, after)
        self.assertIn("fold", table)
        self.assertEqual(list((self.folder / "slept" / "running").iterdir()), [])

    def test_full_disk_in_the_middle_of_a_claim(self):
        (self.folder / "full").mkdir()
        command = " ".join(f"'{word}'" for word in self.command("full", "--filter", "^fold-.*-1$"))
        script = (
            "mount -t tmpfs -o size=64k none full || exit 77; cat /dev/zero >full/filler; "
            f"{command}; echo code $?; echo claims: $(ls full/claims); rm full/filler; "
            f"{command}; echo code $?; mount -o remount,size=200m full; {command}; echo code $?"
        )
        as_root = [] if os.geteuid() == 0 else ["--map-root-user"]
        done = subprocess.run(
            ["unshare", *as_root, "--mount", "bash", "-c", script],
            capture_output=True,
            text=True,
            cwd=self.folder,
            timeout=600,
        )
        if done.returncode == 77 or "unshare" in done.stderr:
            self.skipTest("mounting in a private name space is not allowed here")
        self.assertRegex(done.stderr, r"cannot write .*claims/fold-clean-gicp-1.0: No space left")
        # No room for the claim, then none for the run, then enough.
        self.assertEqual(re.findall(r"code (\d+)", done.stdout), ["1", "1", "0"], done.stderr)
        self.assertIn("claims:\n", done.stdout)
        self.assertRegex(done.stdout, r"(?m)^clean gicp +\d+\.\d\d")

    def test_what_cannot_be(self):
        for shard in ("3/3", "-1/2", "1", "a/b", "0/0", "1/2/3"):
            self.assertIn("--shard", self.bench("x", f"--shard={shard}", code=2).stderr)
        both = self.bench("x", "--list", "--shard", "0/2", code=2)
        self.assertIn("exclude each other", both.stderr)
        self.assertIn("no run matches", self.bench("x", "--list", "--filter", "^$", code=2).stderr)
        (self.folder / "file").write_text("")
        self.bench("file", code=1)


if __name__ == "__main__":
    SGS = str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main(verbosity=2)
