# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""What tests of recordings as they are found share: a short rendered recording, written as messages
or images, and the program run on it. Takes the executable from the first argument of the command.
"""
import dataclasses
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import foreign_writers as foreign
import ros2_messages as ros2
from rendered import render

SGS = pathlib.Path(sys.argv.pop(1)).resolve()
FRAMES = 24
TRACK_ONLY = ("--set", "mapper.iterations_per_frame=0", "--no-eval", "--quiet")
START_NS = 1_700_000_000 * 10**9
COLOR, DEPTH = "/camera/color", "/camera/aligned_depth_to_color"
FRAME, DEPTH_FRAME = "color_optical", "depth_optical"


def positions(path):
    rows = [line.split() for line in path.read_text().splitlines() if not line.startswith("#")]
    return np.array([[float(v) for v in row] for row in rows])


class Found(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.shared = pathlib.Path(tempfile.mkdtemp(prefix="sgs-found-"))
        cls.r = dataclasses.replace(
            render(SGS, cls.shared / "master", FRAMES),
            times=[round(i / 30, 3) for i in range(FRAMES)],
        )
        cls.k = (cls.r.fx, cls.r.fy, cls.r.cx, cls.r.cy)
        cls.size = (cls.r.width, cls.r.height)
        cls.stamps = [START_NS + round(t * 1000) * 10**6 for t in cls.r.times]
        foreign.write_tum(cls.r, cls.shared / "tum")
        run = cls.shared / "reference"
        command = [SGS, "run", cls.shared / "tum", "-o", run, *TRACK_ONLY]
        subprocess.run(command, check=True, capture_output=True, cwd=cls.shared)
        cls.reference = positions(run / "trajectory.txt")

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.shared, ignore_errors=True)

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="case-", dir=self.shared))

    def sgs(self, *arguments, code=0):
        command = [str(SGS), *map(str, arguments)]
        done = subprocess.run(command, capture_output=True, text=True, cwd=self.folder, timeout=240)
        self.assertEqual(done.returncode, code, f"{arguments}\n{done.stdout}\n{done.stderr}")
        return done

    def info(self, *what):
        return json.loads(self.sgs("info", *what, "--json").stdout)

    def warnings(self, *what):
        return " ".join(self.info(*what)["warnings"])

    def track(self, *what, code=0):
        """The trajectory of a run and what its log says."""
        out = self.folder / "run"
        foreign.remove(out)
        self.sgs("run", *what, "-o", out, *TRACK_ONLY, code=code)
        return positions(out / "trajectory.txt"), (out / "log.txt").read_text()

    def assert_same(self, *what, within=1e-5):
        """A run gives the positions of the plain folder, frame by frame."""
        path, log = self.track(*what)
        self.assertEqual(len(path), FRAMES, log)
        self.assertLess(np.abs(path[:, 1:4] - self.reference[:, 1:4]).max(), within)
        return path, log

    def refused(self, *what, code=None):
        done = subprocess.run(
            [str(SGS), "run", *map(str, what), "-o", str(self.folder / "no"), *TRACK_ONLY],
            capture_output=True,
            text=True,
            cwd=self.folder,
            timeout=240,
        )
        self.assertIn(done.returncode, (1, 2) if code is None else (code,), done.stderr)
        return done.stderr

    def follow(self, text):
        """Runs the command in back quotes that a refusal advises, and gives what to open then."""
        command, then = re.search(
            r"unpack it first: `([^`]+)`, then give (\S+?)\)?$", text.strip()
        ).groups()
        subprocess.run(["bash", "-ec", command], check=True, cwd=self.folder, capture_output=True)
        return then.strip("'")

    # Recordings of messages.

    def pair(self, i, stamp_ns=None, color=None, depth=None, dframe=FRAME, received=None):
        """One frame: colour and depth with their stamps."""
        ns = self.stamps[i] if stamp_ns is None else stamp_ns
        at = ns if received is None else received
        c = self.r.color[i] if color is None else color
        d = self.r.depth[i] if depth is None else depth
        return [
            (COLOR + "/image_raw", ros2.IMAGE, at, ros2.image(c, "rgb8", ns, FRAME)),
            (DEPTH + "/image_raw", ros2.IMAGE, at, ros2.image(d, "16UC1", ns, dframe)),
        ]

    def color_info(self, i, **other):
        k, size = other.pop("k", self.k), other.pop("size", self.size)
        data = ros2.camera_info(k, size, self.stamps[i], FRAME, **other)
        return (COLOR + "/camera_info", ros2.INFO, self.stamps[i], data)

    def bag(self, messages, name="a.db3"):
        return ros2.write_db3(self.folder / name, messages)

    def copy(self, name):
        """The plain folder under another name."""
        folder = self.folder / name
        shutil.copytree(self.shared / "tum", folder)
        return folder

    def rows(self, folder, file):
        """The fields of each row of a list."""
        text = (folder / file).read_text()
        return [line.split() for line in text.splitlines() if line[0] != "#"]

    def listed(self, name, row):
        """The plain folder with rows of one's own: row(i, time, name) gives the text of each."""
        folder = self.copy(name)
        for file in ("rgb.txt", "depth.txt"):
            rows = self.rows(folder, file)
            lines = [row(i, float(t), n) + "\n" for i, (t, n) in enumerate(rows)]
            foreign.put(folder / file, "".join(lines))
        return folder

    def two_folders(self, name, picture, color="rgb", depth="depth"):
        """Pictures in two folders and nothing else; picture(i, time) is their name."""
        folder = self.folder / name
        for i, t in enumerate(self.r.times):
            foreign.put(folder / color / picture(i, t), foreign.png(self.r.color[i]))
            foreign.put(folder / depth / picture(i, t), foreign.png(self.r.depth[i]))
        return folder

    @property
    def camera(self):
        """Options for pictures of which nothing is known."""
        return ("--camera", ",".join(map(str, self.k)), "--depth-scale", "1000")

    def plain(self):
        return [m for i in range(FRAMES) for m in (self.color_info(i), *self.pair(i))]
