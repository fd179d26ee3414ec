# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""One rendered sequence as a TUM folder and as every kind of bag: `sgs run` must not see a difference.

Usage: bags_test.py SGS_EXECUTABLE RIG_RENDERER NODE_FOLDER [unittest arguments]

The bags come from foreign writers (recordings.py); what is not installed is skipped with a reason.
"""
import json
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import orbbec_messages as orbbec
import recordings as rec

SGS = pathlib.Path(sys.argv.pop(1)).resolve()
RIG = pathlib.Path(sys.argv.pop(1)).resolve()
NODE_FOLDER = pathlib.Path(sys.argv.pop(1)).resolve()
FRAMES = 16
COLOR_CAMERA, COLOR_SIZE = (268, 270, 160, 124), (320, 240)
DEPTH_CAMERA, DEPTH_SIZE = (210, 212, 141, 104), (280, 210)


def tum(path):
    return np.loadtxt(path, ndmin=2)


def read_folder(folder):
    """Times in ns, colour and raw depth of a TUM folder."""
    from skimage.io import imread

    frames = []
    lines = [
        [line.split() for line in (folder / name).read_text().splitlines() if line[0] != "#"]
        for name in ("rgb.txt", "depth.txt")
    ]
    for (time, color), (_, depth) in zip(*lines):
        seconds, _, fraction = time.partition(".")
        time_ns = int(seconds) * 10**9 + int((fraction + "0" * 9)[:9])
        frames.append((time_ns, imread(folder / color), imread(folder / depth)))
    return frames


def packed_picture(pixels, kind, **options):
    import io

    from skimage.io import imsave

    data = io.BytesIO()
    imsave(data, pixels, format=kind, check_contrast=False, **options)
    return data.getvalue()


def as_png(pixels):
    return packed_picture(pixels, "png")


def as_inverse_depth(metres, largest_m=10.0, resolution=100.0):
    """What compressed_depth_image_transport makes of floats: 16-bit inverse depths in a PNG."""
    a = resolution * (resolution + 1)
    b = 1 - a / largest_m
    seen = (metres > 0) & (metres < largest_m)
    values = np.where(seen, a / np.where(seen, metres, 1) + b, 0).astype(np.uint16)
    return struct.pack("<iff", 0, a, b) + as_png(values)


class BagTest(unittest.TestCase):
    rig_kind = ()
    depth_camera, depth_size = DEPTH_CAMERA, DEPTH_SIZE

    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="sgs-bags-"))
        subprocess.run(
            [RIG, cls.folder / "rig", str(FRAMES), *cls.rig_kind], check=True, timeout=300
        )
        cls.color_folder = cls.folder / "rig/color"
        cls.frames = read_folder(cls.color_folder)
        cls.depth_frames = read_folder(cls.folder / "rig/depth")
        rig = [float(v) for v in (cls.folder / "rig/rig.txt").read_text().split()]
        cls.rig_t, cls.rig_q = rig[:3], rig[3:]
        cls.node = rec.Node(NODE_FOLDER, cls.folder)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder, ignore_errors=True)

    def sgs(self, *arguments):
        return subprocess.run(
            [str(SGS), *map(str, arguments)],
            capture_output=True,
            text=True,
            cwd=self.folder,
            timeout=300,
        )

    def track(self, source, *arguments):
        """The trajectory of a run."""
        out = self.folder / "run"
        shutil.rmtree(out, ignore_errors=True)
        done = self.sgs(
            *("run", source, "-o", out, "--quiet", "--no-eval"),
            *("--set", "mapper.iterations_per_frame=0"),
            *arguments,
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        return (out / "trajectory.txt").read_text()

    def error_mm(self, trajectory):
        """RMSE against the truth of the colour camera after shifting and turning."""
        poses = np.array([line.split() for line in trajectory.splitlines()], float)[:, 1:4]
        truth = tum(self.color_folder / "groundtruth.txt")[: len(poses), 1:4]
        a, b = poses - poses.mean(axis=0), truth - truth.mean(axis=0)
        u, _, vt = np.linalg.svd(b.T @ a)
        R = u @ np.diag([1, 1, np.linalg.det(u @ vt)]) @ vt
        return 1000 * np.sqrt(((a @ R.T - b) ** 2).sum(axis=1).mean())

    def check_registered(self, trajectory):
        self.assertEqual(len(trajectory.splitlines()), FRAMES)
        aligned, registered = self.error_mm(self.reference()), self.error_mm(trajectory)
        self.assertLess(registered, 1.2 * aligned + 0.2)

    def log(self):
        return (self.folder / "run/log.txt").read_text()

    def reference(self):
        if not hasattr(type(self), "known"):
            type(self).known = self.track(self.color_folder)
            self.assertEqual(len(self.known.splitlines()), FRAMES)
        return self.known

    def refused(self, code, *arguments):
        """What `sgs info` says when it refuses."""
        done = self.sgs("info", *arguments)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stderr

    # Messages of the sequence.

    def info_messages(self, time_ns, depth_frame=rec.COLOR_FRAME):
        info = rec.camera_info(COLOR_CAMERA, COLOR_SIZE, time_ns, rec.COLOR_FRAME)
        return [("/camera/color/camera_info", "sensor_msgs/CameraInfo", info, time_ns)]

    def packed(self, color_format, pack_color, depth_format, pack_depth):
        """Both images as image_transport's plugins pack them."""
        messages = []
        for time_ns, color, depth in self.frames:
            messages += self.info_messages(time_ns)
            for topic, form, data in (
                (rec.COLOR + "/compressed", color_format, pack_color(color)),
                (rec.DEPTH + "/compressedDepth", depth_format, pack_depth(depth)),
            ):
                value = {
                    "header": rec.header(time_ns, rec.COLOR_FRAME),
                    "format": form,
                    "data": data,
                }
                messages.append((topic, "sensor_msgs/CompressedImage", value, time_ns))
        return messages

    def aligned(self, color_encoding="rgb8", depth_encoding="16UC1", stamps=None, padding=0):
        messages = []
        for i, (time_ns, color, depth) in enumerate(self.frames):
            stamp = time_ns if stamps is None else stamps[i]
            messages += self.info_messages(stamp) if i % 4 == 0 else []
            if color_encoding == "bgr8":
                color = color[:, :, ::-1]
            if color_encoding == "bgra8":
                color = np.dstack([color[:, :, ::-1], np.full(color.shape[:2], 9, np.uint8)])
            if depth_encoding == "32FC1":
                depth = np.where(depth == 0, np.nan, depth / 1000.0).astype("<f4")
            c = rec.image(color, color_encoding, stamp, rec.COLOR_FRAME, padding)
            d = rec.image(depth, depth_encoding, stamp, rec.COLOR_FRAME, padding)
            messages.append((rec.COLOR, "sensor_msgs/Image", c, time_ns))
            messages.append((rec.DEPTH, "sensor_msgs/Image", d, time_ns))
        return messages

    def unaligned(self, tf=True):
        """Like realsense-ros: depth in a camera of its own, the frames in /tf_static."""
        start = self.frames[0][0]
        messages = self.info_messages(start)
        info = rec.camera_info(self.depth_camera, self.depth_size, start, rec.DEPTH_FRAME)
        messages.append(("/camera/depth/camera_info", "sensor_msgs/CameraInfo", info, start))
        if tf:
            # Through a body frame, the depth camera's edge turned round.
            body = rec.transform("body", rec.COLOR_FRAME, (0, 0, 0), (0, 0, 0, 1), start)
            rig = rec.transform(rec.COLOR_FRAME, rec.DEPTH_FRAME, self.rig_t, self.rig_q, start)
            message = {"transforms": [body, rig]}
            messages.append(("/tf_static", "tf2_msgs/TFMessage", message, start))
        for (time_ns, color, _), (_, _, depth) in zip(self.frames, self.depth_frames):
            c = rec.image(color, "rgb8", time_ns, rec.COLOR_FRAME)
            d = rec.image(depth, "16UC1", time_ns, rec.DEPTH_FRAME)
            messages.append((rec.COLOR, "sensor_msgs/Image", c, time_ns))
            messages.append((rec.RAW_DEPTH, "sensor_msgs/Image", d, time_ns))
        return messages

    def sdk(self):
        """Like RealSense's SDK: each stream's transform from a common reference, tenths of millimetres."""
        start = self.frames[0][0]
        depth_of, color_of = "/device_0/sensor_0/Depth_0", "/device_0/sensor_1/Color_0"
        inverse_q = (-self.rig_q[0], -self.rig_q[1], -self.rig_q[2], self.rig_q[3])
        messages = []
        for stream, camera, size, t, q in (
            (depth_of, DEPTH_CAMERA, DEPTH_SIZE, (0, 0, 0), (0, 0, 0, 1)),
            (color_of, COLOR_CAMERA, COLOR_SIZE, self.rig_t, self.rig_q),
        ):
            info = rec.camera_info(camera, size, start, "0", "Brown Conrady")
            messages.append((stream + "/info/camera_info", "sensor_msgs/CameraInfo", info, start))
            value = {"translation": rec.vector(t), "rotation": rec.quaternion(q)}
            messages.append((stream + "/tf/0", "geometry_msgs/Transform", value, start))
        self.assertNotEqual(inverse_q[:3], tuple(self.rig_q[:3]))
        unit = {"data": 0.0001}
        topic = "/device_0/sensor_0/option/Depth Units/value"
        messages.append((topic, "std_msgs/Float32", unit, start))
        for (time_ns, color, _), (_, _, depth) in zip(self.frames, self.depth_frames):
            tenths = np.where(depth < 6500, depth * 10, 0).astype("<u2")
            c = rec.image(color, "rgb8", time_ns, "0")
            d = rec.image(tenths, "mono16", time_ns, "0")
            messages.append((color_of + "/image/data", "sensor_msgs/Image", c, time_ns))
            messages.append((depth_of + "/image/data", "sensor_msgs/Image", d, time_ns))
        return messages


