# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""What tests of cameras share: a rendered scene as the fakes play it, and the programs that read it.

Command line of all of them: SGS RENDER_RIG FOLDER_OF_FAKES [unittest arguments]
"""
import json
import os
import pathlib
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest

import numpy as np
from skimage.io import imread

SGS, RIG, FAKES = (pathlib.Path(sys.argv.pop(1)).resolve() for _ in range(3))
NO_SDK = FAKES / "fake_other.so"
FRAMES = 12
TIMEOUT = 240
FIRST_S, STEP_S = 1000, 1 / 32
TRACK = ("--set", "mapper.iterations_per_frame=0", "--no-eval")


def rows(path):
    lines = path.read_text().splitlines()
    return [line.split() for line in lines if line and not line.startswith("#")]


class Recorded:
    """One camera's folder of the rig."""

    lens = (0, 0, 0, 0, 0)  # k1 k2 p1 p2 k3

    def __init__(self, folder):
        self.folder = folder
        values = [float(value) for value in rows(folder / "camera.txt")[0]]
        self.fx, self.fy, self.cx, self.cy = values[:4]
        self.width, self.height = int(values[4]), int(values[5])
        read = lambda name: [imread(folder / row[1]) for row in rows(folder / name)]
        self.colors, self.depths = read("rgb.txt"), read("depth.txt")
        self.times = [float(row[0]) for row in rows(folder / "rgb.txt")]

    def written(self):
        """A camera as the fake reads it: size, focal lengths, centre, lens model, coefficients."""
        numbers = (self.width, self.height, self.fx, self.fy, self.cx, self.cy, 2, *self.lens)
        return " ".join(f"{number}" for number in numbers) + "\n"

    def json(self):
        keys = ("width", "height", "fx", "fy", "cx", "cy")
        return {key: getattr(self, key) for key in keys}


def write_scene(path, color, depth, T_color_depth=((1, 0, 0, 0, 1, 0, 0, 0, 1), (0, 0, 0))):
    with open(path, "wb") as file:
        numbers = " ".join(f"{value:.9g}" for part in T_color_depth for value in part)
        head = f"{color.written()}{depth.written()}{numbers}\n0.001 {len(color.times)}\n"
        file.write(head.encode())
        for t, image, raw in zip(color.times, color.colors, depth.depths):
            file.write(struct.pack("<d", t * 1000) + image.tobytes() + raw.astype("<u2").tobytes())


def parts_of(stream):
    """What a program has sent, as docs/stream.md describes it: greeting, frames, samples."""
    assert stream[:4] == b"SGS2", stream[:20]
    at, frames, samples = 4, [], []

    def text():
        nonlocal at
        (length,) = struct.unpack_from("<I", stream, at)
        at += 4 + length
        return stream[at - length : at]

    greeting = json.loads(text())
    while stream[at : at + 1] != b"E":
        mark, at = stream[at : at + 1], at + 1
        if mark == b"I":
            samples += struct.iter_unpack("<7d", text())
            continue
        assert mark == b"F", (mark, at)
        head = json.loads(text())
        for part in "color", "depth":
            head[part] = stream[at : at + head[f"{part}_bytes"]]
            at += head[f"{part}_bytes"]
        frames.append(head)
    return greeting, frames, np.array(samples)


