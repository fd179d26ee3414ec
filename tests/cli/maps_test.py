#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Maps that live on: what a run leaves, how a camera finds itself in it, and what is refused.

maps_test.py SGS
"""
import json
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

SGS = None
FRAMES = 90
SMALL = ("--max-width", 320, "--threads", 1, "--no-eval", "--quiet")


def poses(path):
    rows = [line.split() for line in path.read_text().splitlines() if line[0] != "#"]
    return {round(float(row[0]), 4): [float(field) for field in row[1:]] for row in rows}


def turned(q, v):
    """v turned by the quaternion x y z w."""
    x, y, z, w = q
    t = [2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])]
    return [
        v[0] + w * t[0] + y * t[2] - z * t[1],
        v[1] + w * t[1] + z * t[0] - x * t[2],
        v[2] + w * t[2] + x * t[1] - y * t[0],
    ]


class Maps(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="sgs-maps-"))
        cls.room = cls.folder / "room"
        cls.sgs("synth", "room_desk:kinect", cls.room, "--frames", FRAMES, "--quiet")
        cls.first = cls.folder / "first"
        cls.sgs("run", cls.room, "--frames", "0:60", "-o", cls.first, *SMALL)
        cls.map = cls.first / "map.sgsmap"

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder, ignore_errors=True)

    @classmethod
    def sgs(cls, *arguments, code=0):
        done = subprocess.run(
            [str(SGS), *map(str, arguments)], capture_output=True, text=True, cwd=cls.folder
        )
        assert done.returncode == code, f"{arguments}\n{done.stdout}\n{done.stderr}"
        return done

    def test_a_run_leaves_a_map_that_tells_of_itself(self):
        told = json.loads(self.sgs("info", self.map, "--json").stdout)
        self.assertEqual(told["bytes"], self.map.stat().st_size)
        self.assertGreater(told["gaussians"], 1000)
        self.assertGreater(told["views"], 1)
        self.assertEqual(told["sessions"][0]["frames"], 60)
        self.assertIn("cubes of 4 m", self.sgs("info", self.map).stdout)

    def test_a_camera_finds_itself_and_leaves_the_map_as_it_is(self):
        before = self.map.read_bytes()
        visit = self.folder / "visit"
        self.sgs("run", self.room, "--frames", "60:", "--localize", self.first, "-o", visit, *SMALL)
        self.assertEqual(self.map.read_bytes(), before)
        self.assertFalse((visit / "map.sgsmap").exists())
        self.assertIn(str(self.first), (visit / "config.toml").read_text())
        # The world of the map is the first camera of its run.
        truth = poses(self.room / "groundtruth.txt")
        origin = truth[min(truth)]
        inverse = [-origin[3], -origin[4], -origin[5], origin[6]]
        found = poses(visit / "trajectory.txt")
        self.assertGreaterEqual(len(found), FRAMES - 60 - 5)
        for time, pose in found.items():
            at = truth[min(truth, key=lambda t: abs(t - time))]
            expected = turned(inverse, [at[i] - origin[i] for i in range(3)])
            self.assertLess(math.dist(pose[:3], expected), 0.03, time)

    def test_another_room_is_never_taken_for_this_one(self):
        out = self.folder / "elsewhere"
        done = self.sgs(
            "run",
            "synth:office:kinect",
            "--frames",
            "0:20",
            "--localize",
            self.map,
            "-o",
            out,
            *SMALL,
            code=3,
        )
        self.assertRegex(done.stderr, r"not found itself in .*best candidate \d+ of 25")
        lines = (out / "frames.csv").read_text().splitlines()
        self.assertEqual(len(lines), 21)
        self.assertTrue(all("not_in_map" in line for line in lines[1:]))
        self.assertEqual(poses(out / "trajectory.txt"), {})

    def test_what_is_no_map_is_refused_before_anything_is_made(self):
        whole = self.map.read_bytes()
        flipped = bytearray(whole)
        flipped[len(whole) // 2] ^= 1
        later = bytearray(whole)
        later[8] = 77
        for name, content, said in (
            ("cut.sgsmap", whole[: len(whole) // 3], "cut off"),
            ("flipped.sgsmap", bytes(flipped), "damaged"),
            ("later.sgsmap", bytes(later), "format 77"),
            ("text.sgsmap", b"# no map\n" * 9, "no map"),
        ):
            with self.subTest(name):
                path, out = self.folder / name, self.folder / f"{name}.run"
                path.write_bytes(content)
                for command in (
                    ("run", self.room, "--localize", path, "-o", out, "--quiet"),
                    ("info", path),
                ):
                    error = self.sgs(*command, code=1).stderr
                    self.assertIn(name, error)
                    self.assertIn(said, error)
                self.assertFalse(out.exists())
        self.sgs("run", self.room, "--localize", self.folder / "none", "--quiet", code=1)

    def test_a_run_does_not_take_away_the_map_that_it_looks_for_itself_in(self):
        for given in (self.first, self.map):
            arguments = ("run", self.room, "--localize", given, "-o", self.first, *SMALL)
            self.assertIn("would replace", self.sgs(*arguments, code=2).stderr)
        self.assertTrue(self.map.exists())


if __name__ == "__main__":
    SGS = pathlib.Path(sys.argv.pop(1)).resolve()
    unittest.main(verbosity=2)