class Lossless(BagTest):
    """Every container and every lossless encoding gives the trajectory of the folder, bit for bit."""

    def check(self, path, *arguments):
        self.assertEqual(self.track(path, *arguments), self.reference())

    def test_rosbag_plain(self):
        self.check(rec.write_rosbag(self.folder / "plain.bag", self.aligned()))

    def test_rosbag_bz2(self):
        self.check(rec.write_rosbag(self.folder / "b.bag", self.aligned("bgr8"), "bz2"))

    def test_rosbag_lz4(self):
        messages = self.aligned("bgra8", "32FC1", padding=8)
        self.check(rec.write_rosbag(self.folder / "l.bag", messages, "lz4"))

    def test_rosbag_packed_pictures(self):
        messages = self.packed(
            *("rgb8; png compressed bgr8", as_png),
            *("16UC1; compressedDepth", lambda depth: struct.pack("<iff", 0, 0, 0) + as_png(depth)),
        )
        self.check(rec.write_rosbag(self.folder / "packed.bag", messages))

    def test_lens_of_eight_numbers(self):
        lens = (0.05, -0.02, 0.001, -0.0005, 0.01, 0.03, -0.01, 0.004)
        messages = []
        for topic, kind, value, time_ns in self.aligned():
            if "info" in topic:
                value = dict(value, distortion_model="rational_polynomial", D=list(lens))
            messages.append((topic, kind, value, time_ns))
        path = rec.write_rosbag(self.folder / "lens.bag", messages)
        camera = ",".join(str(v) for v in (*COLOR_CAMERA, *lens))
        of_folder = self.track(self.color_folder, "--camera", camera, "--depth-scale", 1000)
        self.assertEqual(self.track(path), of_folder)
        self.assertNotEqual(of_folder, self.reference())

    def test_mcap_of_ros2(self):
        for compression in ("", "lz4", "zstd"):
            with self.subTest(compression=compression):
                path = self.folder / f"c{compression}.mcap"
                self.node.write_mcap(path, self.aligned(), compression=compression)
                self.check(path)

    def test_mcap_of_ros1(self):
        path = self.folder / "ros1.mcap"
        try:
            self.node.write_mcap(path, self.aligned("bgr8"), cdr=False)
        except ImportError:
            self.skipTest("python3-rosbag is not installed")
        self.check(path)

    def test_db3_and_its_folder_of_several_files(self):
        messages = self.aligned("rgb8", "32FC1")
        packed = self.node.pack_cdr(messages)
        self.check(rec.write_db3(self.folder / "one.db3", messages, packed))
        # As rosbag2 leaves it with a write-ahead log: nothing may appear beside it.
        logged = self.folder / "why 100%?" / "logged #1.db3"
        logged.parent.mkdir()
        rec.write_db3(logged, messages, packed, journal="wal")
        self.check(logged)
        self.assertEqual([path.name for path in logged.parent.iterdir()], [logged.name])
        half = len(messages) // 2
        parts = self.folder / "parts"
        parts.mkdir()
        rec.write_db3(parts / "parts_0.db3", messages[:half], packed[:half])
        rec.write_db3(parts / "parts_1.db3", messages[half:], packed[half:])
        rec.write_metadata(parts, ["parts_0.db3", "parts_1.db3"])
        self.check(parts)

    def test_topic_after_topic(self):
        """The order in the file does not matter, only the stamps do."""
        messages = sorted(self.aligned(), key=lambda message: message[0])
        self.check(rec.write_rosbag(self.folder / "sorted.bag", messages))

    def test_part_of_it(self):
        path = rec.write_rosbag(self.folder / "part.bag", self.aligned())
        self.assertEqual(
            self.track(path, "--frames", "3:9"), self.track(self.color_folder, "--frames", "3:9")
        )

    def test_conversion_to_a_folder(self):
        path = rec.write_rosbag(self.folder / "convert.bag", self.aligned())
        done = self.sgs("convert", path, self.folder / "converted", "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.check(self.folder / "converted")


class Lossy(BagTest):
    """What packing has changed moves no pose by more than a millimetre."""

    def check(self, messages):
        trajectory = self.track(rec.write_rosbag(self.folder / "lossy.bag", messages))
        mine, theirs = (
            np.array([line.split() for line in text.splitlines()], float)
            for text in (trajectory, self.reference())
        )
        self.assertEqual(mine.shape, theirs.shape)
        self.assertNotEqual(trajectory, self.reference())
        self.assertLess(np.linalg.norm(mine[:, 1:4] - theirs[:, 1:4], axis=1).max(), 0.001)

    def test_jpeg_of_colour(self):
        self.check(
            self.packed(
                *("rgb8; jpeg compressed bgr8", lambda c: packed_picture(c, "jpeg", quality=95)),
                *("16UC1; compressedDepth", lambda d: struct.pack("<iff", 0, 0, 0) + as_png(d)),
            )
        )

    def test_compressed_depth_of_floats(self):
        self.check(
            self.packed(
                *("rgb8; png compressed bgr8", as_png),
                *("32FC1; compressedDepth", lambda depth: as_inverse_depth(depth / 1000.0)),
            )
        )


class Unaligned(BagTest):
    def check(self, trajectory):
        self.check_registered(trajectory)

    def test_frames_of_tf(self):
        path = rec.write_rosbag(self.folder / "tf.bag", self.unaligned())
        self.check(self.track(path))

    def test_frames_of_tf_in_mcap(self):
        self.check(self.track(self.node.write_mcap(self.folder / "tf.mcap", self.unaligned())))

    def test_realsense_sdk(self):
        self.check(self.track(rec.write_rosbag(self.folder / "sdk.bag", self.sdk(), "lz4")))

    def test_without_extrinsics_it_is_refused_and_the_option_helps(self):
        path = rec.write_rosbag(self.folder / "no.bag", self.unaligned(tf=False))
        text = self.refused(2, path)
        self.assertIn("--extrinsics", text)
        self.assertIn(rec.RAW_DEPTH, text)
        given = ",".join(str(v) for v in self.rig_t + self.rig_q)
        self.check(self.track(path, "--extrinsics", given))
        for bad in ("1,2,3", "0,0,0,0,0,0,0", "a,0,0,0,0,0,1"):
            self.assertIn("--extrinsics", self.refused(2, path, "--extrinsics", bad))

    def test_extrinsics_that_miss_the_picture(self):
        path = rec.write_rosbag(self.folder / "miss.bag", self.unaligned(tf=False))
        text = self.refused(2, path, "--extrinsics", "900,0,0,0,0,0,1")
        self.assertIn("no depth falls into the colour picture", text)

    def test_aligned_depth_is_preferred(self):
        messages = self.unaligned() + [m for m in self.aligned() if m[0] == rec.DEPTH]
        path = rec.write_rosbag(self.folder / "both.bag", messages)
        self.assertEqual(self.track(path), self.reference())


class OrbbecSdk(BagTest):
    """Recordings of OrbbecSDK v2."""

    def messages(self, unit=(orbbec.UNIT_LEVEL, struct.pack("<i", 3)), per_mm=10, imu=False):
        start = self.frames[0][0]
        x, y, z, w = self.rig_q
        rotation = [
            *(1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
            *(2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
            *(2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
        ]
        nothing = orbbec.transform([0] * 9, [0] * 3)
        rig = orbbec.transform(rotation, self.rig_t)
        messages = [
            orbbec.profile("color", COLOR_CAMERA, COLOR_SIZE, nothing, start),
            orbbec.profile("depth", DEPTH_CAMERA, DEPTH_SIZE, rig, start),
        ]
        if unit:
            messages.append(orbbec.setting(14, struct.pack("<?", True), start))
            messages.append(orbbec.setting(*unit, start))
        for (time_ns, color, _), (_, _, depth) in zip(self.frames, self.depth_frames):
            units = np.where(depth < 65535 // per_mm, depth * per_mm, 0).astype("<u2")
            messages.append(orbbec.image("color", color, "rgb8", time_ns))
            messages.append(orbbec.image("depth", units, "z16", time_ns))
        if imu:
            messages += self.samples(np.reshape(rotation, (3, 3)), start)
        return messages

    def samples(self, R_color_depth, start):
        """Of a unit at rest whose x looks down and whose y looks to the left of the depth camera."""
        R_depth_unit = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
        messages = [
            orbbec.imu_profile(
                "accelerometer", orbbec.transform(R_depth_unit.ravel(), (0.01, 0, 0)), start
            )
        ]
        self.ups = []
        for row in tum(self.color_folder / "groundtruth.txt"):
            x, y, z, w = row[4:]
            up = np.array([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)])
            self.ups.append(up)
            felt = 9.81 * (R_color_depth @ R_depth_unit).T @ up
            time_ns = round(row[0] * 1e9)
            messages.append(orbbec.imu("accelerometer", felt, time_ns))
            messages.append(orbbec.imu("gyroscope", (0.1, 0, 0), time_ns))
        return messages

    def test_it_runs_as_the_folder_of_the_scene(self):
        path = rec.write_rosbag(self.folder / "orbbec.bag", self.messages(), "lz4")
        self.check_registered(self.track(path))
        self.assertNotIn("warn", self.log())

    def test_the_unit_that_was_set(self):
        for name, unit, per_mm in (
            ("level", (orbbec.UNIT_LEVEL, struct.pack("<i", 4)), 5),
            ("flexible", (orbbec.FLEXIBLE_UNIT, struct.pack("<f", 0.25)), 4),
        ):
            path = rec.write_rosbag(self.folder / f"{name}.bag", self.messages(unit, per_mm))
            said = json.loads(self.sgs("info", path, "--json").stdout)
            self.assertEqual(said["depth_scale"], 1000 * per_mm)
            self.assertEqual(said["unit_source"], "/cam/property")
        for unit in None, (orbbec.UNIT_LEVEL, struct.pack("<i", 99)):
            path = rec.write_rosbag(self.folder / "unsaid.bag", self.messages(unit))
            self.assertIn("--depth-scale", self.refused(1, path))
            self.check_registered(self.track(path, "--depth-scale", 10000))
        unit = (orbbec.FLEXIBLE_UNIT, struct.pack("<f", float("nan")))
        path = rec.write_rosbag(self.folder / "none.bag", self.messages(unit))
        self.assertIn("a depth unit of nan mm", self.refused(1, path))

    def test_its_accelerometer_puts_the_run_upright(self):
        path = rec.write_rosbag(self.folder / "orbbec_imu.bag", self.messages(imu=True))
        done = self.sgs("run", path, "-o", self.folder / "imu", "--no-eval", "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        said = (self.folder / "imu/upright.toml").read_text()
        self.assertIn('by = "accelerometer', said)
        up = [
            float(line.split()[2])
            for line in said.splitlines()
            if line[:4] in ("x = ", "y = ", "z = ")
        ]
        self.assertGreater(np.dot(up, self.ups[0]), np.cos(np.radians(3)))
        self.assertNotIn("warn", (self.folder / "imu/log.txt").read_text())


class Info(BagTest):
    def test_topics_rates_encodings_calibration(self):
        path = rec.write_rosbag(self.folder / "info.bag", self.aligned())
        said = json.loads(self.sgs("info", path, "--json").stdout)
        self.assertEqual(said["layout"], "ROS 1 bag")
        self.assertEqual(said["frames"], FRAMES)
        self.assertEqual((said["color_topic"], said["depth_topic"]), (rec.COLOR, rec.DEPTH))
        self.assertEqual((said["fx"], said["cy"]), (268, 124))
        self.assertIn("/camera/color/camera_info", said["calibration_source"])
        topics = {topic["topic"]: topic for topic in said["topics"]}
        self.assertEqual(topics[rec.COLOR]["messages"], FRAMES)
        self.assertAlmostEqual(topics[rec.COLOR]["rate_hz"], 32, delta=0.5)
        self.assertEqual(topics[rec.DEPTH]["encoding"], "16UC1")
        text = self.sgs("info", path).stdout
        self.assertRegex(text, rec.COLOR + ".*<- colour")

    def test_truth(self):
        truth = tum(self.color_folder / "groundtruth.txt")
        messages = self.aligned()
        for row in truth:
            time_ns = round(row[0] * 1e9)
            stamped = {"header": rec.header(time_ns, "world"), "pose": rec.pose(row[1:4], row[4:])}
            messages.append(("/vrpn/pose", "geometry_msgs/PoseStamped", stamped, time_ns))
            edge = rec.transform("world", "body", row[1:4], row[4:], time_ns)
            messages.append(("/tf", "tf2_msgs/TFMessage", {"transforms": [edge]}, time_ns))
            odometry = {
                "header": rec.header(time_ns, "world"),
                "child_frame_id": "body",
                "pose": {"pose": rec.pose(row[1:4], row[4:])},
            }
            messages.append(("/odom_groundtruth", "nav_msgs/Odometry", odometry, time_ns))
        same = rec.transform("body", rec.COLOR_FRAME, (0, 0, 0), (0, 0, 0, 1), self.frames[0][0])
        tf = {"transforms": [same]}
        messages.append(("/tf_static", "tf2_msgs/TFMessage", tf, self.frames[0][0]))
        self.check_truth(rec.write_rosbag(self.folder / "truth.bag", messages), truth)
        self.check_truth(self.node.write_mcap(self.folder / "truth.mcap", messages), truth)

    def test_imu_puts_the_run_upright(self):
        axes = np.array([[0, -1, 0], [0, 0, -1], [1, 0, 0]])  # x forward, y left, z up
        messages = self.aligned()
        ups = []
        for row in tum(self.color_folder / "groundtruth.txt"):
            x, y, z, w = row[4:]
            up = np.array([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)])
            ups.append(up)
            time_ns = round(row[0] * 1e9)
            imu = {
                "header": rec.header(time_ns, "imu"),
                "linear_acceleration": rec.vector(9.81 * axes.T @ up),
            }
            messages.append(("/imu", "sensor_msgs/Imu", imu, time_ns))
        mounted = rec.transform(
            rec.COLOR_FRAME, "imu", (0, 0, 0), (0.5, -0.5, 0.5, 0.5), self.frames[0][0]
        )
        tf = {"transforms": [mounted]}
        messages.append(("/tf_static", "tf2_msgs/TFMessage", tf, self.frames[0][0]))
        path = rec.write_rosbag(self.folder / "imu.bag", messages)
        done = self.sgs("run", path, "-o", self.folder / "imu", "--no-eval", "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        said = (self.folder / "imu/upright.toml").read_text()
        self.assertIn('by = "accelerometer', said)
        up = [
            float(line.split()[2])
            for line in said.splitlines()
            if line[:4] in ("x = ", "y = ", "z = ")
        ]
        self.assertGreater(np.dot(up, ups[0]), np.cos(np.radians(3)))
        self.assertNotIn("warn", (self.folder / "imu/log.txt").read_text())

    def check_truth(self, path, truth):
        for option in (
            [],
            ["--truth-topic", "/vrpn/pose"],
            ["--truth-topic", "/odom_groundtruth"],
            ["--truth-topic", "world:" + rec.COLOR_FRAME],
        ):
            with self.subTest(path=path.name, option=option):
                done = self.sgs("convert", path, self.folder / "truth", "--quiet", *option)
                self.assertEqual(done.returncode, 0, done.stderr)
                got = tum(self.folder / "truth/groundtruth.txt")
                np.testing.assert_allclose(got[:, 0], truth[:, 0], atol=1e-6)
                np.testing.assert_allclose(got[:, 1:4], truth[:, 1:4], atol=1e-6)
                shutil.rmtree(self.folder / "truth")
        self.assertIn("/vrpn/pose", self.refused(2, path, "--truth-topic", "/nothing"))
        self.assertIn("world", self.refused(2, path, "--truth-topic", "world:mars"))

    def test_a_large_bag_is_described_from_its_index(self):
        """A hole of the file system in the middle: whoever reads all of it needs far longer, and whoever
        holds it in memory does not fit."""
        path = rec.write_rosbag(self.folder / "large.bag", self.aligned())
        small = path.read_bytes()
        gap = 12 << 30
        index_at = struct.unpack_from("<Q", small, small.index(b"index_pos=") + 10)[0]
        with open(path, "r+b") as file:
            file.seek(index_at)
            # A chunk record that no index names, around the hole.
            fields = b"".join(
                struct.pack("<I", len(f)) + f
                for f in (b"op=\x05", b"compression=none", b"size=\0\0\0\0")
            )
            at = index_at
            while gap > 0:
                size = min(gap, (1 << 32) - 1)
                file.seek(at)
                file.write(struct.pack("<I", len(fields)) + fields + struct.pack("<I", size))
                at += 8 + len(fields) + size
                gap -= size
            file.seek(at)
            file.write(small[index_at:])
            file.seek(small.index(b"index_pos=") + 10)
            file.write(struct.pack("<Q", at))
        self.check_large(path)

    def check_large(self, path, frames=FRAMES):
        done = subprocess.run(
            ["bash", "-c", f"ulimit -v 4000000; exec {SGS} info {path} --json"],
            capture_output=True,
            text=True,
            timeout=60,
        )
        path.unlink()
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(json.loads(done.stdout)["frames"], frames)

    def test_a_large_mcap_is_described_from_its_summary_or_by_walking(self):
        path = self.node.write_mcap(self.folder / "large.mcap", self.aligned())
        small, gap = path.read_bytes(), 12 << 30
        data_end = small.rindex(b"\x0f" + struct.pack("<Q", 4))
        footer = len(small) - 8 - 20
        summary, offsets, _ = struct.unpack_from("<QQI", small, footer)
        shift = 9 + gap
        moved = struct.pack("<QQI", summary + shift, offsets + shift if offsets else 0, 0)
        for cut in False, True:
            with open(path, "wb") as file:
                # A record of a private kind, which readers pass over, around the hole.
                file.write(small[:data_end] + b"\x90" + struct.pack("<Q", gap))
                file.seek(gap, 1)
                file.write(small[data_end:footer] + moved + small[-8:])
                if cut:
                    file.truncate(data_end + shift)
            self.check_large(path, None if cut else FRAMES)


class BadInput(BagTest):
    def test_several_colour_topics(self):
        second = [("/other" + m[0], *m[1:]) for m in self.aligned() if m[0] == rec.COLOR]
        path = rec.write_rosbag(self.folder / "two.bag", self.aligned() + second)
        text = self.refused(2, path)
        self.assertIn("--topics", text)
        self.assertIn("/other" + rec.COLOR, text)
        self.assertIn(rec.COLOR, self.sgs("info", path).stdout)  # the list comes all the same
        topics = f"color={rec.COLOR}"
        self.assertEqual(self.track(path, "--topics", topics), self.reference())
        for bad in ("color=/nothing", "colour=/x", "color", "color="):
            self.assertIn("--topics", self.refused(2, path, "--topics", bad))

    def test_no_depth_topic(self):
        messages = [m for m in self.aligned() if m[0] != rec.DEPTH]
        text = self.refused(2, rec.write_rosbag(self.folder / "nodepth.bag", messages))
        self.assertIn("no depth topic", text)

    def test_no_camera_info(self):
        messages = [m for m in self.aligned() if "info" not in m[0]]
        path = rec.write_rosbag(self.folder / "noinfo.bag", messages)
        self.assertIn("--camera", self.refused(1, path))
        given = ",".join(map(str, COLOR_CAMERA))
        self.assertEqual(self.track(path, "--camera", given), self.reference())

    def test_unknown_unit(self):
        messages = []
        for topic, kind, value, time_ns in self.aligned():
            if topic == rec.DEPTH:
                raw = np.frombuffer(value["data"], "<u2")
                value = dict(value, data=(raw // 64).astype("<u2").tobytes())
            messages.append((topic, kind, value, time_ns))
        path = rec.write_rosbag(self.folder / "unit.bag", messages)
        self.assertIn("--depth-scale", self.refused(2, path))
        self.assertEqual(self.sgs("info", path, "--depth-scale", "15.625").returncode, 0)

    def test_colour_and_depth_that_never_meet(self):
        messages = []
        for topic, kind, value, time_ns in self.aligned():
            if topic == rec.DEPTH:
                stamp = time_ns + 500 * 10**9
                value = dict(value, header=rec.header(stamp, rec.COLOR_FRAME))
            messages.append((topic, kind, value, time_ns))
        text = self.refused(1, rec.write_rosbag(self.folder / "apart.bag", messages))
        self.assertIn("of each other", text)
        self.assertIn("clocks", text)

    def test_stamps_all_zero(self):
        path = rec.write_rosbag(self.folder / "zero.bag", self.aligned(stamps=[0] * FRAMES))
        self.assertIn("no time stamps", self.sgs("info", path).stdout)
        self.assertEqual(self.track(path), self.reference())

    def test_stamps_running_backwards(self):
        stamps = [frame[0] for frame in self.frames]
        stamps[10:] = [stamp - 3 * 10**9 for stamp in stamps[10:]]
        path = rec.write_rosbag(self.folder / "back.bag", self.aligned(stamps=stamps))
        rows = self.track(path).splitlines()
        self.assertEqual(len(rows), FRAMES)
        self.assertEqual(rows[:10], self.reference().splitlines()[:10])
        times = np.array([float(row.split()[0]) for row in rows])
        self.assertTrue((np.diff(times) > 0).all())
        self.assertRegex(self.log(), r"set back by [23]\.")

    def test_no_measurement(self):
        """65535, NaN and infinity are no depth: as in a folder with zeros there."""
        plain, spoilt = [], []
        for encoding, nothing in (("16UC1", 65535), ("32FC1", np.inf)):
            messages = []
            for topic, kind, value, time_ns in self.aligned("rgb8", encoding):
                if topic == rec.DEPTH:
                    kind_of = "<u2" if encoding == "16UC1" else "<f4"
                    raw = np.frombuffer(value["data"], kind_of).copy()
                    raw[5::7] = nothing
                    value = dict(value, data=raw.tobytes())
                messages.append((topic, kind, value, time_ns))
            spoilt.append(self.track(rec.write_rosbag(self.folder / "nan.bag", messages)))
            plain.append(messages)
        self.assertEqual(spoilt[0], spoilt[1])
        self.assertNotEqual(spoilt[0], self.reference())

    def test_truncated(self):
        whole = rec.write_rosbag(self.folder / "whole.bag", self.aligned(), "lz4").read_bytes()
        path = self.folder / "cut.bag"
        path.write_bytes(whole[: len(whole) // 2])
        said = self.sgs("info", path)
        self.assertEqual(said.returncode, 0, said.stderr)
        self.assertIn("cut off", said.stdout)
        half = self.track(path).splitlines()
        self.assertGreater(len(half), 4)
        self.assertEqual(half, self.reference().splitlines()[: len(half)])
        for size in (0, 5, 13, 100, 4096):
            path.write_bytes(whole[:size])
            self.assertEqual(self.sgs("info", path).returncode in (1, 2), True, size)

    def test_truncated_mcap_and_db3(self):
        messages = self.aligned()
        whole = self.node.write_mcap(self.folder / "whole.mcap", messages, compression="zstd")
        data = whole.read_bytes()
        path = self.folder / "cut.mcap"
        path.write_bytes(data[: 2 * len(data) // 3])
        half = self.track(path).splitlines()
        self.assertGreater(len(half), 4)
        self.assertEqual(half, self.reference().splitlines()[: len(half)])
        database = rec.write_db3(self.folder / "whole.db3", messages, self.node.pack_cdr(messages))
        cut = self.folder / "cut.db3"
        cut.write_bytes(database.read_bytes()[: database.stat().st_size // 2])
        self.assertIn(
            self.sgs("info", cut).returncode, (0, 1)
        )  # says what it is, and does not crash

    def test_unindexed(self):
        path = rec.write_rosbag(self.folder / "unindexed.bag", self.aligned(), "bz2")
        data = bytearray(path.read_bytes())
        at = data.index(b"index_pos=") + 10
        index = struct.unpack_from("<Q", data, at)[0]
        data[at : at + 8] = bytes(8)
        path.write_bytes(data[:index])
        said = self.sgs("info", path).stdout
        self.assertIn("no index", said)
        self.assertIn("not known before it is read", said)
        self.assertEqual(self.track(path), self.reference())

    def test_encrypted(self):
        path = rec.write_rosbag(self.folder / "secret.bag", self.aligned()[:3])
        data = path.read_bytes()
        length = struct.unpack_from("<I", data, 13)[0]
        field = b"encryptor=rosbag/AesCbcEncryptor"
        fields = data[17 : 17 + length] + struct.pack("<I", len(field)) + field
        path.write_bytes(data[:13] + struct.pack("<I", len(fields)) + fields + data[17 + length :])
        text = self.refused(1, path)
        self.assertIn("AesCbcEncryptor", text)
        self.assertIn("decrypt", text)

    def test_lengths_that_lie(self):
        """Every length in turn is made enormous: a reason, and no memory on its word."""
        path = rec.write_rosbag(self.folder / "lies.bag", self.aligned()[:8], "lz4")
        whole = path.read_bytes()
        places = [13, whole.index(b"size=") + 5, whole.index(b"op=\x05") - 4]
        places += [i - 4 for i in range(len(whole)) if whole.startswith(b"conn=", i)][:6]
        for place in places:
            data = bytearray(whole)
            data[place : place + 4] = b"\xf0\xff\xff\xff"
            path.write_bytes(data)
            done = subprocess.run(
                ["bash", "-c", f"ulimit -v 4000000; exec {SGS} info {path}"],
                capture_output=True,
                text=True,
                timeout=60,
            )
            self.assertIn(done.returncode, (0, 1, 2), f"{place}: {done.stderr}")

    def test_damaged_chunk(self):
        """One chunk is lost, the rest is read."""
        path = rec.write_rosbag(self.folder / "damaged.bag", self.aligned(), "lz4")
        data = bytearray(path.read_bytes())
        chunks = [i for i in range(len(data)) if data.startswith(b"compression=lz4", i)]
        middle = chunks[len(chunks) // 2] + 100
        data[middle : middle + 64] = bytes(64)
        path.write_bytes(data)
        trajectory = self.track(path).splitlines()
        self.assertGreater(len(trajectory), FRAMES // 2)
        self.assertLess(len(trajectory), FRAMES)
        self.assertIn("lz4 chunk is damaged", self.log())

    def test_folder_of_rosbag2(self):
        folder = self.folder / "ros2"
        folder.mkdir()
        rec.write_metadata(folder, ["a_0.db3"])
        self.assertIn("a_0.db3", self.refused(1, folder))
        (folder / "a_0.db3.zstd").write_bytes(b"x")
        rec.write_metadata(folder, ["a_0.db3.zstd"], mode="FILE")
        self.assertIn("zstd -d", self.refused(1, folder))
        (folder / "metadata.yaml").write_text("rosbag2_bagfile_information: [")
        self.assertIn("reindex", self.refused(1, folder))

    def test_something_else(self):
        for name in ("not.bag", "not.mcap", "not.db3"):
            path = self.folder / name
            path.write_bytes(b"#ROSBAG V1.2\n" if name == "not.bag" else b"hello" * 100)
            self.assertIn(name, self.refused(1, path))
        self.assertIn("gone.bag", self.refused(1, self.folder / "gone.bag"))


class Export(BagTest):
    """What `sgs export RUN bag|mcap` writes, read back by foreign readers."""

    def setUp(self):
        self.run_folder = self.folder / "exported"
        if not self.run_folder.exists():
            done = self.sgs("run", self.color_folder, "-o", self.run_folder, "--quiet", "--no-eval")
            self.assertEqual(done.returncode, 0, done.stderr)
        self.poses = tum(self.run_folder / "trajectory.txt")
        self.points = self.folder / "points.ply"
        self.sgs("export", self.run_folder, "points", self.points)

    def export(self, kind):
        path = self.folder / f"out.{kind}"
        done = self.sgs("export", self.run_folder, kind, path)
        self.assertEqual(done.returncode, 0, done.stderr)
        return path

    def expected_points(self):
        data = self.points.read_bytes()
        body = data.index(b"end_header\n") + len(b"end_header\n")
        kind = [("xyz", "<f4", 3), ("rgb", "u1", 3)]
        return np.frombuffer(data[body:], np.dtype(kind))

    def assert_pose(self, position, orientation, row, stamp_ns):
        self.assertAlmostEqual(stamp_ns * 1e-9, row[0], places=6)
        np.testing.assert_allclose(position, row[1:4], atol=1e-9)
        self.assertAlmostEqual(abs(np.dot(orientation, row[4:8])), 1, places=8)

    def assert_cloud(self, data, width, step, fields):
        self.assertEqual(fields, [("x", 0), ("y", 4), ("z", 8), ("rgb", 12)])
        expected = self.expected_points()
        self.assertEqual((width, step, len(data)), (len(expected), 16, 16 * len(expected)))
        cloud = np.frombuffer(data, np.dtype([("xyz", "<f4", 3), ("bgr0", "u1", 4)]))
        np.testing.assert_array_equal(cloud["xyz"], expected["xyz"])
        np.testing.assert_array_equal(cloud["bgr0"][:, 2::-1], expected["rgb"])

    def test_rosbag_reads_it(self):
        try:
            import geometry_msgs.msg
            import nav_msgs.msg
            import rosbag
            import sensor_msgs.msg
            import tf2_msgs.msg
        except ImportError:
            self.skipTest("python3-rosbag is not installed")
        types = {
            "/tf": tf2_msgs.msg.TFMessage,
            "/pose": geometry_msgs.msg.PoseStamped,
            "/path": nav_msgs.msg.Path,
            "/map": sensor_msgs.msg.PointCloud2,
        }
        with rosbag.Bag(str(self.export("bag"))) as bag:
            about = bag.get_type_and_topic_info()
            self.assertEqual(set(about.topics), set(types))
            for topic, kind in types.items():
                known = about.topics[topic]
                self.assertEqual(known.msg_type, kind._type)
                self.assertEqual(about.msg_types[kind._type], kind._md5sum)
            self.assertEqual(about.topics["/pose"].message_count, FRAMES)
            seen = {topic: [] for topic in types}
            for topic, message, time in bag.read_messages():
                seen[topic].append((message, time.to_nsec()))
        for (pose, time_ns), (tf, _), row in zip(seen["/pose"], seen["/tf"], self.poses):
            stamp = pose.header.stamp.to_nsec()
            self.assertEqual(stamp, time_ns)
            p, q = pose.pose.position, pose.pose.orientation
            self.assert_pose((p.x, p.y, p.z), (q.x, q.y, q.z, q.w), row, stamp)
            world, camera = tf.transforms
            self.assertEqual((world.header.frame_id, world.child_frame_id), ("world", "map"))
            self.assertEqual((camera.header.frame_id, camera.child_frame_id), ("map", "camera"))
            self.assertEqual(camera.transform.translation.x, p.x)
        ((path, _),) = seen["/path"]
        self.assertEqual(len(path.poses), FRAMES)
        self.assertEqual(path.poses[3].pose.position.x, seen["/pose"][3][0].pose.position.x)
        ((cloud, _),) = seen["/map"]
        fields = [(f.name, f.offset) for f in cloud.fields]
        self.assert_cloud(bytes(cloud.data), cloud.width, cloud.point_step, fields)

    def test_mcap_core_reads_it(self):
        import base64

        read = self.node.read_mcap(self.export("mcap"))
        self.assertEqual(read["profile"], "ros2")
        self.assertEqual(read["counts"], {"/tf": FRAMES, "/pose": FRAMES, "/path": 1, "/map": 1})
        seen = {}
        for message in read["messages"]:
            seen.setdefault(message["topic"], []).append(message)
        self.assertEqual(seen["/pose"][0]["type"], "geometry_msgs/msg/PoseStamped")
        for message, row in zip(seen["/pose"], self.poses):
            pose = message["value"]["pose"]
            p = [pose["position"][k] for k in "xyz"]
            q = [pose["orientation"][k] for k in "xyzw"]
            self.assert_pose(p, q, row, int(message["time_ns"]))
        self.assertEqual(len(seen["/path"][0]["value"]["poses"]), FRAMES)
        self.assertEqual(seen["/tf"][0]["value"]["transforms"][1]["child_frame_id"], "camera")
        cloud = seen["/map"][0]["value"]
        fields = [(f["name"], f["offset"]) for f in cloud["fields"]]
        data = base64.b64decode(cloud["data"])
        self.assert_cloud(data, cloud["width"], cloud["point_step"], fields)

    def test_what_cannot_be_exported(self):
        done = self.sgs("export", self.points, "bag", self.folder / "x.bag")
        self.assertNotEqual(done.returncode, 0)
        self.assertFalse((self.folder / "x.bag").exists())


if __name__ == "__main__":
    unittest.main()
