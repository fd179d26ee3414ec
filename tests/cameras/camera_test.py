# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""`sgs run camera:` with a fake of librealsense2, and with programs for cameras that misbehave.

Usage: camera_test.py SGS RENDER_RIG FOLDER_OF_FAKES [unittest arguments]
"""
import json
import shutil
import signal
import textwrap
import time
import unittest

import numpy as np

from fake_cameras import FRAMES, NO_SDK, SGS, STEP_S, TIMEOUT, TRACK, CameraTest, Replugged, rows


class Frames(CameraTest):
    """What a camera delivers arrives as it was delivered."""

    def test_the_same_scene_from_a_folder(self):
        self.run_camera("--no-eval", "--quiet")
        self.assert_same_run(self.color.folder)

    def test_the_only_camera_there_is(self):
        self.run_camera(*TRACK, source=f"camera:,every=on,frames={FRAMES}")
        self.assertEqual(self.tracked(), FRAMES)

    def test_depth_that_is_not_registered(self):
        values = self.play_unregistered()
        greeting = self.sent("--frames=1")[0]
        np.testing.assert_allclose(greeting["color_from_depth"], values, atol=1e-6)
        self.rewind()
        self.run_camera("--no-eval", "--quiet")
        self.assert_same_run(self.sent_by_version_1(greeting["color_from_depth"]))

    def test_what_is_sent(self):
        greeting, frames, samples, said = self.sent(f"--frames={FRAMES}")
        self.assertEqual((greeting["depth"], greeting["depth_scale"]), ("u16", 1000))
        self.assertEqual((greeting["clock"], greeting["laser"]), ("device", True))
        self.assertNotIn("depth_camera", greeting)
        self.assertEqual([frame["t"] for frame in frames], self.color.times)
        self.assertEqual(frames[0]["color"], self.color.colors[0].tobytes(), "warm-up left out")
        for frame in frames:
            self.assertAlmostEqual(frame["exposure_s"], 0.008)
            self.assertAlmostEqual(frame["depth_exposure_s"], 0.008)
            self.assertEqual(frame["gain"], 16)
            self.assertLess(abs(frame["received_t"] - time.time()), 600)
        self.assertEqual(len(samples), 0)
        self.assertNotIn("error", said)

    def test_stamps_are_those_of_the_middle_of_the_exposure(self):
        self.fake(shift_us=4000)
        frames = self.sent("--frames=3")[1]
        mine = [frame["t"] for frame in frames]
        np.testing.assert_allclose(mine, np.array(self.color.times[:3]) - 0.004, atol=1e-9)

    def test_inertial_samples(self):
        for accel, gyro in ((63, 200), (250, 400)):
            self.rewind()
            self.fake(imu=f"{accel},{gyro}")
            greeting, _, samples, _ = self.sent(f"--frames={FRAMES}")
            self.assertEqual(greeting["imu"]["color_from_imu"], [0, 0, 0, 0, 0, 0, 1])
            seconds = FRAMES * STEP_S
            felt, turned = (samples[~np.isnan(samples[:, i])] for i in (4, 1))
            self.assertLessEqual(abs(len(felt) - accel * seconds), 2)
            self.assertLessEqual(abs(len(turned) - gyro * seconds), 2)
            np.testing.assert_allclose(felt[:, 4:], [[0, -9.81, 0]] * len(felt), atol=1e-5)
            self.assertTrue((np.diff(felt[:, 0]) > 0).all())
            self.assertFalse(np.isnan(turned[:, 1:4]).any())
        self.rewind()
        self.assertEqual(self.sent("--imu=off", "--frames=3")[2].size, 0)

    def test_what_was_recorded_has_the_samples_too(self):
        self.fake(imu="200,400")
        self.run_camera("--no-eval", "--quiet", "--record", "kept")
        felt = np.array(rows(self.folder / "kept/accelerometer.txt"), float)
        self.assertGreater(len(felt), 5)
        np.testing.assert_allclose(felt[:, 1:], [[0, 9.81, 0]] * len(felt), atol=1e-4)
        reference = self.folder / "reference"
        self.done(SGS, "run", "kept", "-o", reference, "--no-eval", "--quiet")
        mine, theirs = ((f / "trajectory.txt").read_text() for f in (self.run_folder, reference))
        self.assertEqual(mine, theirs)
        again = json.loads((self.folder / "reference/metrics.json").read_text())
        mine = json.loads((self.run_folder / "metrics.json").read_text())
        self.assertEqual(mine["upright"], again["upright"])

    def test_what_was_recorded_is_refined_later(self):
        self.run_camera("--no-eval", "--quiet", "--record", "kept")
        refine = (SGS, "refine", self.run_folder, "--steps", "20", "--quiet")
        self.done(*refine, "-o", self.folder / "refined", "--no-eval")
        self.assertTrue((self.folder / "refined/map.ply").exists())
        (self.folder / "kept").rename(self.folder / "elsewhere")
        said = self.done(*refine, "-o", self.folder / "none", code=1).stderr
        self.assertIn(f"were kept in {self.folder}/kept, which is not there", said)

    def test_what_was_not_recorded_cannot_be_refined(self):
        self.run_camera(*TRACK, "--quiet")
        said = self.done(SGS, "refine", self.run_folder, "--quiet", code=1).stderr
        self.assertIn("--record", said)

    def test_depth_at_half_the_rate(self):
        self.fake(depth_every=2)
        frames = self.sent(f"--frames={FRAMES // 2}")[1]
        self.assertEqual([frame["t"] for frame in frames], self.color.times[::2])

    def test_a_clock_that_wraps(self):
        self.fake(clock="wrap")
        _, frames, _, said = self.sent(f"--frames={FRAMES}")
        times = [frame["t"] for frame in frames]
        np.testing.assert_allclose(np.diff(times), STEP_S, atol=1e-6)
        self.assertNotIn("note", said)

    def test_a_clock_that_is_set(self):
        for clock in "jump", "back":
            self.rewind()
            self.fake(clock=clock)
            _, frames, _, said = self.sent(f"--frames={FRAMES}")
            steps = np.diff([frame["t"] for frame in frames])
            self.assertTrue((steps > 0).all() and (steps < 1).all(), steps)
            self.assertIn("clock jumped by", said)

    def test_a_clock_that_drifts(self):
        self.fake(clock="drift")
        self.run_camera(*TRACK, "--quiet")
        self.assertEqual(self.tracked(), FRAMES)

    def test_older_and_newer_libraries(self):
        for version, text in ((23100, "2.31.0"), (29907, "2.99.7")):
            self.rewind()
            self.fake(version=version)
            self.assertEqual(len(self.sent("--frames=2")[1]), 2)
            self.assertIn(text, self.done(SGS, "info", "--cameras").stdout)

    def test_exposure_is_locked_when_it_is_asked_for(self):
        self.fake(rate=20)
        self.run_camera(*TRACK, source=f"camera:realsense,lock=0.05,every=on,frames={FRAMES}")
        options = (self.state / "options").read_text()
        self.assertIn("2 Enable Auto Exposure 0\n2 Exposure 1\n", options)
        self.assertIn("exposure and white balance are locked", self.log())

    def test_what_a_camera_is_like(self):
        self.fake(imu="200,400", rate=32, clock="drift")
        command = (SGS, "camera-test", f"camera:realsense,frames={FRAMES}")
        lines = json.loads(self.done(*command, "--json").stdout)
        values = {line["key"]: line.get("value") for line in lines}
        self.assertEqual((values["frames"], values["unit"], values["gaps"]), (FRAMES, 1000, 0))
        self.assertAlmostEqual(values["rate"], 32, delta=0.1)
        self.assertAlmostEqual(values["felt"], 9.81, delta=0.01)
        self.assertAlmostEqual(values["accelerometer"], 200, delta=5)
        self.assertAlmostEqual(values["gyroscope"], 400, delta=5)
        self.assertGreater(values["pixels with depth"], 0.5)
        self.rewind()
        self.assertIn("in the pixels of colour", self.done(*command).stdout)

    def test_at_the_cameras_rate(self):
        self.fake(rate=10)
        self.run_camera("--no-eval", "--quiet", source=f"camera:realsense,frames={FRAMES}")
        metrics = json.loads((self.run_folder / "metrics.json").read_text())
        self.assertEqual(self.tracked() + metrics["frames_dropped"], FRAMES)


class Trouble(Replugged, CameraTest):
    """What goes wrong is one sentence with a remedy; what can be gone on with goes on."""

    def test_libraries_that_are_none(self):
        self.library("/nonexistent/librealsense2.so")
        self.refused("/nonexistent/librealsense2.so cannot be opened", "name the file")
        self.library(NO_SDK)
        self.refused("is no librealsense2")
        self.library(self.fake_library("missing"))
        self.refused("lacks the function rs2_extract_frame", "version 2.56.0")
        self.library(self.fake_library())
        for version, text in ((23000, "2.30.0"), (30100, "3.1.0")):
            self.fake(version=version)
            self.refused(f"has version {text}; needed is 2.31")

    def test_no_library(self):
        del self.environment["SGS_REALSENSE_LIBRARY"]
        if "is not installed" not in self.done(SGS, "info", "--cameras").stdout:
            self.skipTest("a librealsense2 is installed here")
        self.refused("librealsense2 is not installed", "SGS_REALSENSE_LIBRARY")
        self.refused("no camera was found", "librealsense2 is not installed", source="camera:")

    def test_a_library_in_the_loaders_path_the_newest_first(self):
        del self.environment["SGS_REALSENSE_LIBRARY"]
        for version in "2.9", "2.50", "2.50.1":
            shutil.copy(self.fake_library(), self.folder / f"librealsense2.so.{version}")
        self.environment["LD_LIBRARY_PATH"] = str(self.folder)
        self.assertIn("librealsense2.so.2.50.1 ", self.done(SGS, "info", "--cameras").stdout)

    def test_cameras_that_cannot_be_used(self):
        self.fake(devices="none")
        self.refused("no RealSense camera is plugged in", "USB 3")
        self.refused("no camera was found", source="camera:")
        self.fake(devices="11,22")
        self.refused("camera:realsense:11; camera:realsense:22", source="camera:", code=2)
        self.refused("serial number 33", "there is 11, 22", source="camera:realsense:33")
        self.fake(fail="xioctl(VIDIOC_S_FMT) failed Last Error: Device or resource busy")
        self.refused("used by another program", "fuser")
        self.fake(fail="failed to open usb interface: 0, error: RS2_USB_STATUS_ACCESS")
        self.refused("no permission", "60-sgs-cameras.rules")
        self.fake(fail="Couldn't resolve requests")
        self.refused("no such mode", "size=848x480", code=2)

    def test_usb_2(self):
        self.fake(usb="2.1")
        self.refused("connected by USB 2.1, too slow for 640x480 at 30 Hz", "size=480x270,fps=15")
        source = f"camera:realsense,size=480x270,fps=15,every=on,frames={FRAMES}"
        self.assertIn("USB 2.1", self.run_camera(*TRACK, source=source))
        self.assertEqual(self.tracked(), FRAMES)

    def test_old_firmware_is_worth_a_word(self):
        self.fake(firmware="5.10.0.0")
        self.assertIn("recommends 5.16.0.1", self.run_camera(*TRACK))

    def test_names_and_options_that_are_none(self):
        for source, text in (
            ("camera:nonsense", "camera:realsense"),
            ("camera:realsense,nonsense", "'nonsense' is no KEY=VALUE"),
            ("camera:realsense,nonsense=1", "nonsense"),
            ("camera:realsense,size=big", "is no size"),
            ("camera:realsense,fps=0", "fps"),
            ("camera:realsense,every=maybe", "every"),
            ("camera::serial", "family"),
        ):
            self.refused(text, source=source, code=2)
        said = self.run_camera("--frames", "0:3", code=2)
        self.assertIn("does not apply", said)

    def test_what_is_there(self):
        text = self.done(SGS, "info", "--cameras").stdout
        self.assertIn("camera:realsense:0123  Fake RealSense D435", text)
        listed = json.loads(self.done(SGS, "info", "--cameras", "--json").stdout)
        family = next(one for one in listed if one["family"] == "realsense")
        self.assertEqual(family["devices"][0]["input"], "camera:realsense:0123")
        self.fake(devices="none")
        self.assertIn("no RealSense camera", self.done(SGS, "info", "--cameras").stdout)

    def test_a_clock_that_stands_elsewhere_afterwards(self):
        self.fake(unplug=7, rate=60, clock="back")
        said = self.until_played(self.begin())
        self.assertIn("moved to follow those before", said)
        self.assertEqual(self.tracked(), FRAMES)

    def test_a_library_that_crashes(self):
        self.fake(crash=6, rate=60)
        said = self.until_played(self.begin())
        self.assertIn("ended by signal 11", said)
        # What the program had not sent yet is gone with it. What came after is all there.
        times = np.array(rows(self.run_folder / "trajectory.txt"), float)[:, 0]
        after = np.diff(times[-(FRAMES - 6) :])
        self.assertEqual(len(after), FRAMES - 6 - 1)
        self.assertLess(after.max(), 1.5 * after.min())
        self.assertGreater(self.tracked(), FRAMES - 6)

    def test_a_camera_that_falls_silent(self):
        self.fake(stall=6, rate=60)
        said = self.until_played(self.begin())
        self.assertIn("has given no image for 6 s", said)
        self.assertEqual(self.tracked(), FRAMES)

    def test_unplugged_for_good(self):
        self.fake(unplug=6, rate=60, away_s=3600)
        process = self.begin("camera:realsense,every=on", "--wait", "10")
        said = process.communicate(timeout=TIMEOUT)[1].decode()
        self.assertEqual(process.returncode, 1, said)
        self.assertIn("no sender for 10 s", said)
        self.assertEqual(self.tracked(), 6)


class Programs(CameraTest):
    """Programs for cameras that others wrote badly."""

    HEAD = """\
        #!/usr/bin/python3
        import json, struct, sys, time
        if "--list" in sys.argv:
            print(json.dumps(dict(library="own", devices=[dict(name="x", serial="1")])))
            sys.exit()
        out = sys.stdout.buffer
        def part(mark, head, *data):
            text = json.dumps(head).encode()
            out.write(mark + struct.pack("<I", len(text)) + text + b"".join(data))
            out.flush()
        camera = dict(width=64, height=48, fx=60, fy=60, cx=31.5, cy=23.5)
        def greet():
            part(b"SGS2", dict(camera=camera, depth="u16", clock="device", listens=True))
        def frame(t):
            color, depth = bytes(range(256)) * 36, struct.pack("<H", 2000) * (64 * 48)
            part(b"F", dict(t=t, color_bytes=len(color), depth_bytes=len(depth)), color, depth)
        """

    def program(self, body):
        path = self.folder / "sgs-camera-own"
        path.write_text(textwrap.dedent(self.HEAD) + textwrap.dedent(body))
        path.chmod(0o755)
        self.environment["SGS_CAMERA_PROGRAMS"] = str(self.folder)

    def run_own(self, *options, code=0):
        return self.run_camera(*TRACK, *options, source="camera:own,every=on", code=code)

    def frames(self):
        return len((self.run_folder / "frames.csv").read_text().splitlines()) - 1

    def test_one_that_behaves(self):
        self.program("greet()\nfor i in range(6): frame(i / 30)\nout.write(b'E')")
        self.run_own(code=3)  # a grey wall is no place
        self.assertEqual(self.frames(), 6)
        self.assertIn("own", self.done(SGS, "info", "--cameras").stdout)

    def test_death_before_the_greeting(self):
        self.program(
            "print('error: the lens cap is on\\nremedy: take it off', file=sys.stderr)\nsys.exit(1)"
        )
        said = self.run_own(code=1)
        self.assertIn("the lens cap is on", said)
        self.assertIn("take it off", said)
        self.program("import os\nos.abort()")
        self.assertIn("ended by signal 6", self.run_own(code=1))

    def test_what_it_sends_is_no_stream(self):
        self.program("while True: out.write(b'x' * 65536)")
        self.assertIn("does not begin with SGS1", self.run_own("--wait", "10", code=1))

    def test_sizes_that_are_lies(self):
        self.program(
            "greet()\npart(b'F', dict(t=0, color_bytes=2**40, depth_bytes=0))\ntime.sleep(60)"
        )
        said = self.run_own("--wait", "10", code=1)
        self.assertIn("color_bytes", said)

    def test_samples_and_notes_without_end(self):
        self.program(
            """\
            greet()
            for i in range(3): frame(i / 30)
            sample = struct.pack("<7d", 0, *[0] * 6)
            for i in range(2000):
                print("note: " + "x" * 5000, file=sys.stderr)
                out.write(b"I" + struct.pack("<I", len(sample) * 100) + sample * 100)
            for i in range(3, 6): frame(i / 30)
            out.write(b"E")
            """
        )
        said = self.run_own(code=3)
        self.assertEqual(self.frames(), 6)
        self.assertIn("says more; it is left out", said)
        self.assertLess(len(said), 100000)

    def test_stamps_of_the_future(self):
        self.program(
            """\
            greet()
            for t in (0, 1, 2, 3e9, 3, 4, 5, 1e5, 1e5 + 1, 1e5 + 2, 1e5 + 3, 1e5 + 4): frame(t / 30)
            out.write(b"E")
            """
        )
        said = self.run_own(code=3)
        self.assertIn("in the future", said)
        self.assertIn("set forward", said)
        table = [
            line.split(",") for line in (self.run_folder / "frames.csv").read_text().splitlines()
        ]
        bad = [row[2] for row in table[1:]].count("bad")
        self.assertEqual((len(table) - 1, bad), (12, 4))

    def test_one_that_does_not_stop(self):
        self.program(
            """\
            import signal
            signal.signal(signal.SIGPIPE, signal.SIG_IGN)
            greet()
            i = 0
            while True:
                try:
                    frame(i / 30)
                except OSError:
                    pass
                i += 1
                time.sleep(0.03)
            """
        )
        process = self.begin("camera:own,every=on")
        while not (self.run_folder / "state.toml").exists():
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        said = process.communicate(timeout=TIMEOUT)[1].decode()
        self.assertEqual(process.returncode, 130, said)

    def test_an_answer_that_is_none(self):
        self.program("")
        path = self.folder / "sgs-camera-own"
        path.write_text("#!/bin/sh\necho nonsense\n")
        self.assertIn("does not say what is plugged in", self.done(SGS, "info", "--cameras").stdout)


if __name__ == "__main__":
    unittest.main()
