# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""`sgs run camera:ros1` and `--ros1` against a node of Debian's rospy, with its master.

Usage: ros1_test.py SGS RENDER_RIG FOLDER [unittest arguments]. This process is the foreign node. Exit
code 77: ROS 1 is not installed.
"""
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest

try:
    import rosmaster  # noqa: F401
    import rospy
    from geometry_msgs.msg import TransformStamped
    from nav_msgs.msg import OccupancyGrid, Odometry, Path
    from sensor_msgs.msg import CameraInfo, CompressedImage, Image, Imu, PointCloud2
    from tf2_msgs.msg import TFMessage
except ImportError as error:
    print(f"skipped: ROS 1 is not installed: {error}")
    sys.exit(77)
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "cameras"), str(HERE.parent / "ros2")]
import ros2_test  # noqa: E402
from fake_cameras import FRAMES, SGS, TIMEOUT, TRACK, CameraTest, parts_of, rows  # noqa: E402

OPTICAL = "camera_color_optical_frame"


def setUpModule():
    """A master on a port of its own, and this process as a node."""
    global master, scratch
    scratch = tempfile.mkdtemp(prefix="sgs-ros1-")
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    os.environ["ROS_MASTER_URI"] = f"http://127.0.0.1:{port}"
    os.environ["ROS_IP"] = "127.0.0.1"
    os.environ["ROS_HOME"] = scratch
    command = ["/usr/bin/rosmaster", "--core", "-p", str(port)]
    quiet = subprocess.DEVNULL
    master = subprocess.Popen(command, stdin=quiet, stdout=quiet, stderr=quiet)
    until = time.monotonic() + TIMEOUT
    while True:
        try:
            socket.create_connection(("127.0.0.1", port)).close()
            break
        except OSError:
            assert master.poll() is None and time.monotonic() < until, "no master"
            time.sleep(0.05)
    rospy.init_node("foreign", disable_signals=True, disable_rosout=True)


def tearDownModule():
    master.terminate()
    master.wait()
    shutil.rmtree(scratch, ignore_errors=True)


def stamp(seconds):
    nanoseconds = round(seconds * 1e9)
    return rospy.Time(nanoseconds // 10**9, nanoseconds % 10**9)


def happens(condition):
    until = time.monotonic() + TIMEOUT
    while not condition():
        assert time.monotonic() < until, "it never happens"
        time.sleep(0.01)


class Ros1Test(CameraTest):
    family = "ros1"
    count = 0

    def setUp(self):
        super().setUp()
        self.environment.update({k: os.environ[k] for k in os.environ if k.startswith("ROS_")})
        Ros1Test.count += 1
        self.name = f"/camera{Ros1Test.count}"  # topics of other tests may still be about
        self.publishers = {}
        self.advertise()

    def topics(self, name=None):
        name = name or self.name
        depth = f"{name}/aligned_depth_to_color/image_raw"
        return f"{name}/color/image_raw", depth, f"{name}/color/camera_info"

    def publisher(self, topic, kind, latch=False):
        """One that waits for those who listen: nothing of it is lost."""
        self.publishers[topic] = rospy.Publisher(topic, kind, latch=latch, queue_size=None)
        self.addCleanup(self.withdraw, topic)
        return self.publishers[topic]

    def withdraw(self, topic):
        publisher = self.publishers.pop(topic, None)
        if publisher:
            publisher.unregister()

    def advertise(self, name=None):
        for topic, kind in zip(self.topics(name), (Image, Image, CameraInfo)):
            self.publisher(topic, kind)

    def wait_for_readers(self, topics=None):
        happens(
            lambda: all(
                self.publishers[topic].get_num_connections() > 0
                for topic in topics or self.topics()
            )
        )

    def info(self, camera=None, t=0, frame=OPTICAL, **changes):
        camera = camera or self.color
        message = CameraInfo(width=camera.width, height=camera.height)
        message.header.stamp, message.header.frame_id = stamp(t), frame
        message.distortion_model, message.D = "plumb_bob", [0] * 5
        message.K = [camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1]
        message.P = [camera.fx, 0, camera.cx, 0, 0, camera.fy, camera.cy, 0, 0, 0, 1, 0]
        for key, value in changes.items():
            setattr(message, key, value)
        return message

    def image(self, t, array, encoding, frame=OPTICAL, **changes):
        message = Image(height=array.shape[0], width=array.shape[1], encoding=encoding)
        message.header.stamp, message.header.frame_id = stamp(t), frame
        message.step, message.data = array.strides[0], array.tobytes()
        for key, value in changes.items():
            setattr(message, key, value)
        return message

    def color_image(self, k, t=None):
        return self.image(t or self.color.times[k], self.color.colors[k], "rgb8")

    def depth_image(self, k, t=None):
        raw = self.color.depths[k].astype("<u2")
        return self.image(t or self.color.times[k], raw, "16UC1")

    def play(self, frames=range(FRAMES), shift_s=0):
        """As a driver does: pictures with a camera info each, when somebody is there to see."""
        self.wait_for_readers()
        color, depth, info = (self.publishers[topic] for topic in self.topics())
        for k in frames:
            t = self.color.times[k] + shift_s
            info.publish(self.info(t=t))
            color.publish(self.color_image(k, t))
            depth.publish(self.depth_image(k, t))

    def playing(self, *arguments):
        threading.Thread(target=self.play, args=arguments, daemon=True).start()

    def camera(self, options=f"every=on,frames={FRAMES}"):
        return f"camera:ros1:{self.name}" + (f",{options}" if options else "")

    def sent_while(self, play, *options, code=0):
        """What the program sends by itself while somebody plays, and says."""
        threading.Thread(target=play, daemon=True).start()
        program = SGS.parent / "sgs-camera-ros1"
        stream, said = self.sent_by(program, f"--serial={self.name}", *options, code=code)
        return said if code else (*parts_of(b"SGS2" + stream[4:]), said)

    def publish(self, **messages):
        """A function that publishes messages by their topics, when all of them are read."""
        topics = dict(zip(("color", "depth", "info"), self.topics()))
        named = {topics.get(key, key): value for key, value in messages.items()}
        # Anew: readers that have ended are only noticed when something is sent to them.
        for topic in named:
            kind = self.publishers[topic].data_class
            self.withdraw(topic)
            self.publisher(topic, kind)

        def play():
            self.wait_for_readers(named)
            for topic, message in named.items():
                self.publishers[topic].publish(message)

        return play


class Input(Ros1Test):
    def test_the_same_scene_from_a_file(self):
        self.playing()
        self.run_camera("--no-eval", "--quiet")
        self.assertEqual(self.tracked(), FRAMES)
        self.assert_same_run(self.color.folder)

    def test_depth_that_is_not_registered(self):
        values = self.play_unregistered()
        color, _, info = self.topics()
        depth, depth_info = f"{self.name}/depth/image_raw", f"{self.name}/depth/camera_info"
        for topic in self.topics()[1:2]:
            self.withdraw(topic)
        self.publisher(depth, Image)
        self.publisher(depth_info, CameraInfo)
        static = self.publisher("/tf_static", TFMessage, latch=True)
        one = TransformStamped(child_frame_id="eye_of_depth")
        one.header.frame_id = OPTICAL
        t, q = one.transform.translation, one.transform.rotation
        t.x, t.y, t.z, q.x, q.y, q.z, q.w = values
        static.publish([one])

        def play():
            self.wait_for_readers((color, depth, info, depth_info))
            for k, t in enumerate(self.color.times):
                raw = self.depth.depths[k].astype("<u2")
                self.publishers[info].publish(self.info(t=t))
                self.publishers[depth_info].publish(self.info(self.depth, t, "eye_of_depth"))
                self.publishers[color].publish(self.color_image(k))
                self.publishers[depth].publish(self.image(t, raw, "16UC1", "eye_of_depth"))

        greeting, frames, _, _ = self.sent_while(play, f"--frames={FRAMES}")
        np.testing.assert_allclose(greeting["color_from_depth"], values, atol=1e-9)
        self.assertEqual([frame["t"] for frame in frames], self.color.times)
        threading.Thread(target=play, daemon=True).start()
        self.run_camera("--no-eval", "--quiet")
        self.assert_same_run(self.sent_by_version_1(greeting["color_from_depth"]))

    def test_encodings(self):
        rgb, raw = self.color.colors[0], self.color.depths[0].astype("<u2")
        alpha = np.full((*raw.shape, 1), 7, np.uint8)
        grey = np.ascontiguousarray(rgb[:, :, 1])
        metres = raw * np.float32(0.001)
        wide = np.zeros((raw.shape[0], raw.shape[1] + 5), "<u2")
        wide[:, : raw.shape[1]] = raw
        colors = {
            "rgb8": (rgb, rgb),
            "bgr8": (rgb[:, :, ::-1], rgb),
            "rgba8": (np.concatenate([rgb, alpha], 2), rgb),
            "bgra8": (np.concatenate([rgb[:, :, ::-1], alpha], 2), rgb),
            "mono8": (grey, np.repeat(grey[:, :, None], 3, axis=2)),
        }
        depths = [
            (self.image(1, raw, "16UC1"), "u16", raw),
            (self.image(1, metres, "32FC1"), "f32", metres),
            (self.image(1, raw.astype(">u2"), "16UC1", is_bigendian=1), "u16", raw),
            (self.image(1, wide, "16UC1", width=raw.shape[1]), "u16", raw),
            (self.image(1, raw, "mono16"), "u16", raw),
        ]
        for (encoding, (sent, expected)), (depth, kind, numbers) in zip(colors.items(), depths):
            color = self.image(1, np.ascontiguousarray(sent), encoding)
            play = self.publish(info=self.info(), color=color, depth=depth)
            greeting, frames, _, _ = self.sent_while(play, "--frames=1")
            self.assertEqual(frames[0]["color"], expected.tobytes(), encoding)
            self.assertEqual((greeting["depth"], frames[0]["depth"]), (kind, numbers.tobytes()))

    def test_packed_images(self):
        color, depth = f"{self.topics()[0]}/compressed", f"{self.topics()[1]}/compressedDepth"
        self.publisher(color, CompressedImage)
        self.publisher(depth, CompressedImage)
        png = lambda name: (self.color.folder / rows(self.color.folder / name)[0][1]).read_bytes()
        packed = lambda form, data: CompressedImage(format=form, data=data)
        messages = {
            color: packed("rgb8; png compressed", png("rgb.txt")),
            depth: packed("16UC1; compressedDepth png", b"\0" * 12 + png("depth.txt")),
        }
        play = self.publish(info=self.info(), **messages)
        options = f"--color={color}", f"--depth={depth}", "--frames=1"
        greeting, frames, _, _ = self.sent_while(play, *options)
        self.assertEqual((greeting["color"], greeting["depth"]), ("png", "png16"))
        self.assertEqual(frames[0]["color"], png("rgb.txt"))
        self.assertEqual(frames[0]["depth"], png("depth.txt"))

    def test_lenses(self):
        image = dict(color=self.color_image(0), depth=self.depth_image(0))
        eight = [0.1, -0.2, 0.01, 0.02, 0.3, 0.1, 0.2, 0.3]
        for model, D, kind in (
            ("plumb_bob", eight[:5], "brown"),
            ("rational_polynomial", eight, "brown"),
            ("equidistant", eight[:4], "fisheye"),
        ):
            info = self.info(distortion_model=model, D=D)
            greeting = self.sent_while(self.publish(info=info, **image), "--frames=1")[0]
            self.assertEqual(greeting["camera"]["distortion"], D)
            self.assertEqual(greeting["camera"].get("lens", "brown"), kind)
        for info, words in (
            (self.info(distortion_model="other", D=[1]), "'other' with 1 coefficients"),
            (self.info(K=[0] * 9, P=[0] * 12), "is not filled in"),
            (self.info(width=7), "is for images of 7x"),
        ):
            said = self.sent_while(self.publish(info=info, **image), "--frames=1", code=1)
            self.assertIn(words, said)

    def test_inertial_samples(self):
        imu, static = f"{self.name}/imu", self.publisher("/tf_static", TFMessage, latch=True)
        self.publisher(imu, Imu)
        one = TransformStamped(child_frame_id="unit")
        one.header.frame_id = OPTICAL
        one.transform.translation.x, one.transform.rotation.z = 0.01, 0.5**0.5
        one.transform.rotation.w = 0.5**0.5
        static.publish([one])

        def sample(t, turned):
            message = Imu()
            message.header.stamp, message.header.frame_id = stamp(t), "unit"
            message.linear_acceleration.y = -9.81
            message.angular_velocity_covariance[0] = 0 if turned else -1
            return message

        def play():
            self.wait_for_readers((*self.topics(), imu))
            for k, t in enumerate(self.color.times):
                self.publishers[imu].publish(sample(t, True))
                self.publishers[imu].publish(sample(t + 0.01, False))
                self.play(range(k, k + 1))

        greeting, _, samples, _ = self.sent_while(play, f"--frames={FRAMES}")
        pose = [0.01, 0, 0, 0, 0, 0.5**0.5, 0.5**0.5]
        np.testing.assert_allclose(greeting["imu"]["color_from_imu"], pose, atol=1e-9)
        np.testing.assert_allclose(samples[:, 4:], [[0, -9.81, 0]] * len(samples))
        turned = ~np.isnan(samples[:, 1])
        self.assertTrue(turned.any() and not turned.all())

    def test_stamps_that_jump_back(self):
        def play():
            self.play(range(2))
            self.play(range(2, FRAMES), -500)

        threading.Thread(target=play, daemon=True).start()
        said = self.run_camera(*TRACK)
        self.assertIn("moved to follow those before", said)
        times = np.array(rows(self.run_folder / "trajectory.txt"), float)[:, 0]
        self.assertTrue((np.diff(times) > 0).all())


class Trouble(Ros1Test):
    def test_no_master(self):
        self.environment["ROS_MASTER_URI"] = "http://127.0.0.1:1"
        self.refused("no ROS master answers at http://127.0.0.1:1", "roscore")
        listed = self.done(SGS, "info", "--cameras").stdout
        self.assertIn("no ROS master answers", listed)
        said = self.run_camera("--ros1", *TRACK, source=self.color.folder)
        self.assertIn("no ROS master answers", said)

    def test_no_ros(self):
        folder = self.folder / "none"
        folder.mkdir()
        (folder / "rospy.py").write_text("raise ImportError('there is none')\n")
        self.environment["PYTHONPATH"] = str(folder)
        self.refused("ROS 1 cannot be loaded: there is none", "apt install python3-rospy")
        said = self.run_camera("--ros1", *TRACK, source=self.color.folder)
        self.assertIn("ROS 1 cannot be loaded", said)

    def test_other_topics(self):
        for topic in self.topics():
            self.withdraw(topic)
        self.publisher("/left/image_mono", Image)
        self.publisher("/left/camera_info", CameraInfo)
        images = "topics with images that are there: /left/image_mono"
        self.refused("no camera is published", images, source="camera:ros1,wait=0.5")
        self.refused("with camera infos: /left/camera_info", source="camera:ros1,wait=0.5")
        source = "camera:ros1,wait=0.5,color=/here,depth=/there"
        self.refused("not all of /here, /there", source=source)

    def test_two_cameras(self):
        self.advertise("/other")
        listed = self.done(SGS, "info", "--cameras").stdout
        for name in self.name, "/other":
            self.assertIn(f"camera:ros1:{name}", listed)
        self.refused("2 cameras are published", f"camera:ros1:{self.name}", source="camera:ros1",
                     code=2)  # fmt: skip
        self.refused("no camera was found", source="camera:")

    def test_nothing_comes(self):
        self.refused(f"no image has come on {self.topics()[0]}", source=self.camera("wait=1"))

    def test_depth_that_cannot_be_placed(self):
        color, depth, info = self.topics()
        other = f"{self.name}/depth/image_raw"
        self.withdraw(depth)
        self.publisher(other, Image)
        for more, words in ({}, "its camera info does not come"), (
            {f"{self.name}/depth/camera_info": self.info(frame="elsewhere")},
            "/tf_static does not say",
        ):
            for topic in more:
                self.publisher(topic, CameraInfo)
            message = self.image(1, self.color.depths[0].astype("<u2"), "16UC1", "elsewhere")
            named = {other: message, **more}
            play = self.publish(info=self.info(), color=self.color_image(0), **named)
            self.assertIn(words, self.sent_while(play, "--wait=2", code=1))

    def test_images_that_cannot_be_read(self):
        good = dict(info=self.info(), color=self.color_image(0), depth=self.depth_image(0))
        bayer = self.image(1, self.color.colors[0][:, :, 0].copy(), "bayer_rggb8")
        short = self.image(1, self.color.colors[0], "rgb8", data=b"123")
        thin = self.image(1, self.color.colors[0], "rgb8", step=5)
        empty = self.image(1, self.color.colors[0], "rgb8", width=0)
        for changes, words in (
            (dict(color=bayer), "colour as 'bayer_rggb8'"),
            (dict(color=short), "does not fit its 3 bytes"),
            (dict(color=thin), "in rows of 5"),
            (dict(color=empty), "does not fit"),
            (
                dict(depth=self.image(1, self.color.depths[0].astype("<u2"), "8UC1")),
                "depth as '8UC1'",
            ),
        ):
            said = self.sent_while(self.publish(**{**good, **changes}), code=1)
            self.assertIn(words, said)

    def test_images_that_change(self):
        def play():
            self.play(range(3))
            small = self.image(self.color.times[3], self.color.colors[3][:10].copy(), "rgb8")
            self.publishers[self.topics()[0]].publish(small)
            self.play(range(4, FRAMES))

        *_, said = self.sent_while(play, f"--frames={FRAMES - 1}")
        self.assertEqual(said.count("size or kind has changed"), 1)

    def test_a_publisher_that_goes_and_comes_back(self):
        run = self.begin(self.camera("every=on"))
        self.play(range(6))
        self.wait_for_frames(6)
        for topic in self.topics():
            self.withdraw(topic)
        log = self.run_folder / "log.txt"
        happens(lambda: "nobody publishes" in log.read_text())
        self.advertise()
        self.play(range(6, FRAMES))
        self.wait_for_frames(FRAMES)
        run.send_signal(signal.SIGINT)
        run.communicate(timeout=TIMEOUT)
        self.assertEqual(self.tracked(), FRAMES)
        self.assert_no_program_is_left()

    def wait_for_frames(self, count):
        journal = self.run_folder / "frames.csv"
        happens(lambda: journal.exists() and journal.read_text().count("\n") > count)

    def test_requests_that_make_no_sense(self):
        for options, words in (
            (("--ros1", "--ros1-up", "up"), "no direction"),
            (("--ros1-up", "0,1,0"), "requires --ros1"),
            (("--ros1", "--ros2"), "--ros1"),
        ):
            self.assertIn(words, self.run_camera(*options, source=self.color.folder, code=2))

    def test_news_that_are_none(self):
        for news in b"X\0\0\0\0", b"P\x08\0\0\0" + bytes(8), b"P\xff\xff\0\0x", b"P":
            done = subprocess.run(
                [SGS.parent / "sgs-ros1"], input=news, capture_output=True, env=self.environment
            )
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertIn(b"what comes is no news of a run", done.stdout)


class Output(Ros1Test):
    KINDS = {
        "/tf": TFMessage,
        "/sgs/odom": Odometry,
        "/sgs/path": Path,
        "/sgs/cloud": PointCloud2,
        "/sgs/grid": OccupancyGrid,
    }
    R_MAP_WORLD = ros2_test.Output.R_MAP_WORLD
    rigid = staticmethod(ros2_test.Output.rigid)
    saved = ros2_test.Output.saved

    def listen(self):
        self.came = {topic: [] for topic in self.KINDS}
        self.subscribers = [
            rospy.Subscriber(topic, kind, self.came[topic].append, tcp_nodelay=True)
            for topic, kind in self.KINDS.items()
        ]
        for one in self.subscribers:
            self.addCleanup(one.unregister)

    def rigid_of(self, translation, rotation):
        numbers = lambda message, keys: {key: getattr(message, key) for key in keys}
        return self.rigid(numbers(translation, "xyz"), numbers(rotation, "xyzw"))

    def pose(self, message):
        return self.rigid_of(message.position, message.orientation)

    def at(self, poses, header):
        t = header.stamp.to_sec()
        return next(pose for time, pose in poses.items() if abs(time - t) < 1e-5)

    def run_and_listen(self, *options):
        self.listen()

        def play():
            self.play(range(1))  # the run begins; nothing is told before there is a second frame
            happens(lambda: all(one.get_num_connections() > 0 for one in self.subscribers))
            self.play(range(1, FRAMES))

        threading.Thread(target=play, daemon=True).start()
        said = self.run_camera("--no-eval", "--ros1", *options)
        self.assertNotIn("not published", said)
        last = self.color.times[-1]
        for topic in "/sgs/odom", "/sgs/path", "/sgs/cloud":
            newest = lambda: [m.header.stamp.to_sec() for m in self.came[topic]][-1:]
            happens(lambda: newest() and newest()[0] > last - 1e-3)
        happens(lambda: len(self.came["/tf"]) >= len(self.came["/sgs/odom"]))

    def test_what_is_published(self):
        self.run_and_listen("--ros1-up", "0,-1,0", "--ros1-camera-frame", "eye")
        poses = self.saved()
        self.assertEqual(len(poses), FRAMES)
        self.assertGreater(len(self.came["/sgs/odom"]), FRAMES // 2)
        for message in self.came["/tf"]:
            frames = [(one.header.frame_id, one.child_frame_id) for one in message.transforms]
            self.assertEqual(frames, [("map", "odom"), ("odom", "eye")])
            T = [self.rigid_of(m.transform.translation, m.transform.rotation)
                 for m in message.transforms]  # fmt: skip
            header = message.transforms[1].header
            np.testing.assert_allclose(T[0] @ T[1], self.at(poses, header), atol=2e-6)
        last = None
        for message in self.came["/sgs/odom"]:
            self.assertEqual((message.header.frame_id, message.child_frame_id), ("odom", "eye"))
            t, T = message.header.stamp.to_sec(), self.pose(message.pose.pose)
            np.testing.assert_allclose(T, self.at(poses, message.header), atol=2e-6)
            if last is not None:
                moved = np.linalg.inv(last[1]) @ T
                v = message.twist.twist.linear
                expected = moved[:3, :3].T @ moved[:3, 3] / (t - last[0])
                np.testing.assert_allclose([v.x, v.y, v.z], expected, atol=1e-4)
            last = t, T

    def test_path_and_points(self):
        self.run_and_listen()
        poses = self.saved()
        path = self.came["/sgs/path"][-1]
        self.assertEqual((path.header.frame_id, len(path.poses)), ("map", FRAMES))
        for one in path.poses:
            np.testing.assert_allclose(self.pose(one.pose), self.at(poses, one.header), atol=2e-6)
        cloud = self.came["/sgs/cloud"][-1]
        fields = [(field.name, field.offset, field.datatype) for field in cloud.fields]
        self.assertEqual(fields, [("x", 0, 7), ("y", 4, 7), ("z", 8, 7), ("rgb", 12, 7)])
        self.assertEqual(len(cloud.data), cloud.row_step)
        points = np.frombuffer(cloud.data, "<f4").reshape(-1, 4)[:, :3]
        self.done(SGS, "export", self.run_folder, "points", self.folder / "points.ply")
        theirs = ros2_test.read_points(self.folder / "points.ply") @ self.R_MAP_WORLD.T
        np.testing.assert_allclose(points, theirs, atol=1e-5)

    def test_free_floor(self):
        self.listen()
        command = "run", "synth:flat", "--frames", "0:120", "--ros1", "--ros1-up", "0,-1,0"
        self.done(SGS, *command, "-o", self.run_folder, *TRACK)
        last = float(rows(self.run_folder / "trajectory.txt")[-1][0])
        happens(lambda: any(m.header.stamp.to_sec() > last - 1e-3 for m in self.came["/sgs/grid"]))
        grid = self.came["/sgs/grid"][-1]
        cells = np.array(grid.data, np.int8).reshape(grid.info.height, grid.info.width)
        self.assertAlmostEqual(grid.info.resolution, 0.05, places=6)
        self.assertEqual(set(np.unique(cells)), {-1, 0, 100})
        origin = grid.info.origin.position
        column, row = (int((v - o) / 0.05) for v, o in ((1.0, origin.x), (0, origin.y)))
        self.assertEqual(cells[row, column], 0, "the way ahead of the first camera")

    def test_nobody_has_to_listen(self):
        self.done(SGS, "run", self.color.folder, "-o", self.run_folder, "--ros1", "--no-eval")
        self.assert_same_run(self.color.folder)


del CameraTest  # of it there are no tests

if __name__ == "__main__":
    ended = unittest.main(exit=False).result
    sys.stderr.flush()
    os._exit(not ended.wasSuccessful())  # the node's threads would be waited for
