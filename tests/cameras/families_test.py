# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""`sgs run camera:` with every family but the first, each with a fake of its library.

Usage: families_test.py SGS RENDER_RIG FOLDER_OF_FAKES [unittest arguments]
"""
import glob
import json
import shutil
import unittest

import numpy as np

from fake_cameras import (
    FRAMES,
    NO_SDK,
    SGS,
    STEP_S,
    TRACK,
    CameraTest,
    Recorded,
    Replugged,
    write_scene,
)

OPENNI2 = next(iter(glob.glob("/usr/lib/*/libOpenNI2.so.0")), None)


class Family(Replugged):
    """What every family does alike."""

    name = ""  # as people say it
    library_name = ""
    old_and_new = ()  # versions that are refused, with the words for them
    kept_versions = ()  # versions that will do
    missing = ""  # the function that the fake lacks
    exposure, gain = True, True
    imu = True
    rates = (100, 200)  # of accelerometer and gyroscope
    at_rest = (0, -9.81, 0)
    busy, denied = "Device or resource busy", "Access denied (insufficient permissions)"

    def reference(self):
        """The same frames from elsewhere."""
        return self.color.folder

    def test_the_same_scene_from_elsewhere(self):
        self.run_camera("--no-eval", "--quiet")
        self.rewind()
        self.assert_same_run(self.reference())

    def test_what_is_sent(self):
        self.play_imu()
        greeting, frames, samples, said = self.sent(f"--frames={FRAMES}")
        self.assertEqual((greeting["depth"], greeting["depth_scale"]), ("u16", 1000))
        self.assertEqual((greeting["clock"], greeting["name"]), ("device", f"{self.family}-0123"))
        self.assertNotIn("depth_camera", greeting)
        times = [np.array([frame["t"] for frame in frames]), np.array(self.color.times)]
        if self.short_clock:
            times = [of - of[0] for of in times]
        np.testing.assert_allclose(*times, atol=self.tick_s)
        for frame, image in zip(frames, self.color.colors):
            self.assertEqual(frame["color"], image.tobytes())
            if self.exposure:
                self.assertAlmostEqual(frame["exposure_s"], 0.008)
            self.assertEqual(frame.get("gain"), 16 if self.gain else None)
        self.assertNotIn("error", said)
        self.check_samples(greeting, samples)

    tick_s = 1e-9  # of the device's clock
    short_clock = False  # it has wrapped before
    clocks = ("wrap", "jump", "back", "drift")

    def play_imu(self):
        if self.imu:
            self.fake(imu="{},{}".format(*self.rates))

    def check_samples(self, greeting, samples):
        if not self.imu:
            self.assertEqual(len(samples), 0)
            self.assertNotIn("imu", greeting)
            return
        np.testing.assert_allclose(greeting["imu"]["color_from_imu"], [0] * 6 + [1], atol=1e-6)
        felt, turned = (samples[~np.isnan(samples[:, i])] for i in (4, 1))
        np.testing.assert_allclose(felt[:, 4:], [self.at_rest] * len(felt), atol=1e-5)
        np.testing.assert_allclose(turned[:, 1:4], [[0.01, 0.02, 0.03]] * len(turned), atol=1e-7)
        for times, hz in (felt[:, 0], self.rates[0]), (turned[:, 0], self.rates[1]):
            self.assertLessEqual(abs(len(times) - hz * FRAMES * STEP_S), 8)
            np.testing.assert_allclose(np.diff(times), 1 / hz, atol=2e-6)

    def test_clocks(self):
        for clock in self.clocks:
            self.rewind()
            self.fake(clock=clock)
            _, frames, _, said = self.sent(f"--frames={FRAMES}")
            steps = np.diff([frame["t"] for frame in frames])
            self.assertEqual(len(frames), FRAMES)
            if clock in ("jump", "back"):
                self.assertTrue((steps > 0).all() and (steps < 1).all(), steps)
                self.assertIn("clock jumped by", said)
            else:
                np.testing.assert_allclose(steps, STEP_S, atol=max(1e-5, 2 * self.tick_s))
                self.assertNotIn("clock", said)

    def test_libraries_that_will_not_do(self):
        self.library(f"/nonexistent/{self.library_name}.so")
        self.refused(f"{self.library_name}.so cannot be opened", "name the file")
        self.library(NO_SDK)
        self.refused(f"is no {self.library_name}")
        self.library(self.fake_library("missing"))
        self.refused(f"lacks the function {self.missing}")
        self.library(self.fake_library())
        for version, text in self.old_and_new:
            self.fake(version=version)
            self.refused(f"has version {text}; needed is")
        for version, text in self.kept_versions:
            self.rewind()
            self.fake(version=version)
            self.assertEqual(len(self.sent("--frames=2")[1]), 2)
            self.assertIn(text, self.done(SGS, "info", "--cameras").stdout)

    def test_no_library(self):
        del self.environment[self.variable]
        listed = json.loads(self.done(SGS, "info", "--cameras", "--json").stdout)
        mine = next(one for one in listed if one["family"] == self.family)
        if mine["library"]:
            self.skipTest(f"a {self.library_name} is installed here")
        self.refused(f"{self.library_name} is not installed", self.variable)

    def test_cameras_that_cannot_be_used(self):
        self.fake(devices="none")
        self.refused(f"no {self.name} is plugged in", "cable")
        self.fake(devices="11,22")
        self.refused(f"camera:{self.family}:11; camera:{self.family}:22", source="camera:", code=2)
        self.refused("serial number 33", "there is 11, 22", source=f"camera:{self.family}:33")
        self.fake(fail=self.busy)
        self.refused("used by another program", "fuser")
        self.fake(fail=self.denied)
        self.refused("no permission", "60-sgs-cameras.rules")
        self.fake(fail="")
        self.refused("no such mode", source=self.camera("size=333x222"), code=2)

    def test_what_is_there(self):
        self.assertIn(
            f"camera:{self.family}:0123  {self.device}", self.done(SGS, "info", "--cameras").stdout
        )
        self.run_camera(*TRACK, source=f"camera:{self.family}:0123,every=on,frames={FRAMES}")
        self.assertEqual(self.tracked(), FRAMES)

    def test_what_a_camera_is_like(self):
        self.fake(rate=32)
        self.play_imu()
        command = (SGS, "camera-test", self.camera(f"frames={FRAMES}"))
        lines = json.loads(self.done(*command, "--json").stdout)
        values = {line["key"]: line.get("value") for line in lines}
        self.assertEqual((values["frames"], values["unit"], values["gaps"]), (FRAMES, 1000, 0))
        self.assertAlmostEqual(values["rate"], 32, delta=0.1)
        if self.imu:
            self.assertAlmostEqual(values["gyroscope"], self.rates[1], delta=20)


class WithTwoCameras:
    """A family that says where its two cameras are to each other."""

    def test_depth_that_is_not_registered(self):
        values = self.play_unregistered()
        greeting = self.sent("--frames=1")[0]
        np.testing.assert_allclose(greeting["color_from_depth"], values, atol=1e-6)
        self.rewind()
        self.run_camera("--no-eval", "--quiet")
        self.assert_same_run(self.sent_by_version_1(greeting["color_from_depth"]))

    def test_the_lens(self):
        lens = (0.1, -0.2, 0.001, 0.002, 0.05)
        scene = self.folder / "scene"
        curved = Recorded(self.color.folder)
        curved.lens = lens
        write_scene(scene, curved, self.color)
        self.fake(scene=scene)
        greeting = self.sent("--frames=1")[0]
        np.testing.assert_allclose(greeting["camera"]["distortion"][:5], lens, atol=1e-7)
        self.assertNotIn("distortion", greeting["depth_camera"])


class WithOneCamera:
    """A family that registers depth itself, and says little of its lens."""

    exposure, gain, imu = False, False, False

    def reference(self):
        greeting, frames = self.sent(f"--frames={FRAMES}")[:2]
        camera = greeting["camera"]
        for given, rigs in (camera["fx"], self.color.fx), (camera["fy"], self.color.fy):
            self.assertAlmostEqual(given, rigs, delta=self.focal_delta)
        return self.sent_by_version_1(None, camera, [frame["t"] for frame in frames])


class Orbbec(WithTwoCameras, Family, CameraTest):
    family, variable = "orbbec", "SGS_ORBBEC_LIBRARY"
    name, library_name, device = "Orbbec camera", "libOrbbecSDK", "Fake Orbbec Gemini 2"
    old_and_new = ((20017, "2.0.17"), (11018, "1.10.18"), (30000, "3.0.0"))
    kept_versions = ((20018, "2.0.18"), (29907, "2.99.7"))
    missing = "ob_stream_profile_list_get_profile"
    tick_s = 1e-6

    def test_usb_2(self):
        self.fake(usb="2.1")
        self.refused("connected by USB 2.1, too slow for 640x480 at 30 Hz", "size=640x480,fps=15")
        source = self.camera(f"size={self.size()},fps=15,every=on,frames=3")
        self.assertIn("USB 2.1", self.run_camera(*TRACK, source=source))

    def size(self):
        return f"{self.color.width}x{self.color.height}"

    def test_settings(self):
        self.fake(rate=20)
        self.run_camera(*TRACK, source=self.camera(f"lock=0.05,every=on,frames={FRAMES}"))
        options = (self.state / "options").read_text()
        for line in "81 off", "14 off", "2012 0", "log to file 5", "2000 off\n2001 2001":
            self.assertIn(f"{line}\n", options)
        self.assertIn("exposure and white balance are locked", self.log())
        self.assertEqual((self.state / "left").read_text(), "0", "frames that were kept")


class K4a(WithTwoCameras, Family, CameraTest):
    family, variable = "k4a", "SGS_K4A_LIBRARY"
    name, library_name, device = "Azure Kinect", "libk4a", "Azure Kinect"
    missing = "k4a_image_get_device_timestamp_usec"
    rates = (200, 200)
    tick_s = 1e-6
    busy = "libusb device(s) are all unavalable. Is the device being used by another application?"
    denied = "libusb_open: LIBUSB_ERROR_ACCESS"

    def test_settings(self):
        self.fake(rate=20)
        self.run_camera(*TRACK, source=self.camera(f"lock=0.05,every=on,frames={FRAMES}"))
        options = (self.state / "options").read_text()
        for line in "resolution 1 depth 2 rate 2", "0 manual 8330", "6 manual 4500":
            self.assertIn(f"{line}\n", options)
        self.assertIn("exposure and white balance are locked", self.log())
        self.assertEqual((self.state / "left").read_text(), "0", "images that were kept")

    def test_sizes(self):
        self.sent("--size=1920x1080", "--fps=15", "--frames=1")
        options = (self.state / "options").read_text()
        self.assertIn("resolution 2 depth 2 rate 1\n", options)
        self.refused("no such mode", "at 5, 15 and 30", source=self.camera("fps=29"), code=2)

    def test_no_depth_engine(self):
        self.fake(start="Depth engine create and initialize failed with error code: 204.")
        self.refused("error code: 204", "libdepthengine", "DISPLAY")


class Freenect(WithOneCamera, Family, CameraTest):
    family, variable = "freenect", "SGS_FREENECT_LIBRARY"
    name, library_name, device = "Kinect", "libfreenect", "Kinect"
    missing = "freenect_process_events_timeout"
    busy = "Could not claim interface on camera: LIBUSB_ERROR_BUSY"
    denied = "Could not open camera: LIBUSB_ERROR_ACCESS"
    tick_s, short_clock = 1e-7, True
    clocks = ("wrap", "jump", "drift")  # of 72 s: forwards or back is the same to it
    focal_delta = 10

    def test_settings(self):
        self.fake(rate=20)
        said = self.run_camera(*TRACK, source=self.camera(f"lock=0.05,every=on,frames={FRAMES}"))
        self.assertIn("does not say its focal length: 262.5 pixels", said)
        options = (self.state / "options").read_text()
        for flag in 16, 17, 14, 1:  # mirrors, exposure, white balance
            self.assertIn(f"flag {1 << flag} 0\n", options)
        self.assertIn("exposure and white balance are locked", self.log())


@unittest.skipUnless(OPENNI2, "OpenNI2 is not installed")
class OpenNi2(WithOneCamera, Family, CameraTest):
    """The real library, with a driver for a camera that is none."""

    family, variable = "openni2", "SGS_OPENNI2_LIBRARY"
    name, library_name, device = "OpenNI2 camera", "libOpenNI2", "Fake OpenNI2"
    missing = "oniGetExtendedError"
    tick_s = 1e-6
    focal_delta = 1e-3

    def fake_library(self, kind="whole"):
        if kind != "whole":
            return super().fake_library(kind)
        drivers = self.folder / "OpenNI2/Drivers"
        drivers.mkdir(parents=True, exist_ok=True)
        shutil.copy(super().fake_library(), drivers / "libfake.so.0")
        return shutil.copy(OPENNI2, self.folder / "libOpenNI2.so")

    def test_settings(self):
        self.fake(rate=20)
        self.run_camera(*TRACK, source=self.camera(f"lock=0.05,every=on,frames={FRAMES}"))
        options = (self.state / "options").read_text()
        for line in "color 7 0", "depth 7 0", "device 5 1", "color 101 0", "color 100 0":
            self.assertIn(f"{line}\n", options)
        self.assertIn("exposure and white balance are locked", self.log())
        self.assertIn("2.2.0.33", self.done(SGS, "info", "--cameras").stdout)

    def test_one_that_does_not_register_depth(self):
        self.fake(registers="no")
        self.assertIn("does not register depth to colour", self.sent("--frames=1")[-1])

    def test_another_major_version(self):
        self.library(self.fake_library("missing"))
        self.fake(version=3)
        self.refused("has version 3.2.0.33; needed is 2.2")


if __name__ == "__main__":
    unittest.main()
