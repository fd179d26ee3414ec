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

    def assert_in_world_of_first(self, run, least):
        # The world of the map is the first camera of its run.
        truth = poses(self.room / "groundtruth.txt")
        origin = truth[min(truth)]
        inverse = [-origin[3], -origin[4], -origin[5], origin[6]]
        found = poses(run / "trajectory.txt")
        self.assertGreaterEqual(len(found), least)
        for time, pose in found.items():
            at = truth[min(truth, key=lambda t: abs(t - time))]
            expected = turned(inverse, [at[i] - origin[i] for i in range(3)])
            self.assertLess(math.dist(pose[:3], expected), 0.03, time)

    def info(self, path):
        return json.loads(self.sgs("info", path, "--json").stdout)

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
        self.assert_in_world_of_first(visit, FRAMES - 60 - 5)

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

    def test_a_run_goes_on_with_a_map_and_another_with_that(self):
        before = self.map.read_bytes()
        second, third = self.folder / "second", self.folder / "third"
        self.sgs("run", self.room, "--frames", "60:", "--continue", self.map, "-o", second, *SMALL)
        self.assertEqual(self.map.read_bytes(), before)
        self.assert_in_world_of_first(second, FRAMES - 60 - 5)
        told, first = self.info(second / "map.sgsmap"), self.info(self.map)
        self.assertEqual([s["frames"] for s in told["sessions"]], [60, FRAMES - 60])
        self.assertGreater(told["views"], first["views"])
        self.assertEqual(told["sessions"][0]["views"], first["views"])
        self.assertGreater(told["sessions"][0]["gaussians"], 0.8 * first["gaussians"])
        self.assertGreater(told["sessions"][1]["views"], 0)
        first_of_second = sorted(poses(self.room / "groundtruth.txt"))[60]
        for place in told["places"]:
            is_second = place["time_s"] > first_of_second - 1e-3
            self.assertEqual(place["session"], int(is_second), place)
        # The same views stand where they stood, but for what loops have moved.
        for a, b in zip(first["places"], told["places"]):
            self.assertLess(math.dist(a["pose"][:3], b["pose"][:3]), 0.02)
        # Frames that the map has, and earlier ones: clocks of sessions have nothing to do with it.
        self.sgs("run", self.room, "--frames", "20:50", "--continue", second, "-o", third, *SMALL)
        told = self.info(third / "map.sgsmap")
        self.assertEqual([s["frames"] for s in told["sessions"]], [60, FRAMES - 60, 30])
        self.assert_in_world_of_first(third, 25)
        self.assertIn("session 2", self.sgs("info", third / "map.sgsmap").stdout)

    def test_a_run_that_goes_on_is_the_same_for_any_number_of_threads(self):
        maps = []
        for threads in (1, 3):
            out = self.folder / f"threads-{threads}"
            arguments = [*SMALL]
            arguments[arguments.index("--threads") + 1] = threads
            self.sgs(
                "run", self.room, "--frames", "60:80", "--continue", self.map, "-o", out, *arguments
            )
            maps.append((out / "map.sgsmap").read_bytes())
        self.assertEqual(maps[0], maps[1])

    def test_nothing_is_added_to_a_map_of_another_room(self):
        before = self.map.read_bytes()
        out = self.folder / "added"
        office = ("synth:office:kinect", "--frames", "0:20")
        done = self.sgs("run", *office, "--continue", self.map, "-o", out, *SMALL, code=3)
        self.assertRegex(done.stderr, r"not found itself in .*best candidate \d+ of 25")
        self.assertEqual(self.map.read_bytes(), before)
        self.assertFalse((out / "map.sgsmap").exists())

    def test_what_cannot_go_on_with_a_map_is_refused(self):
        out = self.folder / "refused"
        for arguments, code, said in (
            (("--localize", self.map), 2, "--localize"),
            (("--resume", self.first), 2, "--resume"),
            (("--tracker", "given"), None, "tracker"),
            (("--preset", "paper"), None, "cannot find itself"),
            (("--set", "loops.enabled=false"), None, "loops"),
            (("--preset", "quality"), None, "refine"),
        ):
            with self.subTest(arguments):
                command = ("run", self.room, "--continue", self.map, "-o", out, "--quiet")
                done = subprocess.run(
                    [str(SGS), *map(str, (*command, *arguments))],
                    capture_output=True,
                    text=True,
                    cwd=self.folder,
                )
                self.assertIn(done.returncode, (1, 2) if code is None else (code,), done.stderr)
                self.assertIn(said, done.stderr)
                self.assertFalse((out / "map.sgsmap").exists())
        done = self.sgs("run", self.room, "--continue", self.map, "-o", self.first, code=2)
        self.assertIn("would replace", done.stderr)

    def test_a_full_disk_costs_the_new_map_only(self):
        before = self.map.read_bytes()
        out = self.folder / "full"
        # A limit of file sizes fails large writes as a full disk does.
        command = " ".join(
            f"'{a}'" for a in (SGS, "run", self.room, "--frames", "60:70", "--continue", self.map)
        )
        small = " ".join(map(str, SMALL))
        done = subprocess.run(
            ["bash", "-c", f"ulimit -f 64; exec {command} -o '{out}' {small}"],
            capture_output=True,
            text=True,
            cwd=self.folder,
        )
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("map.sgsmap", done.stderr)
        self.assertFalse((out / "map.sgsmap").exists())
        self.assertEqual(self.map.read_bytes(), before)

    def test_maps_of_two_runs_are_joined_and_lived_in(self):
        second, joined = self.folder / "half", self.folder / "joined.sgsmap"
        self.sgs("run", self.room, "--frames", "40:", "-o", second, *SMALL)
        before = [(f / "map.sgsmap").read_bytes() for f in (self.first, second)]
        merge = ("merge", self.first, second, "-o", joined, "--threads")
        self.assertIn(str(joined), self.sgs(*merge, 1).stdout)
        self.assertEqual([(f / "map.sgsmap").read_bytes() for f in (self.first, second)], before)
        told = self.info(joined)
        self.assertEqual([s["frames"] for s in told["sessions"]], [60, FRAMES - 40])
        views = [self.info(f / "map.sgsmap")["views"] for f in (self.first, second)]
        self.assertEqual([s["views"] for s in told["sessions"]], views)
        # All views lie in the world of the first one.
        truth = poses(self.room / "groundtruth.txt")
        origin = truth[min(truth)]
        for place in told["places"]:
            at = truth[min(truth, key=lambda t: abs(t - place["time_s"]))]
            inverse = [-origin[3], -origin[4], -origin[5], origin[6]]
            expected = turned(inverse, [at[i] - origin[i] for i in range(3)])
            self.assertLess(math.dist(place["pose"][:3], expected), 0.03, place)
        again = joined.read_bytes()
        self.sgs(*merge, 3)
        self.assertEqual(joined.read_bytes(), again)
        visit, further = self.folder / "visit-joined", self.folder / "further"
        self.sgs("run", self.room, "--frames", "60:80", "--localize", joined, "-o", visit, *SMALL)
        self.assert_in_world_of_first(visit, 15)
        self.sgs("run", self.room, "--frames", "20:50", "--continue", joined, "-o", further, *SMALL)
        self.assert_in_world_of_first(further, 25)
        self.assertEqual(len(self.info(further / "map.sgsmap")["sessions"]), 3)

    def test_a_map_file_is_exported_without_its_recording(self):
        for form in ("ply", "splat", "spz", "glb", "points", "html"):
            target = self.folder / f"alone.{form}"
            self.sgs("export", self.map, form, target)
            self.assertTrue(target.stat().st_size > 100, form)
        grid = self.folder / "alone"
        self.sgs("export", self.map, "grid", grid, "--up", "0,-1,0", "--camera-height", "1.2")
        self.assertIn("occupied_thresh", (grid / "map.yaml").read_text())
        for form, target in (("mesh", "alone.mesh"), ("tum", "alone.txt"), ("colmap", "alone")):
            failed = self.sgs("export", self.map, form, self.folder / target, code=2)
            self.assertIn("first/map.sgsmap", failed.stderr, form)
            self.assertIn("run folder", failed.stderr, form)

    def test_what_cannot_be_joined_is_not_written(self):
        out = self.folder / "not.sgsmap"
        office = self.folder / "office"
        self.sgs("run", "synth:office:kinect", "--frames", "0:20", "-o", office, *SMALL)
        done = self.sgs("merge", self.first, office, "-o", out, code=3)
        self.assertRegex(done.stderr, r"not joined: .*office in .*: at most \d views agree")
        copy = self.folder / "copy.sgsmap"
        shutil.copy(self.map, copy)
        for maps, output, code, said in (
            ((self.first, copy), out, 2, "both hold the session"),
            ((self.first, office), office / "map.sgsmap", 2, "only read"),
            ((self.first, office), self.folder, 2, "is a folder"),
            ((self.first, self.room), out, 1, "has no map.sgsmap"),
            ((self.first, self.room / "groundtruth.txt"), out, 1, "no map"),
        ):
            with self.subTest(said):
                self.assertIn(said, self.sgs("merge", *maps, "-o", output, code=code).stderr)
        self.sgs("merge", self.first, "-o", out, code=2)
        self.assertFalse(out.exists())

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
