# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Programs in Python that read cameras, with fakes of the packages that they ask.

Usage: python_test.py SGS RENDER_RIG FOLDER_OF_FAKES [unittest arguments]
"""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import unittest

import numpy as np

from fake_cameras import FRAMES, SGS, TIMEOUT, TRACK, CameraTest, parts_of, rows, write_scene

HERE = pathlib.Path(__file__).resolve().parent
PROGRAMS = HERE.parent.parent / "apps/cameras/python"


class PythonTest(CameraTest):
    package = None  # that the program asks

    def setUp(self):
        super().setUp()
        self.environment["SGS_CAMERA_PROGRAMS"] = str(PROGRAMS)
        self.environment["PYTHONPATH"] = str(HERE / "python_fakes")
        self.environment["PYTHONDONTWRITEBYTECODE"] = "1"
        here = os.path.dirname(sys.executable)  # numpy is installed for this Python
        self.environment["PATH"] = f"{here}:{os.environ['PATH']}"

    def fake_library(self, kind="whole"):
        return ""

    def camera(self, options=f"every=on,skip=0,frames={FRAMES}"):
        return super().camera(options)

    def sent(self, *options, code=0):
        """What the program sends by itself, and says."""
        program = PROGRAMS / f"sgs-camera-{self.family}"
        self.stream, said = self.sent_by(program, "--skip=0", *options, code=code)
        return said if code else (*parts_of(b"SGS2" + self.stream[4:]), said)

    def without_the_package(self):
        """The fakes' folder with a package in place of it that cannot be imported."""
        folder = self.folder / "none"
        folder.mkdir()
        (folder / f"{self.package}.py").write_text("raise ImportError('it is not there')\n")
        self.environment["PYTHONPATH"] = str(folder)

    def test_a_package_that_is_missing(self):
        self.without_the_package()
        self.refused(f"package {self.package} cannot be loaded", f"pip install {self.package}")
        listed = json.loads(self.done(SGS, "info", "--cameras", "--json").stdout)
        (problem,) = (one for one in listed if one["family"] == self.family)
        self.assertIn("cannot be loaded", json.dumps(problem))

    def test_what_is_there(self):
        self.fake(devices="0123,4567")
        text = self.done(SGS, "info", "--cameras").stdout
        for serial in "0123", "4567":
            self.assertIn(f"camera:{self.family}:{serial}", text)
        self.run_camera(*TRACK, source=f"camera:{self.family}:4567,every=on,skip=0,frames=5")
        self.refused("with the serial number 89", source=f"camera:{self.family}:89")
        self.fake(devices="none")
        self.refused("is plugged in")

    def test_options_that_are_none(self):
        for options, words in (("size=big", "no size"), ("fps=0", "no rate"), ("x=1", "--x=1")):
            self.refused(words, source=f"camera:{self.family},{options}", code=2)

    def test_the_first_frames_are_left_out(self):
        self.assertEqual(len(self.sent("--skip=5", "--frames=3")[1]), 3)
        self.assertGreaterEqual(self.played(), 8)

    def test_unplugged_and_plugged_in_again(self):
        self.fake(unplug=6)
        said = self.until_played(self.begin(f"camera:{self.family},every=on,skip=0"))
        self.assertIn("a sender is there again", said)
        self.assertEqual(self.tracked(), FRAMES)
        self.assert_no_program_is_left()


class Oakd(PythonTest):
    family, package = "oakd", "depthai"

    def test_the_same_scene_from_a_folder(self):
        for platform in "RVC2", "RVC4":
            self.rewind()
            self.fake(platform=platform)
            shutil.rmtree(self.run_folder, ignore_errors=True)
            self.run_camera("--no-eval", "--quiet")
            self.assert_same_run(self.color.folder)
            shutil.rmtree(self.folder / "reference")

    def test_what_is_sent(self):
        greeting, frames, _, said = self.sent(f"--frames={FRAMES}", "--imu=off")
        self.assertEqual(self.stream[:4], b"SGS3")
        self.assertEqual(greeting["camera"], self.color.json())
        self.assertEqual((greeting["depth"], greeting["depth_scale"]), ("u16", 1000))
        self.assertEqual(greeting["clock"], "device")
        self.assertEqual([frame["t"] for frame in frames], self.color.times)
        self.assertEqual([frame["depth_t"] for frame in frames], self.color.times)
        self.assertEqual(frames[0]["color"], self.color.colors[0].tobytes())
        self.assertEqual(frames[0]["depth"], self.color.depths[0].astype("<u2").tobytes())
        self.assertEqual((frames[0]["exposure_s"], frames[0]["gain"]), (0.008, 400))
        self.assertEqual(said, "")

    def test_versions(self):
        self.fake(version="2.30.0.0")
        self.refused("depthai has version 2.30.0.0; needed is 3", "depthai>=3")

    def test_cameras_that_cannot_be_used(self):
        self.fake(fail="X_LINK_DEVICE_ALREADY_IN_USE")
        self.refused("cannot be opened: X_LINK_DEVICE_ALREADY_IN_USE", "another program")
        self.fake(fail="")
        self.refused("no such resolution", "try ,size=640x480", source="camera:oakd,size=31x17")

    def test_images_of_another_kind(self):
        self.fake(nv12=1)
        self.assertIn("expected are RGB888i and RAW16", self.sent(code=1))
        self.fake(nv12="", smaller_depth=1)
        self.assertIn("does not lie on colour", self.sent(code=1))

    def test_a_camera_that_falls_silent(self):
        self.assertIn("has given no image for 6 s", self.sent(code=1))


