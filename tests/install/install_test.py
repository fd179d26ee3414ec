# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Installs the build to a folder, builds examples/ against it by find_package, and runs them.

Usage: install_test.py CMAKE BUILD_FOLDER CXX_COMPILER [unittest arguments]
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

CMAKE, BUILD, COMPILER = (sys.argv.pop(1) for _ in range(3))
EXAMPLES = pathlib.Path(__file__).resolve().parent.parent.parent / "examples"
FRAMES = 8


def run(*command):
    done = subprocess.run(
        [str(word) for word in command],
        capture_output=True,
        text=True,
        timeout=600,
        env={**os.environ, "CXX": COMPILER},
    )
    if done.returncode != 0:
        raise AssertionError(
            f"{command[0]} {command[1]}: exit {done.returncode}\n"
            f"{done.stdout[-4000:]}{done.stderr[-4000:]}"
        )
    return done.stdout


def positions(text):
    """Time -> position of a TUM trajectory."""
    rows = [line.split() for line in text.splitlines() if line and not line.startswith("#")]
    return {row[0]: [float(value) for value in row[1:4]] for row in rows}


class Examples(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.keeper = tempfile.TemporaryDirectory(prefix="sgs-install-")
        cls.folder = pathlib.Path(cls.keeper.name)
        cls.prefix, cls.build = cls.folder / "prefix", cls.folder / "build"
        run(CMAKE, "--install", BUILD, "--prefix", cls.prefix)
        run(
            CMAKE,
            "-G",
            "Ninja",
            "-S",
            EXAMPLES,
            "-B",
            cls.build,
            f"-DCMAKE_PREFIX_PATH={cls.prefix}",
        )
        run(CMAKE, "--build", cls.build, "--parallel", "2")
        cls.sequence = cls.folder / "room"
        run(
            cls.prefix / "bin" / "sgs",
            "synth",
            "room_desk",
            cls.sequence,
            "--frames",
            FRAMES,
            "--quiet",
        )

    @classmethod
    def tearDownClass(cls):
        cls.keeper.cleanup()

    def check_saved(self, folder):
        self.assertGreater((folder / "map.ply").stat().st_size, 10000)
        poses = positions((folder / "trajectory.txt").read_text())
        self.assertEqual(len(poses), FRAMES)
        return poses

    def test_feed_frames_prints_what_it_saves(self):
        out = self.folder / "fed"
        printed = positions(run(self.build / "feed_frames", self.sequence, out))
        self.assertEqual(printed, self.check_saved(out))

    def test_own_tracker_maps_with_the_poses_it_is_given(self):
        truth_file, out = self.sequence / "groundtruth.txt", self.folder / "own"
        printed = run(self.build / "own_tracker", self.sequence, truth_file, out)
        self.assertRegex(printed, r"^[1-9][0-9]+ Gaussians\n$")
        truth = positions(truth_file.read_text())
        nearest = lambda time: min(truth, key=lambda t: abs(float(t) - float(time)))
        for time, position in self.check_saved(out).items():
            for mine, true in zip(position, truth[nearest(time)]):
                self.assertAlmostEqual(mine, true, delta=0.05)

    def test_a_sequence_that_is_missing_is_an_error_with_a_reason(self):
        done = subprocess.run(
            [self.build / "feed_frames", self.folder / "none", self.folder / "x"],
            capture_output=True,
            text=True,
            timeout=60,
        )
        self.assertEqual(done.returncode, 1)
        self.assertIn("none", done.stderr)


if __name__ == "__main__":
    unittest.main()
