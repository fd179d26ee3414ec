# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Poses that are known already (--tracker given): of single views and of videos.

Usage: given_test.py SGS_EXECUTABLE [unittest arguments]
"""
import dataclasses
import json
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import foreign_writers as foreign
from rendered import render

SGS = pathlib.Path(sys.argv.pop(1)).resolve()
FRAMES = 150
EVERY = 15  # two views a second
GIVEN = ("--tracker", "given")


def write_colmap(recording, path, name):
    """World to camera, w first; every second row is empty, as of pictures without points."""
    text = "# Image list with two lines of data per image:\n"
    for i, pose in enumerate(recording.poses):
        T = np.linalg.inv(pose)
        x, y, z, w = foreign.quaternion(T[:3, :3])
        numbers = [w, x, y, z, *T[:3, 3]]
        text += f"{i + 1} " + " ".join(repr(float(v)) for v in numbers) + f" 1 {name(i)}\n\n"
    foreign.put(path, text)


class Given(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.shared = pathlib.Path(tempfile.mkdtemp(prefix="sgs-given-"))
        cls.full = render(SGS, cls.shared / "master", FRAMES)
        cls.sparse = dataclasses.replace(
            cls.full,
            **{
                key: getattr(cls.full, key)[::EVERY] for key in ("times", "color", "depth", "poses")
            },
        )
        foreign.write_tum(cls.full, cls.shared / "full")
        foreign.write_tum(cls.sparse, cls.shared / "sparse")

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.shared, ignore_errors=True)

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="case-", dir=self.shared))

    def run_sgs(self, what, *options, code=0):
        out = self.folder / "run"
        foreign.remove(out)
        done = subprocess.run(
            [SGS, "run", what, "-o", out, *map(str, options)],
            capture_output=True,
            text=True,
            cwd=self.folder,
            timeout=600,
        )
        self.assertEqual(done.returncode, code, done.stderr)
        return out, done.stderr

    def metrics(self, run):
        return json.loads((run / "metrics.json").read_text())

    def assert_poses(self, run, recording):
        """The poses of the run are those of the recording, up to what text rounds."""
        rows = np.loadtxt(run / "trajectory.txt", ndmin=2)
        np.testing.assert_allclose(
            rows[:, 1:4], np.array([T[:3, 3] for T in recording.poses]), atol=1e-5
        )

    def test_single_views_become_as_good_a_map_as_the_video(self):
        slam, _ = self.run_sgs(self.shared / "full", "--quiet")
        video = self.metrics(slam)
        order = list(range(len(self.sparse.times)))
        random.Random(1).shuffle(order)
        folder = self.folder / "capture"
        foreign.write_transforms(
            self.sparse, folder, names=[f"IMG_{n:04}" for n in order], times=False, order=order
        )
        run, _ = self.run_sgs(folder, *GIVEN, "--quiet")
        views = self.metrics(run)
        self.assertGreaterEqual(views["psnr_db_full"], video["psnr_db_full"] - 1.5)
        self.assertEqual(views["frames_lost"], 0)
        self.assertLess(views["ate_rmse_m"], 1e-6)
        # Not the steps of ten frames, but of the video that they stand for.
        self.assertGreater(views["mapping_iterations"], video["mapping_iterations"] / 2)

    def test_formats_that_carry_poses(self):
        for write, file in (
            (foreign.write_polycam, None),
            (foreign.write_sens, "scene.sens"),
            (foreign.write_open3d, None),
            (foreign.write_tum, None),
        ):
            with self.subTest(write.__name__):
                folder = self.folder / write.__name__
                what = folder / file if file else folder
                folder.mkdir()
                write(self.sparse, what)
                run, _ = self.run_sgs(what, *GIVEN, "--no-eval", "--quiet")
                self.assert_poses(run, self.sparse)

    def test_files_of_poses(self):
        bare = self.folder / "bare"
        foreign.write_tum(self.sparse, bare)
        (bare / "groundtruth.txt").rename(self.folder / "poses.txt")
        run, _ = self.run_sgs(
            bare, *GIVEN, "--poses", self.folder / "poses.txt", "--no-eval", "--quiet"
        )
        self.assert_poses(run, self.sparse)
        write_colmap(self.sparse, self.folder / "model/images.txt", lambda i: f"{i}.jpg")
        run, _ = self.run_sgs(
            bare, *GIVEN, "--poses", self.folder / "model", "--quiet", "--no-eval"
        )
        self.assert_poses(run, self.sparse)
        _, said = self.run_sgs(bare, *GIVEN, code=1)
        self.assertIn("no poses of its own", said)
        self.assertIn("--poses takes TUM rows", said)
        _, said = self.run_sgs(bare, *GIVEN, "--poses", "none.txt", code=1)
        self.assertIn("none.txt", said)
        _, said = self.run_sgs(bare, "--poses", self.folder / "poses.txt", code=2)
        self.assertIn("--tracker given", said)

    def test_frames_without_a_pose_are_skipped_with_a_count(self):
        poses = self.folder / "poses.txt"
        rows = (self.shared / "sparse/groundtruth.txt").read_text().splitlines()
        poses.write_text("\n".join(rows[2:7]) + "\n")
        run, said = self.run_sgs(self.shared / "sparse", *GIVEN, "--poses", poses, "--no-eval")
        self.assertIn(f"no pose for {len(rows) - 5} of the {len(rows)} frames", said)
        self.assertEqual(len(np.loadtxt(run / "trajectory.txt")), 5)
        self.assertEqual((run / "frames.csv").read_text().count(",bad"), len(rows) - 5)

    def test_poses_may_be_refined(self):
        """Of single views whose poses are off by a centimetre."""
        noise = np.random.default_rng(1)
        wrong = dataclasses.replace(self.sparse, poses=[T.copy() for T in self.sparse.poses])
        for T in wrong.poses:
            T[:3, 3] += noise.normal(0, 0.006, 3)
        foreign.write_tum(wrong, self.folder / "wrong")
        poses = self.folder / "wrong/groundtruth.txt"
        error = {}
        for refine in "false", "true":
            run, _ = self.run_sgs(
                self.shared / "sparse",
                *(*GIVEN, "--poses", poses, "--no-eval", "--quiet"),
                *("--set", f"tracker.given.refine={refine}"),
                *("--set", "mapper.iterations_per_frame=4"),
            )
            error[refine] = self.metrics(run)["ate_rmse_m"]
        print(error, file=sys.stderr)
        self.assertGreater(error["false"], 0.007)
        self.assertLess(error["true"], 0.8 * error["false"])

    def test_a_tracker_that_gets_single_views_says_what_to_do(self):
        out = self.folder / "run"
        done = subprocess.run(
            [SGS, "run", self.shared / "sparse", "-o", out, "--no-eval"],
            capture_output=True,
            text=True,
            cwd=self.folder,
        )
        self.assertIn("single views, too far apart for a tracker", done.stderr)
        self.assertIn("--tracker given", done.stderr)
        info = subprocess.run(
            [SGS, "info", self.shared / "sparse"], capture_output=True, text=True, check=True
        )
        self.assertIn("--tracker given", info.stdout)


if __name__ == "__main__":
    unittest.main()