class Record3d(PythonTest):
    family, package = "record3d", "record3d"

    def sent_again(self, times, depths, camera):
        """The address of the same frames in metres, of a sender of version 1."""
        path = self.folder / "again"
        with open(path, "wb") as file:

            def part(mark, head, *data):
                text = json.dumps(head).encode()
                file.write(mark + len(text).to_bytes(4, "little") + text + b"".join(data))

            part(b"SGS1", dict(camera=camera, depth="f32"))
            for t, color, depth in zip(times, self.color.colors, depths):
                data = color.tobytes(), depth.tobytes()
                part(b"F", dict(t=t, color_bytes=len(data[0]), depth_bytes=len(data[1])), *data)
            file.write(b"E")
        return f"live:{path}"

    def metres(self, unsure=0):
        images = [depth.astype("<u2") * np.float32(0.001) for depth in self.color.depths]
        for image in images:
            image[:unsure] = 0
        return images

    def test_the_same_scene_from_a_file(self):
        """Times are those of arrival: the run is compared with one of the same frames and times."""
        for kind in 1, 0:  # LiDAR; TrueDepth, whose images are mirrored
            self.rewind()
            shutil.rmtree(self.run_folder, ignore_errors=True)
            shutil.rmtree(self.folder / "reference", ignore_errors=True)
            self.fake(kind=kind)
            greeting, frames, _, said = self.sent(f"--frames={FRAMES}")
            self.assertEqual((greeting["camera"], said), (self.color.json(), ""))
            (self.folder / "sent").write_bytes(self.stream)
            times = [frame["t"] for frame in frames]
            self.assertTrue((np.diff(times) > 0).all())
            self.run_camera("--no-eval", "--quiet", source=f"live:{self.folder / 'sent'}")
            self.assert_same_run(self.sent_again(times, self.metres(), self.color.json()))

    def test_a_whole_run(self):
        self.run_camera(*TRACK)
        self.assertEqual(self.tracked(), FRAMES)

    def test_smaller_depth_lies_on_colour(self):
        """As LiDAR gives it: the same view in fewer pixels."""
        half = self.folder / "half"
        shutil.copytree(self.color.folder, half)
        small = type(self.color)(half)
        small.width, small.height = small.width // 2, small.height // 2
        small.depths = [depth[::2, ::2] for depth in small.depths]
        write_scene(half / "scene", self.color, small)
        self.fake(scene=half / "scene")
        greeting, frames, _, _ = self.sent(f"--frames={FRAMES}")
        depth, color = greeting["depth_camera"], self.color.json()
        self.assertEqual((depth["width"], depth["height"]), (small.width, small.height))
        self.assertAlmostEqual(depth["fx"], color["fx"] / 2)
        # The middle of the picture stays its middle.
        self.assertAlmostEqual(depth["cx"] + 0.5, (color["cx"] + 0.5) / 2)
        self.assertEqual(greeting["color_from_depth"], [0, 0, 0, 0, 0, 0, 1])
        self.assertEqual(len(frames[0]["depth"]), 4 * small.width * small.height)
        self.rewind()
        self.run_camera(*TRACK)
        self.assertEqual(self.tracked(), FRAMES)

    def test_what_the_phone_is_not_sure_of_is_left_out(self):
        self.fake(unsure=40)
        frames = self.sent("--frames=1")[1]
        self.assertEqual(frames[0]["depth"], self.metres(unsure=40)[0].tobytes())

    def test_a_lens_that_moves(self):
        self.fake(moved=0.5)
        self.assertNotIn("lens", self.sent("--frames=5")[-1])
        self.rewind()
        self.fake(moved=20)
        self.assertEqual(self.sent("--frames=5")[-1].count("the lens has moved"), 1)

    def test_phones_that_cannot_be_used(self):
        self.fake(fail=1)
        self.refused("the phone does not stream", "red button")
        self.fake(fail="", bad_depth=1)
        self.assertIn("not in metres", self.sent(code=1))
        self.refused("size= is the app's", source="camera:record3d,size=640x480", code=2)

    def test_a_phone_that_falls_silent(self):
        done = subprocess.run(
            [PROGRAMS / "sgs-camera-record3d", "--skip=0"],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            timeout=TIMEOUT,
            env=self.environment,
        )
        self.assertIn("has given no image for 6 s", done.stderr.decode())


del PythonTest  # of it there are no tests

if __name__ == "__main__":
    unittest.main()
