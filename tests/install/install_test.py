# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Installs the build to a folder, builds examples/ against it by find_package and by pkg-config, and
runs them.

Usage: install_test.py CMAKE BUILD_FOLDER CXX_COMPILER [unittest arguments]
"""
import os
import pathlib
import re
import shutil
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


def build(source, folder, prefix):
    run(CMAKE, "-G", "Ninja", "-S", source, "-B", folder, f"-DCMAKE_PREFIX_PATH={prefix}")
    run(CMAKE, "--build", folder, "--parallel", "2")


class Installed(unittest.TestCase):
    """An installation and a sequence, made once for all tests."""

    @classmethod
    def setUpClass(cls):
        if hasattr(Installed, "prefix"):
            return
        Installed.keeper = tempfile.TemporaryDirectory(prefix="sgs-install-")
        Installed.folder = pathlib.Path(cls.keeper.name)
        Installed.prefix, Installed.sequence = cls.folder / "prefix", cls.folder / "room"
        run(CMAKE, "--install", BUILD, "--prefix", cls.prefix)
        sgs = cls.prefix / "bin" / "sgs"
        run(sgs, "synth", "room_desk", cls.sequence, "--frames", FRAMES, "--quiet")

    @classmethod
    def library(cls):
        (library,) = cls.prefix.rglob("libsgs.so.0")
        return library


class Library(Installed):
    """A program that links libsgs and nothing else."""

    def check_program(self, program):
        """It gives the trajectory of `sgs run`, bit for bit."""
        out, reference = self.folder / program.parent.name, self.folder / "reference"
        environment = {**os.environ, "LD_LIBRARY_PATH": str(self.library().parent)}
        command = [str(program), str(self.sequence), str(out)]
        done = subprocess.run(command, capture_output=True, text=True, timeout=300, env=environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(len(done.stdout.splitlines()), FRAMES)
        run(self.prefix / "bin/sgs", "run", self.sequence, "-o", reference, "--quiet", "--no-eval")
        for file in ("trajectory.txt", "map.ply"):
            self.assertEqual((out / file).read_bytes(), (reference / file).read_bytes(), file)
        command[1] = str(self.folder / "none")
        done = subprocess.run(command, capture_output=True, text=True, timeout=60, env=environment)
        self.assertEqual(done.returncode, 1)
        self.assertIn("none", done.stderr)

    def test_a_project_finds_it_by_cmake(self):
        folder = self.folder / "by-cmake"
        build(EXAMPLES / "consumer", folder, self.prefix)
        self.check_program(folder / "slam")

    def test_a_project_finds_it_by_pkg_config(self):
        if shutil.which("pkg-config") is None:
            self.skipTest("no pkg-config")
        (description,) = self.prefix.rglob("sgs.pc")
        flags = subprocess.run(
            ["pkg-config", "--cflags", "--libs", "sgs"],
            env={**os.environ, "PKG_CONFIG_PATH": str(description.parent)},
            capture_output=True,
            text=True,
            check=True,
        ).stdout.split()
        folder = self.folder / "by-pkg-config"
        folder.mkdir()
        source = EXAMPLES / "consumer" / "slam.cc"
        run(COMPILER, "-std=c++17", "-Wall", "-Werror", source, *flags, "-o", folder / "slam")
        self.check_program(folder / "slam")

    def test_it_shows_its_interface_and_nothing_else(self):
        names = run("nm", "--dynamic", "--demangle", "--defined-only", self.library())
        shown = [line.split(maxsplit=2)[2] for line in names.splitlines()]
        self.assertTrue(any("sgs::api::Session::feed" in name for name in shown))
        kinds = r"((typeinfo|typeinfo name|vtable) for )?sgs::api::(?!internal)|SGS_0$"
        self.assertEqual([name for name in shown if not re.match(kinds, name)], [])
        self.assertIn("[libsgs.so.0]", run("readelf", "--dynamic", self.library()))


class Examples(Installed):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.build = cls.folder / "build"
        build(EXAMPLES, cls.build, cls.prefix)

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
