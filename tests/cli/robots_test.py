#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Maps for robots: the pair of map_server, OctoMap's file, and what is said where none can be made.

robots_test.py SGS
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

SGS = None
FREE, OCCUPIED, UNKNOWN = 254, 0, 205


def read_yaml(path):
    """The few forms that map_server's files have."""
    lines = [line for line in path.read_text().splitlines() if line[0] != "#"]
    return dict(line.split(": ", 1) for line in lines)


def read_pgm(path):
    """Width, height and the pixels of a binary PGM."""
    match = re.match(rb"P5\n(?:#[^\n]*\n)*(\d+) (\d+)\n255\n", path.read_bytes())
    return int(match[1]), int(match[2]), path.read_bytes()[match.end() :]


class Robots(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="sgs-robots-"))
        cls.sequence = cls.folder / "sequence"
        cls.sgs("synth", "room_desk", cls.sequence, "--frames", 60, "--quiet")
        cls.run_folder = cls.folder / "run"
        cls.sgs("run", cls.sequence, "-o", cls.run_folder, "--quiet", "--no-eval")

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder, ignore_errors=True)

    @classmethod
    def sgs(cls, *arguments, code=0):
        done = subprocess.run(
            [str(SGS), *map(str, arguments)], capture_output=True, text=True, cwd=cls.folder
        )
        assert done.returncode == code, (arguments, done.returncode, done.stdout, done.stderr)
        return done

    def copy(self, name):
        """The run under another name, to be changed."""
        shutil.copytree(self.run_folder, self.folder / name)
        return self.folder / name

    def check_pair(self, yaml):
        """The fields that map_server and nav2's map_server document, and a picture to match."""
        fields = read_yaml(yaml)
        self.assertEqual(
            list(fields),
            ["image", "mode", "resolution", "origin", "negate", "occupied_thresh", "free_thresh"],
        )
        self.assertEqual((fields["mode"], fields["negate"]), ("trinary", "0"))
        self.assertRegex(fields["origin"], r"^\[-?\d+\.\d+, -?\d+\.\d+, 0\.0\]$")
        width, height, pixels = read_pgm(yaml.parent / fields["image"].strip("'"))
        self.assertEqual(len(pixels), width * height)
        self.assertEqual(set(pixels), {FREE, OCCUPIED, UNKNOWN})
        # What a reader makes of each shade by the thresholds.
        for shade, low, high in ((FREE, 0, 0.196), (UNKNOWN, 0.196, 0.65), (OCCUPIED, 0.65, 1.01)):
            self.assertTrue(low <= (255 - shade) / 255 < high)
        for value in (FREE, OCCUPIED):
            self.assertGreater(pixels.count(value) * float(fields["resolution"]) ** 2, 0.2)
        return fields, width, height

    def test_grid(self):
        self.sgs("export", self.run_folder, "grid", "nav")
        fields, width, height = self.check_pair(self.folder / "nav/map.yaml")
        self.assertEqual(fields["resolution"], "0.05")
        done = self.sgs(
            "export",
            self.run_folder,
            "--grid",
            "fine.yaml",
            "--resolution",
            0.02,
            "--heights",
            "0.2,1",
        )
        self.assertIn("fine.yaml", done.stdout)
        fields, finer, _ = self.check_pair(self.folder / "fine.yaml")
        self.assertEqual((fields["resolution"], fields["image"]), ("0.02", "'fine.pgm'"))
        self.assertGreater(finer, 1.5 * width)
        again = self.folder / "again.yaml"
        self.sgs("export", self.run_folder, "grid", again)
        self.assertEqual(
            again.with_suffix(".pgm").read_bytes(), (self.folder / "nav/map.pgm").read_bytes()
        )

    def test_octomap(self):
        done = subprocess.run(
            [SGS, "export", self.run_folder, "octomap", self.folder / "map.bt"],
            capture_output=True,
            text=True,
        )
        if "has no OctoMap" in done.stderr:
            self.skipTest("built without OctoMap")
        self.assertEqual(done.returncode, 0, done.stderr)
        head = (self.folder / "map.bt").read_bytes()[:400]
        self.assertTrue(head.startswith(b"# Octomap OcTree binary file\n"), head)
        self.assertIn(b"\nid OcTree\n", head)
        self.assertIn(b"\nres 0.05\n", head)

    def test_esdf(self):
        done = subprocess.run(
            [SGS, "export", self.run_folder, "esdf", self.folder / "map.vdb", "--up", "0,-1,0"],
            capture_output=True,
            text=True,
        )
        if "sgs-mesh" in done.stderr:
            self.skipTest("built without OpenVDB")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue((self.folder / "map.vdb").read_bytes().startswith(b" BDV"))

    def test_the_recording_is_gone(self):
        run = self.copy("lonely")
        config = run / "config.toml"
        config.write_text(config.read_text().replace(str(self.sequence), str(self.folder / "gone")))
        failed = self.sgs("export", run, "grid", "no", code=1)
        self.assertIn("--from-map", failed.stderr)
        self.assertFalse((self.folder / "no").exists())
        self.sgs("export", run, "grid", "drawn", "--from-map")
        self.check_pair(self.folder / "drawn/map.yaml")

    def test_nobody_knows_which_way_is_up(self):
        run = self.copy("tumbling")
        upright = run / "upright.toml"
        text = re.sub(r'by = "\w+"', 'by = "camera"', upright.read_text())
        upright.write_text(text)
        failed = self.sgs("export", run, "grid", "no", code=1)
        self.assertIn("no accelerometer", failed.stderr)
        self.assertIn("--up", failed.stderr)
        up = re.search(r"\[up\]\s+x = (\S+)\s+y = (\S+)\s+z = (\S+)", re.sub(r" *#.*", "", text))
        self.sgs("export", run, "grid", "told", "--up", ",".join(up.groups()))
        self.check_pair(self.folder / "told/map.yaml")
        self.sgs("export", run, "grid", "no", "--up", "0,0,0", code=2)
        upright.unlink()
        self.assertIn("--up", self.sgs("export", run, "grid", "no", code=1).stderr)

    def test_bad_options(self):
        for options, word in (
            (["--resolution", 0], "resolution"),
            (["--resolution", -1], "resolution"),
            (["--heights", "1,0.5"], "heights"),
            (["--heights", "1"], "heights"),
            (["--up", "0,1"], "up"),
            (["--range", 0], "range"),
        ):
            failed = self.sgs("export", self.run_folder, "grid", "no", *options, code=2)
            self.assertIn(f"--{word}", failed.stderr)
        self.assertFalse((self.folder / "no").exists())

    def test_where_nothing_can_be_written(self):
        (self.folder / "file").write_text("")
        for form, out in (("grid", "file/map.yaml"), ("glb", "file/a.glb"), ("spz", "file/a.spz")):
            failed = self.sgs("export", self.run_folder, form, out, code=1)
            self.assertIn("file", failed.stderr)

    def test_no_run(self):
        failed = self.sgs("export", self.run_folder / "map.ply", "grid", "no", code=1)
        self.assertIn("map.ply", failed.stderr)


if __name__ == "__main__":
    SGS = pathlib.Path(sys.argv.pop(1)).resolve()
    unittest.main(verbosity=2)