class CameraTest(unittest.TestCase):
    """One family, through the fake of its library."""

    family = "realsense"
    variable = "SGS_REALSENSE_LIBRARY"

    @classmethod
    def setUpClass(cls):
        if hasattr(CameraTest, "shared"):
            return
        CameraTest.shared = pathlib.Path(tempfile.mkdtemp(prefix="sgs-camera-"))
        unittest.addModuleCleanup(shutil.rmtree, cls.shared, ignore_errors=True)
        subprocess.run([RIG, cls.shared / "rig", str(FRAMES)], check=True)
        CameraTest.color = Recorded(cls.shared / "rig/color")
        CameraTest.depth = Recorded(cls.shared / "rig/depth")
        CameraTest.aligned = cls.shared / "aligned"
        write_scene(cls.aligned, cls.color, cls.color)

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="case-", dir=self.shared))
        self.state = self.folder / "state"
        self.state.mkdir()
        self.run_folder = self.folder / "run"
        self.environment = {
            **{key: value for key, value in os.environ.items() if "FAKE_CAMERA" not in key},
            "FAKE_CAMERA_SCENE": str(self.aligned),
            "FAKE_CAMERA_STATE": str(self.state),
        }
        self.library(self.fake_library())

    def fake_library(self, kind="whole"):
        return FAKES / f"fake_{self.family}_{kind}.so"

    def library(self, path):
        self.environment[self.variable] = str(path)

    def camera(self, options=f"every=on,frames={FRAMES}"):
        return f"camera:{self.family}" + (f",{options}" if options else "")

    def rewind(self):
        """The fake begins its scene again."""
        for entry in self.state.iterdir():
            entry.unlink()

    def fake(self, **variants):
        for name, value in variants.items():
            self.environment["FAKE_CAMERA_" + name.upper()] = str(value)

    def done(self, *command, code=0):
        done = subprocess.run(
            [str(word) for word in command],
            capture_output=True,
            text=True,
            timeout=TIMEOUT,
            cwd=self.folder,
            env=self.environment,
        )
        self.assertEqual(done.returncode, code, done.stderr + done.stdout)
        return done

    def sent_by(self, program, *options, code=0):
        """What a camera's program writes to its standard output, in bytes, and what it says."""
        done = subprocess.run(
            [program, "--every=on", *options],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=TIMEOUT,
            env=self.environment,
        )
        said = done.stderr.decode()
        self.assertEqual(done.returncode, code, said)
        return done.stdout, said

    def run_camera(self, *options, source=None, code=0):
        command = (SGS, "run", source or self.camera(), "-o", self.run_folder, *options)
        return self.done(*command, code=code).stderr

    def sent(self, *options):
        """What the program sends by itself, and says."""
        stream, said = self.sent_by(SGS.parent / f"sgs-camera-{self.family}", *options)
        return (*parts_of(stream), said)

    def refused(self, *words, source=None, code=1):
        said = self.run_camera("--quiet", source=source or self.camera(""), code=code)
        for word in words:
            self.assertIn(word, said)
        return said

    def until_played(self, process):
        """Ctrl-C when the fake has nothing left; all that the run said."""
        until = time.monotonic() + TIMEOUT
        while not (self.state / "next").exists() or self.played() < FRAMES:
            self.assertIsNone(process.poll(), "the run ended")
            self.assertLess(time.monotonic(), until)
            time.sleep(0.05)
        time.sleep(1)  # the last frames are on their way
        process.send_signal(signal.SIGINT)
        said = process.communicate(timeout=TIMEOUT)[1].decode()
        self.assertEqual(process.returncode, 130, said)
        return said

    def played(self):
        text = (self.state / "next").read_text()
        return int(text) if text else 0

    def begin(self, source=None, *options):
        process = subprocess.Popen(
            [
                SGS,
                "run",
                source or self.camera("every=on"),
                "-o",
                self.run_folder,
                *TRACK,
                *options,
            ],
            cwd=self.folder,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            env=self.environment,
        )
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.kill)
        return process

    def tracked(self):
        return len(rows(self.run_folder / "trajectory.txt"))

    def assert_same_run(self, source):
        reference = self.folder / "reference"
        self.done(SGS, "run", source, "-o", reference, "--no-eval", "--quiet")
        for name in "trajectory.txt", "map.ply":
            mine, theirs = ((f / name).read_bytes() for f in (self.run_folder, reference))
            self.assertEqual(mine, theirs, name)

    def play_unregistered(self):
        """The fake plays the scene of two cameras; the pose of the one in the other's axes."""
        values = [float(value) for value in (self.shared / "rig/rig.txt").read_text().split()]
        x, y, z, w = np.array(values[3:])
        R = np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
            ]
        )
        scene = self.folder / "scene"
        write_scene(scene, self.color, self.depth, (R.T.ravel(), values[:3]))
        self.fake(scene=scene)
        return values

    def sent_by_version_1(self, color_from_depth, camera=None, times=None):
        """The same frames of a sender of version 1; the address of what it sent. Without the pose
        of the depth camera: of the colour camera alone."""
        head, depths = dict(camera=camera or self.color.json(), depth="u16"), self.color.depths
        if color_from_depth is not None:
            depths = self.depth.depths
            head.update(depth_camera=self.depth.json(), color_from_depth=color_from_depth)
        text = json.dumps(head).encode()
        stream = b"SGS1" + struct.pack("<I", len(text)) + text
        for t, color, depth in zip(times or self.color.times, self.color.colors, depths):
            data = color.tobytes(), depth.astype("<u2").tobytes()
            text = json.dumps(dict(t=t, color_bytes=len(data[0]), depth_bytes=len(data[1])))
            stream += b"F" + struct.pack("<I", len(text)) + text.encode() + b"".join(data)
        (self.folder / "stream").write_bytes(stream + b"E")
        return f"live:{self.folder / 'stream'}"

    def log(self):
        return (self.run_folder / "log.txt").read_text()

    def assert_no_program_is_left(self):
        mine = f"FAKE_CAMERA_STATE={self.state}".encode()
        for process in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                left = mine in (process / "environ").read_bytes()
            except OSError:
                continue
            self.assertFalse(left, process)


class Replugged:
    """A camera whose cable comes off during a run, for each family (a mixin of CameraTest)."""

    def test_unplugged_and_plugged_in_again(self):
        self.fake(unplug=6, rate=60)
        said = self.until_played(self.begin())
        self.assertIn("the camera was unplugged", said)
        self.assertIn("a sender is there again", said)
        self.assertEqual(self.tracked(), FRAMES)
        times = np.array(rows(self.run_folder / "trajectory.txt"), float)[:, 0]
        self.assertTrue((np.diff(times) > 0).all())
        self.assert_no_program_is_left()
