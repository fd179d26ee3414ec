#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Which way is up: accelerometer.txt beside rendered frames, good and bad, and what is made of it.

upright_test.py SGS
"""
import math
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest

SGS = None
FRAMES = 40


def rotation(x, y, z, w):
    return [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]


def poses(path):
    rows = [line.split() for line in path.read_text().splitlines() if line[0] != "#"]
    return [[float(field) for field in row] for row in rows]


def up_in_camera(pose):
    """z of the world in the axes of its camera."""
    return rotation(*pose[4:8])[2]


def angle_deg(a, b):
    return math.degrees(math.acos(max(-1, min(1, sum(x * y for x, y in zip(a, b))))))


class Upright(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="sgs-upright-"))
        cls.master = cls.folder / "master"
        cls.sgs("synth", "room_desk", cls.master, "--frames", FRAMES, "--quiet")
        cls.truth = poses(cls.master / "groundtruth.txt")

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

    def run_with(self, lines):
        """A run of the frames with these lines of an accelerometer beside them."""
        sequence = self.folder / self.id().split(".")[-1]
        shutil.copytree(self.master, sequence)
        if lines is not None:
            (sequence / "accelerometer.txt").write_text("\n".join(lines) + "\n")
        out = sequence.with_suffix(".run")
        self.sgs("run", sequence, "-o", out, "--no-eval", "--quiet")
        return out

    def felt(self, unit=9.81, delay_s=0):
        """What a Kinect's accelerometer (x left, y up, z forward) feels along the truth."""
        lines = ["# timestamp ax ay az"]
        for pose in self.truth:
            x, y, z = up_in_camera(pose)
            lines.append(f"{pose[0] + delay_s:.6f} {-unit * x:.6f} {-unit * y:.6f} {unit * z:.6f}")
        return lines

    def up_of(self, out):
        text = (out / "upright.toml").read_text()
        by = re.search(r'(?m)^by = "(\w+)"$', text)[1]
        return by, [float(re.search(rf"(?m)^{a} = (\S+)$", text)[1]) for a in "xyz"]

    def points(self, path):
        data = path.read_bytes()
        body = data[data.index(b"end_header\n") + 11 :]
        return [struct.unpack_from("<fff", body, i) for i in range(0, len(body) - 14, 15)]

    def check(self, out, within_deg, *expected):
        by, up = self.up_of(out)
        self.assertIn(by, expected)
        # The world of the run is its first camera.
        self.assertLess(angle_deg(up, up_in_camera(self.truth[0])), within_deg)
        self.assertIn(f'"upright": "{by}"', (out / "metrics.json").read_text())
        return (out / "log.txt").read_text()

    def test_accelerometer_puts_the_run_upright_and_moves_nothing(self):
        out = self.run_with(self.felt())
        log = self.check(out, 2, "accelerometer", "accelerometer_and_floor")
        self.assertIn("info upright by the accelerometer", log)
        self.assertNotIn(" warning ", log)
        plain = self.folder / "plain"
        self.sgs("run", self.master, "-o", plain, "--no-eval", "--quiet")
        for name in ("trajectory.txt", "map.ply"):
            self.assertEqual((out / name).read_bytes(), (plain / name).read_bytes(), name)
        self.assertRegex((out / "report.html").read_text(), "upright by the accelerometer")
        shown = self.sgs("info", out.with_suffix("")).stdout
        self.assertRegex(shown, r"(?m)^accelerometer +accelerometer\.txt$")

    def test_exports_are_turned_when_asked(self):
        out = self.run_with(self.felt())
        turned, ply = self.folder / "turned.txt", self.folder / "turned.ply"
        self.sgs("export", out, "--upright", "--tum", turned, "--points", ply)
        for pose, truth in zip(poses(turned), self.truth):
            self.assertLess(angle_deg(up_in_camera(pose), up_in_camera(truth)), 3)
        self.sgs("export", out, "points", "plain.ply")
        _, up = self.up_of(out)
        before, after = self.points(self.folder / "plain.ply"), self.points(ply)
        self.assertEqual(len(before), len(after))
        for p, q in zip(before, after):
            self.assertAlmostEqual(sum(a * b for a, b in zip(up, p)), q[2], places=4)
        self.sgs("export", self.folder / "turned.ply", "--upright", "--ply", "x.ply", code=1)
        (out / "upright.toml").write_text("junk")
        self.assertIn("upright.toml", self.sgs("eval", out).stderr)

    def test_without_one_the_floor_says_it(self):
        self.check(self.run_with(None), 3, "floor")

    def test_bad_input_is_told_and_the_run_goes_on(self):
        for name, lines, within, said in (
            ("g", self.felt(unit=1), 2, "in g, not m/s2"),
            ("upside_down", self.felt(unit=-9.81), 3, "upside down"),
            ("clock", self.felt(delay_s=1000), 3, "on one clock"),
            ("words", ["one two", *self.felt(), "1 2 3"], 2, "accelerometer.txt:1: not 'timestamp"),
            ("nothing", [""], 3, "no line says"),
        ):
            with self.subTest(name):
                sequence = self.folder / name
                shutil.copytree(self.master, sequence)
                (sequence / "accelerometer.txt").write_text("\n".join(lines) + "\n")
                out = self.folder / f"{name}.run"
                self.sgs("run", sequence, "-o", out, "--no-eval", "--quiet")
                log = self.check(out, within, "accelerometer", "accelerometer_and_floor", "floor")
                self.assertRegex(log, r" warn\w* .*accelerometer\.txt")
                self.assertIn(said, log)


if __name__ == "__main__":
    SGS = pathlib.Path(sys.argv.pop(1)).resolve()
    unittest.main(verbosity=2)
