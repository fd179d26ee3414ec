# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings of an Azure Kinect (.mkv): as the bag of ROS that holds the same images.

Usage: kinect_test.py SGS_EXECUTABLE RIG_RENDERER NODE_FOLDER [unittest arguments]
"""
import json
import unittest

import numpy as np

import kinect_files as kinect
import recordings as rec
from bags_test import COLOR_CAMERA, COLOR_SIZE, FRAMES, BagTest, packed_picture, tum

DEPTH_CAMERA, DEPTH_SIZE = (252, 253, 161, 147), (320, 288)


def matrix(t, q):
    x, y, z, w = q
    T = np.eye(4)
    T[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    T[:3, 3] = t
    return T


# The calibration is of a world of its own, and the unit's axes are x back, y left, z down.
WORLD = matrix((0.1, -0.2, 0.05), (0.1, -0.1, 0.1, np.sqrt(0.97)))
UNIT = matrix((-0.05, 0.003, 0.001), (0, 0, 0, 1))
UNIT[:3, :3] = [[0, 0, -1], [-1, 0, 0], [0, 1, 0]]


def as_yuv(rgb):
    """Y, U and V of ITU-R BT.601."""
    r, g, b = np.moveaxis(rgb.astype(float), 2, 0) / 256
    y = 16 + 65.738 * r + 129.057 * g + 25.064 * b
    u = 128 - 37.945 * r - 74.494 * g + 112.439 * b
    v = 128 + 112.439 * r - 94.154 * g - 18.285 * b
    return y, u, v


def as_bytes(values):
    return np.clip(np.rint(values), 0, 255).astype(np.uint8).tobytes()


def as_nv12(rgb):
    y, u, v = as_yuv(rgb)
    fours = [p.reshape(p.shape[0] // 2, 2, p.shape[1] // 2, 2).mean(axis=(1, 3)) for p in (u, v)]
    return as_bytes(y) + as_bytes(np.stack(fours, axis=-1))


def as_yuy2(rgb):
    y, u, v = as_yuv(rgb)
    pairs = [p.reshape(p.shape[0], p.shape[1] // 2, 2).mean(axis=2) for p in (u, v)]
    return as_bytes(np.stack((y[:, ::2], pairs[0], y[:, 1::2], pairs[1]), axis=-1))


class KinectTest(BagTest):
    rig_kind = ("kinect",)
    depth_camera, depth_size = DEPTH_CAMERA, DEPTH_SIZE

    def calibration(self):
        T_color_depth = matrix(self.rig_t, self.rig_q)
        color = kinect.unit_lens(COLOR_CAMERA, COLOR_SIZE)
        depth = kinect.unit_lens(DEPTH_CAMERA, (512, 512), (96, 90))
        return kinect.calibration(
            kinect.camera("PV0", color, T_color_depth @ WORLD, (4096, 3072)),
            kinect.camera("D0", depth, WORLD, (1024, 1024)),
            *(UNIT @ WORLD, UNIT @ WORLD),
        )

    def recording(self, code=b"BGRA", depth_later_ns=0):
        pack = {
            b"BGRA": lambda rgb: np.dstack([rgb[:, :, ::-1], np.full(rgb.shape[:2], 9)]).astype(
                "u1"
            ),
            b"MJPG": lambda rgb: packed_picture(rgb, "jpeg", quality=95),
            b"NV12": as_nv12,
            b"YUY2": as_yuy2,
        }[code]
        made = kinect.Recording(code, COLOR_SIZE, DEPTH_SIZE, self.calibration())
        for (time_ns, color, _), (_, _, depth) in zip(self.frames, self.depth_frames):
            made.image(kinect.COLOR, time_ns, bytes(pack(color)))
            made.image(kinect.DEPTH, time_ns + depth_later_ns, depth.astype(">u2").tobytes())
        return made

    def write(self, name, made):
        path = self.folder / name
        path.write_bytes(made if isinstance(made, bytes) else made.bytes())
        return path

    def add_imu(self, made, every_ns=625_000):
        """What a unit at rest feels: upwards, 9.81 m/s2, in its own axes. Returns upwards in the first
        camera's world."""
        ups = []
        rows = tum(self.color_folder / "groundtruth.txt")
        for row, after in zip(rows, [*rows[1:], None]):
            x, y, z, w = row[4:]
            up = np.array([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)])
            ups.append(up)
            T_color_unit = matrix(self.rig_t, self.rig_q) @ np.linalg.inv(UNIT)
            felt = 9.81 * T_color_unit[:3, :3].T @ up
            time_ns = round(row[0] * 1e9)
            end_ns = round(after[0] * 1e9) if after is not None else time_ns + 1
            for at in range(time_ns, end_ns, every_ns):
                made.imu(at, felt)
        return ups[0]

    def converted(self, path):
        """Times, images and camera of what is read, in numbers."""
        out = self.folder / (path.name + "-folder")
        done = self.sgs("convert", path, out, "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        return out


class Recordings(KinectTest):
    def test_the_same_images_as_of_a_bag(self):
        made = self.write("same.mkv", self.recording())
        bag = rec.write_rosbag(self.folder / "same.bag", self.unaligned())
        mine, theirs = self.converted(made), self.converted(bag)
        for kind in ("rgb", "depth"):
            files = sorted((theirs / kind).iterdir())
            self.assertEqual(len(files), FRAMES)
            for file in files:
                same = (mine / kind / file.name).read_bytes() == file.read_bytes()
                self.assertTrue(same, file)
        for name in ("rgb.txt", "depth.txt"):
            self.assertEqual((mine / name).read_text(), (theirs / name).read_text())

    def test_what_is_said_of_it(self):
        path = self.write("said.mkv", self.recording())
        said = json.loads(self.sgs("info", path, "--json").stdout)
        self.assertEqual(said["layout"], ".mkv of an Azure Kinect")
        self.assertEqual(
            (said["color_topic"], said["depth_topic"]), ("/color/image", "/depth/image")
        )
        for name, value in zip(("fx", "fy", "cx", "cy"), COLOR_CAMERA):
            self.assertAlmostEqual(said[name], value, places=9)
        self.assertEqual(said["depth_scale"], 1000)
        self.assertAlmostEqual(said["first_time_s"], self.frames[0][0] * 1e-9, places=6)
        self.assertEqual(said["warnings"], [])
        topics = {topic["topic"]: topic for topic in said["topics"]}
        self.assertEqual(topics["/color/image"]["encoding"], "bgra8")
        self.assertEqual(topics["/depth/image"]["encoding"], "16UC1")

    def test_it_runs_as_the_folder_of_the_scene(self):
        for code in b"BGRA", b"MJPG":
            path = self.write("walk.MKV", self.recording(code))
            self.check_registered(self.track(path))
            self.assertNotIn("warn", self.log())

    def test_colour_however_it_is_packed(self):
        from skimage.io import imread

        for code in b"MJPG", b"NV12", b"YUY2":
            folder = self.converted(self.write(f"{code.decode()}.mkv", self.recording(code)))
            files = sorted((folder / "rgb").iterdir())
            self.assertEqual(len(files), FRAMES)
            difference = imread(files[3]).astype(float) - self.frames[3][1]
            self.assertLess(np.abs(difference).mean(), 6, code)

    def test_a_folder_that_holds_it(self):
        folder = self.folder / "kept"
        folder.mkdir()
        path = self.write("kept/walk.mkv", self.recording())
        self.write("kept/video.mkv", kinect.video((64, 48)))
        self.assertEqual(self.track(folder), self.track(path))

    def test_each_image_has_its_own_time(self):
        later_ns = 3_000_000
        path = self.write("later.mkv", self.recording(depth_later_ns=later_ns))
        folder = self.converted(path)
        for name, after in (("rgb.txt", 0), ("depth.txt", later_ns)):
            lines = [line for line in (folder / name).read_text().splitlines() if line[0] != "#"]
            times = [float(line.split()[0]) for line in lines]
            expected = [1e-9 * (frame[0] + after) for frame in self.frames]
            np.testing.assert_allclose(times, expected, atol=1e-6, rtol=0)

    def test_the_lens(self):
        lens = (0.05, -0.02, 0.001, -0.0005, 0.01, 0.03, -0.01, 0.004)
        made = self.recording()
        calibrated = self.calibration()
        color = kinect.unit_lens(COLOR_CAMERA, COLOR_SIZE)
        T = matrix(self.rig_t, self.rig_q) @ WORLD
        cameras = calibrated["CalibrationInformation"]["Cameras"]
        cameras[1] = kinect.camera("PV0", color, T, (4096, 3072), lens)
        made.attachment = json.dumps(calibrated).encode() + b"\0"  # as the SDK hands it out
        path = self.write("lens.mkv", made)
        said = json.loads(self.sgs("info", path, "--json").stdout)
        np.testing.assert_allclose(said["distortion"], lens)

    def test_imu_puts_the_run_upright(self):
        made = self.recording()
        up = self.add_imu(made)
        path = self.write("imu.mkv", made)
        done = self.sgs("run", path, "-o", self.folder / "imu", "--no-eval", "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        said = (self.folder / "imu/upright.toml").read_text()
        self.assertIn('by = "accelerometer', said)
        found = [
            float(line.split()[2])
            for line in said.splitlines()
            if line[:4] in ("x = ", "y = ", "z = ")
        ]
        self.assertGreater(np.dot(found, up), np.cos(np.radians(3)))
        self.assertNotIn("warn", (self.folder / "imu/log.txt").read_text())

    def test_calibration_reads_it(self):
        path = self.write("calibrate.mkv", self.recording())
        done = self.sgs("calibrate", path, "-o", self.folder / "calibrated", "--quiet")
        # Sixteen frames of this scene hold no calibration: that is said of what was read.
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("keyframes show enough contrast", done.stderr)


class Trouble(KinectTest):
    def test_cut_off(self):
        whole = self.recording().bytes()
        known = self.track(self.write("whole.mkv", whole)).splitlines()
        path = self.write("cut.mkv", whole[: 2 * len(whole) // 3])
        self.assertIn("cut off", self.sgs("info", path).stdout)
        part = self.track(path).splitlines()
        self.assertIn("cut off", self.log())
        self.assertGreater(len(part), FRAMES // 2)
        self.assertLess(len(part), FRAMES)
        self.assertEqual(part, known[: len(part)])
        for size in (0, 3, 40, 1000, 2000, 5000):
            text = self.refused(1, self.write("cut.mkv", whole[:size]))
            self.assertIn("cut.mkv", text)
            self.assertRegex(text, "again|empty|record")

    def test_not_finished_by_the_recorder(self):
        """The tag with the device's time is not there yet: the samples tell it."""
        made = self.recording()
        self.add_imu(made)
        known = self.track(self.write("finished.mkv", made))
        made.finished = False
        path = self.write("unfinished.mkv", made)
        self.assertEqual(self.track(path), known)
        self.assertIn("did not finish it", self.log())

    def test_a_part_that_is_damaged(self):
        data = bytearray(self.recording().bytes())
        middle = len(data) // 2
        data[middle : middle + 50_000] = bytes(50_000)
        rows = self.track(self.write("damaged.mkv", bytes(data))).splitlines()
        self.assertGreater(len(rows), FRAMES // 3)

    def test_tracks_that_are_missing(self):
        for track, option in ((kinect.DEPTH, "--depth-mode"), (kinect.COLOR, "--color-mode")):
            made = self.recording()
            del made.tracks[track]
            made.parts = [part for part in made.parts if part[1] != track]
            text = self.refused(1, self.write("one.mkv", made))
            self.assertIn("one.mkv: has no track", text)
            self.assertIn(option, text)

    def test_no_calibration(self):
        made = self.recording()
        made.attachment = None
        path = self.write("none.mkv", made)
        text = self.refused(1, path)
        self.assertIn("none.mkv: has no attachment calibration.json", text)
        self.assertIn("--add-attachment", text)

    def test_calibrations_that_are_none(self):
        whole = json.dumps(self.calibration())
        for spoilt in (
            whole[: len(whole) // 2],
            "{}",
            "[1, 2]",
            whole.replace("D0", "D1"),
            whole.replace('"Rotation"', '"Turn"'),
            whole.replace("BrownConrady", "Theta"),
            whole.replace('"SensorWidth": 4096', '"SensorWidth": 1000'),
        ):
            made = self.recording()
            made.attachment = spoilt.encode()
            done = self.sgs("info", self.write("spoilt.mkv", made))
            self.assertIn(done.returncode, (1, 2), spoilt)
            self.assertIn("spoilt.mkv: calibration.json", done.stderr)
            self.assertRegex(done.stderr, "mkvpropedit|the camera's recorder|modes")

    def test_another_name_of_the_calibration(self):
        made = self.recording()
        made.named_by_tag = "mine.json"
        self.assertEqual(self.sgs("info", self.write("named.mkv", made)).returncode, 0)

    def test_sizes_without_a_mode(self):
        made = self.recording()
        made.tracks[kinect.DEPTH] = kinect.video_track(kinect.DEPTH, b"b16g", (300, 200))
        self.assertIn("300x200", self.refused(1, self.write("size.mkv", made)))

    def test_packings_that_are_not_read(self):
        for track, size in ((kinect.COLOR, COLOR_SIZE), (kinect.DEPTH, DEPTH_SIZE)):
            made = self.recording()
            made.tracks[track] = kinect.video_track(track, b"H264", size)
            text = self.refused(1, self.write("packed.mkv", made))
            self.assertIn(f"track {kinect.NAMES[track]} is packed as 'H264'", text)

    def test_an_ordinary_video(self):
        text = self.refused(1, self.write("video.mkv", kinect.video((64, 48))))
        self.assertIn("video.mkv: a video", text)
        self.assertIn("a video has no depth", text)
        text = self.refused(1, self.write("other.mkv", b"\0\0\0\x18ftyp"))
        self.assertIn("not a Matroska file", text)


if __name__ == "__main__":
    unittest.main()
