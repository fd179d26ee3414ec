# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""`sgs run camera:ros2` and `--ros2` against a participant of another DDS.

Usage: ros2_test.py SGS RENDER_RIG FOLDER_OF_FOREIGN_NODE [unittest arguments]
"""
import itertools
import os
import pathlib
import signal
import subprocess
import sys
import threading
import time
import unittest

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "cameras"))
from fake_cameras import (
    FAKES,
    FRAMES,
    SGS,
    TIMEOUT,
    TRACK,
    CameraTest,
    parts_of,
    rows,
)  # noqa: E402
from foreign import ForeignNode, pack  # noqa: E402

# This machine only, and nobody else on it: each test has a domain of its own.
CYCLONE = """<CycloneDDS><Domain><General><Interfaces><NetworkInterface name="lo"/></Interfaces>
<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>
<MaxAutoParticipantIndex>8</MaxAutoParticipantIndex><Peers><Peer address="127.0.0.1"/></Peers>
</Discovery></Domain></CycloneDDS>"""
NAME = "/camera"
COLOR, DEPTH = f"{NAME}/color/image_raw", f"{NAME}/aligned_depth_to_color/image_raw"
INFO = f"{NAME}/color/camera_info"
OPTICAL = "camera_color_optical_frame"


def header(seconds, frame=OPTICAL):
    nanoseconds = round(seconds * 1e9)
    return {
        "stamp": {"sec": nanoseconds // 10**9, "nanosec": nanoseconds % 10**9},
        "frame_id": frame,
    }


def seconds_of(message):
    stamp = message["header"]["stamp"]
    return stamp["sec"] + 1e-9 * stamp["nanosec"]


class Ros2Test(CameraTest):
    family = "ros2"

    def setUp(self):
        super().setUp()
        # Domains up to 101 have ports below those that systems give to others.
        self.domain = 1 + (os.getpid() * 7 + hash(self.id())) % 100
        self.environment["CYCLONEDDS_URI"] = CYCLONE
        self.environment["ROS_DOMAIN_ID"] = str(self.domain)

    def foreign(self):
        node = ForeignNode(FAKES / "foreign_node", self.domain)
        self.addCleanup(node.close)
        return node

    def advertise(self, node, flags=b"r", color=COLOR, depth=DEPTH, info=INFO):
        node.advertise(color, "sensor_msgs/Image", flags)
        node.advertise(depth, "sensor_msgs/Image", flags)
        node.advertise(info, "sensor_msgs/CameraInfo", flags)

    def info(self, camera=None, **changes):
        camera = camera or self.color
        return {
            "header": header(0),
            "height": camera.height,
            "width": camera.width,
            "distortion_model": "plumb_bob",
            "d": [0, 0, 0, 0, 0],
            "k": [camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1],
            "p": [camera.fx, 0, camera.cx, 0, 0, camera.fy, camera.cy, 0, 0, 0, 1, 0],
            **changes,
        }

    def image(self, t, array, encoding, frame=OPTICAL, **changes):
        return {
            "header": header(t, frame),
            "height": array.shape[0],
            "width": array.shape[1],
            "encoding": encoding,
            "step": array.strides[0],
            "data": array.tobytes(),
            **changes,
        }

    def color_image(self, k):
        return self.image(self.color.times[k], self.color.colors[k], "rgb8")

    def depth_image(self, k):
        return self.image(self.color.times[k], self.color.depths[k].astype("<u2"), "16UC1")

    def play(self, node, frames=range(FRAMES)):
        """As a driver does: pictures with a camera info each, when somebody is there to see."""
        node.wait(lambda: all(node.matched[topic] > 0 for topic in (COLOR, DEPTH, INFO)))
        for k in frames:
            node.publish(INFO, self.info(header=header(self.color.times[k])))
            node.publish(COLOR, self.color_image(k))
            node.publish(DEPTH, self.depth_image(k))

    def playing(self, node, *arguments):
        player = threading.Thread(target=self.play, args=(node, *arguments), daemon=True)
        player.start()
        return player


class Input(Ros2Test):
    def test_the_same_scene_from_a_file(self):
        node = self.foreign()
        self.advertise(node)
        self.playing(node)
        self.run_camera("--no-eval", "--quiet")
        self.assertEqual(self.tracked(), FRAMES)
        self.assert_same_run(self.color.folder)

    def sent_while(self, play, *options, code=0):
        """What the program sends by itself while somebody plays, and says."""
        player = threading.Thread(target=play, daemon=True)
        player.start()
        stream, said = self.sent_by(SGS.parent / "sgs-camera-ros2", *options, code=code)
        return said if code else (*parts_of(stream), said)

    def publish_once(self, node, color, depth, *more, info=None):
        """A function that publishes one pair, and what else there is, to whoever comes first."""

        def play():
            topics = (COLOR, DEPTH, INFO, *(topic for topic, _ in more))
            node.wait(lambda: all(node.matched[topic] > 0 for topic in topics))
            for topic, message in (
                (INFO, info or self.info()),
                *more,
                (COLOR, color),
                (DEPTH, depth),
            ):
                node.publish(topic, message)

        return play

    def test_encodings(self):
        color, depth = self.color.colors[0], self.color.depths[0].astype("<u2")
        gray = color[:, :, 1].copy()
        bgra = np.dstack([color[:, :, ::-1], np.full_like(gray, 255)]).copy()
        wide = np.pad(color, ((0, 0), (0, 3), (0, 0)))
        image = lambda array, encoding, **changes: self.image(1.5, array, encoding, **changes)
        row = color.strides[0] + 9
        for encoding, message, expected in (
            ("bgr8", image(color[:, :, ::-1].copy(), "bgr8"), color),
            ("bgra8", image(bgra, "bgra8"), color),
            ("mono8", image(gray, "mono8"), np.repeat(gray[:, :, None], 3, axis=2)),
            ("rows with gaps", image(wide, "rgb8", width=color.shape[1], step=row), color),
        ):
            with self.subTest(encoding):
                node = self.foreign()
                self.advertise(node)
                play = self.publish_once(node, message, image(depth, "16UC1"))
                _, frames, _, _ = self.sent_while(play, "--frames=1")
                self.assertEqual(frames[0]["color"], expected.tobytes())
                self.assertEqual(frames[0]["t"], 1.5)
                node.close()
        metres = (depth / 1000).astype("<f4")
        for encoding, message, unit, expected in (
            ("big end", image(depth.byteswap(), "16UC1", is_bigendian=1), "u16", depth),
            ("32FC1", image(metres, "32FC1"), "f32", metres),
        ):
            with self.subTest(encoding):
                node = self.foreign()
                self.advertise(node)
                play = self.publish_once(node, image(color, "rgb8"), message)
                greeting, frames, _, _ = self.sent_while(play, "--frames=1")
                self.assertEqual(
                    (greeting["depth"], greeting.get("depth_scale", 1000)), (unit, 1000)
                )
                self.assertEqual(frames[0]["depth"], expected.tobytes())
                node.close()

    def test_publishers_that_lie(self):
        color, depth = self.color_image(0), self.depth_image(0)
        for changes, words in (
            (dict(color={"encoding": "rgb9"}), ("'rgb9' is not known", "publish colour as rgb8")),
            (dict(color={"height": 10**9}), ("does not fit its",)),
            (dict(color={"data": color["data"][:-1]}), ("does not fit its",)),
            (dict(color={"width": 0, "height": 0, "data": b""}), ("does not fit its",)),
            (dict(depth={"encoding": "rgb8"}), ("'rgb8' is not known", "16UC1")),
            (dict(info={"k": [0] * 9, "p": [0] * 12}), ("neither K nor P is filled in",)),
            (dict(info={"distortion_model": "barrel", "d": [1, 2]}), ("'barrel' with 2",)),
            (dict(depth={"width": 7, "step": 14}), ("cannot lie on colour",)),
        ):
            with self.subTest(changes):
                node = self.foreign()
                self.advertise(node)
                play = self.publish_once(
                    node,
                    {**color, **changes.get("color", {})},
                    {**depth, **changes.get("depth", {})},
                    info=self.info(**changes.get("info", {})),
                )
                said = self.sent_while(play, "--frames=1", code=1)
                for word in words:
                    self.assertIn(word, said)
                node.close()

    def test_damaged_messages_are_left_out(self):
        node = self.foreign()
        self.advertise(node)

        def play():
            node.wait(lambda: all(node.matched[topic] > 0 for topic in (COLOR, DEPTH, INFO)))
            whole = pack("sensor_msgs/Image", self.color_image(0))
            for damaged in whole[:40], whole[:4] + b"\xff" * 60, b"\0\1\0\0", whole[:-1000]:
                node.publish(COLOR, damaged)
            self.play(node, range(2))

        _, frames, _, _ = self.sent_while(play, "--frames=2")
        self.assertEqual([frame["t"] for frame in frames], self.color.times[:2])

    def test_images_that_change_on_the_way(self):
        node = self.foreign()
        self.advertise(node)

        def play():
            self.play(node, range(2))
            node.publish(
                COLOR, self.image(self.color.times[2], np.zeros((6, 8, 3), np.uint8), "rgb8")
            )
            node.publish(COLOR, {**self.color_image(2), "encoding": "none"})
            self.play(node, range(2, 4))

        _, frames, _, said = self.sent_while(play, "--frames=4")
        self.assertEqual(len(frames), 4)
        self.assertIn("changed to 8x6", said)
        self.assertIn("'none' is not known", said)

    def test_depth_of_its_own_camera(self):
        values = self.play_unregistered()
        node = self.foreign()
        depth, info = f"{NAME}/depth/image_rect_raw", f"{NAME}/depth/camera_info"
        node.advertise(COLOR, "sensor_msgs/Image")
        node.advertise(INFO, "sensor_msgs/CameraInfo")
        node.advertise(depth, "sensor_msgs/Image")
        node.advertise(info, "sensor_msgs/CameraInfo")
        node.advertise("/tf_static", "tf2_msgs/TFMessage", b"rl")
        x, y, z, *q = values
        rotation = dict(zip("xyzw", q))

        def tf(parent, child, t=(0, 0, 0), rotation={"w": 1}):
            transform = {"translation": dict(zip("xyz", t)), "rotation": rotation}
            return {"header": header(0, parent), "child_frame_id": child, "transform": transform}

        # By way of a frame that both hang on, and one transform that is none.
        tree = [tf(OPTICAL, "middle", (x, y, z)), tf("middle", "depth", (0, 0, 0), rotation)]
        node.publish("/tf_static", {"transforms": [tf("a", "b", rotation={}), *tree]})

        def play():
            node.wait(lambda: all(node.matched[t] > 0 for t in (COLOR, INFO, depth, info)))
            node.publish(INFO, self.info())
            node.publish(info, self.info(self.depth))
            node.publish(COLOR, self.color_image(0))
            raw = self.depth.depths[0].astype("<u2")
            node.publish(depth, self.image(self.color.times[0], raw, "16UC1", "depth"))

        greeting, frames, _, _ = self.sent_while(play, "--frames=1")
        np.testing.assert_allclose(greeting["color_from_depth"], values, atol=1e-9)
        self.assertAlmostEqual(greeting["depth_camera"]["fx"], self.depth.fx)

    def test_depth_that_lies_nobody_knows_where(self):
        node = self.foreign()
        depth = f"{NAME}/depth/image_raw"
        self.advertise(node, depth=depth)

        def play():
            node.wait(lambda: all(node.matched[topic] > 0 for topic in (COLOR, depth, INFO)))
            node.publish(INFO, self.info())
            node.publish(COLOR, self.color_image(0))
            node.publish(depth, {**self.depth_image(0), "header": header(1, "elsewhere")})

        said = self.sent_while(play, "--frames=1", "--wait=2", code=1)
        for word in "is not registered to colour", "align_depth.enable", "registered=on":
            self.assertIn(word, said)

    def test_inertial_samples(self):
        node = self.foreign()
        self.advertise(node)
        imu = f"{NAME}/imu"
        node.advertise(imu, "sensor_msgs/Imu")
        node.advertise("/tf_static", "tf2_msgs/TFMessage", b"rl")
        half = {"z": 0.5**0.5, "w": 0.5**0.5}
        transform = {"translation": {"x": 0.01}, "rotation": half}
        tree = {"header": header(0), "child_frame_id": "imu", "transform": transform}
        node.publish("/tf_static", {"transforms": [tree]})
        sample = lambda t, **changes: {
            "header": header(t, "imu"),
            "angular_velocity": {"x": 0.01, "y": 0.02, "z": 0.03},
            "linear_acceleration": {"y": -9.81},
            **changes,
        }

        def play():
            topics = COLOR, DEPTH, INFO, imu
            node.wait(lambda: all(node.matched[topic] > 0 for topic in topics))
            node.publish(imu, sample(1))
            no_turn = [-1] + [0] * 8
            for k, t in enumerate(self.color.times):
                node.publish(imu, sample(t))
                node.publish(imu, sample(t + 0.01, angular_velocity_covariance=no_turn))
                self.play(node, range(k, k + 1))

        greeting, _, samples, _ = self.sent_while(play, f"--frames={FRAMES}")
        pose = [0.01, 0, 0, 0, 0, 0.5**0.5, 0.5**0.5]
        np.testing.assert_allclose(greeting["imu"]["color_from_imu"], pose, atol=1e-9)
        self.assertGreater(len(samples), 0)
        np.testing.assert_allclose(samples[:, 4:], [[0, -9.81, 0]] * len(samples))
        turned = ~np.isnan(samples[:, 1])
        self.assertTrue(turned.any() and not turned.all())

    def test_packed_images(self):
        node = self.foreign()
        color, depth = f"{COLOR}/compressed", f"{DEPTH}/compressedDepth"
        node.advertise(color, "sensor_msgs/CompressedImage")
        node.advertise(depth, "sensor_msgs/CompressedImage")
        node.advertise(INFO, "sensor_msgs/CameraInfo")
        row = lambda name: next(iter(rows(self.color.folder / name)))[1]
        png = lambda name: (self.color.folder / row(name)).read_bytes()

        def play():
            node.wait(lambda: all(node.matched[topic] > 0 for topic in (color, depth, INFO)))
            node.publish(INFO, self.info())
            head = header(2)
            node.publish(color, {"header": head, "format": "rgb8; png", "data": png("rgb.txt")})
            packed = b"\0" * 12 + png("depth.txt")
            form = "16UC1; compressedDepth png"
            node.publish(depth, {"header": head, "format": form, "data": packed})

        options = f"--color={color}", f"--depth={depth}", "--frames=1"
        _, frames, _, _ = self.sent_while(play, *options)
        self.assertEqual(frames[0]["color"], self.color.colors[0].tobytes())
        self.assertEqual(frames[0]["depth"], self.color.depths[0].astype("<u2").tobytes())

    def test_stamps_that_jump_back(self):
        node = self.foreign()
        self.advertise(node)

        def play():
            self.play(node, range(6))
            for k in range(6, FRAMES):
                for topic, image in (COLOR, self.color_image(k)), (DEPTH, self.depth_image(k)):
                    node.publish(topic, {**image, "header": header(self.color.times[k] - 500)})

        _, frames, _, said = self.sent_while(play, f"--frames={FRAMES}")
        self.assertTrue((np.diff([frame["t"] for frame in frames]) > 0).all())
        self.assertIn("clock jumped by", said)


class Output(Ros2Test):
    TOPICS = {
        "/tf": "tf2_msgs/TFMessage",
        "/sgs/odom": "nav_msgs/Odometry",
        "/sgs/path": "nav_msgs/Path",
        "/sgs/cloud": "sensor_msgs/PointCloud2",
        "/sgs/grid": "nav_msgs/OccupancyGrid",
    }
    # The axes of a level camera (right, down, forward) in those of the map (forward, left, up).
    R_MAP_WORLD = np.array([[0, 0, 1], [-1, 0, 0], [0, -1, 0]])

    def listening(self):
        node = self.foreign()
        for topic, kind in self.TOPICS.items():
            latched = topic not in ("/tf", "/sgs/odom")
            node.subscribe(topic, kind, b"rl" if latched else b"r")
        return node

    def heard(self):
        return all(self.node.matched[topic] > 0 for topic in self.TOPICS)

    @staticmethod
    def rigid(translation, rotation):
        x, y, z, w = (rotation[key] for key in "xyzw")
        T = np.eye(4)
        T[:3, :3] = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
        T[:3, 3] = [translation[key] for key in "xyz"]
        return T

    def pose(self, message):
        return self.rigid(message["position"], message["orientation"])

    def saved(self):
        """The run's poses in the axes of its map, by their times."""
        poses = {}
        turn = np.eye(4)
        turn[:3, :3] = self.R_MAP_WORLD
        for row in rows(self.run_folder / "trajectory.txt"):
            numbers = [float(value) for value in row]
            rotation, place = dict(zip("xyzw", numbers[4:])), dict(zip("xyz", numbers[1:4]))
            poses[numbers[0]] = turn @ self.rigid(place, rotation)
        return poses

    def at(self, poses, message):
        t = seconds_of(message)
        return next(pose for time, pose in poses.items() if abs(time - t) < 1e-6)

    def run_and_listen(self, *options):
        self.node = self.listening()
        self.advertise(self.node)

        def play():
            # The first frame lets the run begin; what is told of it, and before the publisher has
            # found those who listen, nobody hears.
            self.play(self.node, range(1))
            self.node.wait(self.heard)
            k = 1
            while not self.node.came["/sgs/odom"] and k < FRAMES:
                self.play(self.node, range(k, k + 1))
                k += 1
                self.node.happens(lambda: self.node.came["/sgs/odom"], seconds=2)
            self.play(self.node, range(k, FRAMES))

        threading.Thread(target=play, daemon=True).start()
        said = self.run_camera("--no-eval", "--ros2", *options)
        self.assertNotIn("not published", said)
        newest = lambda topic: [seconds_of(message) for message in self.node.came[topic]][-1:]
        last = self.color.times[-1]
        self.node.wait(lambda: newest("/sgs/odom") and newest("/sgs/odom")[0] > last - 1e-3)
        self.node.wait(lambda: len(self.node.came["/tf"]) >= len(self.node.came["/sgs/odom"]))
        for topic in "/sgs/path", "/sgs/cloud":
            self.node.wait(lambda: newest(topic) and newest(topic)[0] > last - 1e-3)
        return self.node.came

    def test_what_is_published(self):
        came = self.run_and_listen("--ros2-up", "0,-1,0", "--ros2-camera-frame", "eye")
        poses = self.saved()
        self.assertEqual(len(poses), FRAMES)
        heard = came["/sgs/odom"]
        self.assertGreater(len(heard), 1)
        times = list(poses)[-len(heard) :]
        for message in came["/tf"]:
            first, second = message["transforms"]
            frames = [(one["header"]["frame_id"], one["child_frame_id"]) for one in (first, second)]
            self.assertEqual(frames, [("map", "odom"), ("odom", "eye")])
            T = [self.rigid(**one["transform"]) for one in (first, second)]
            np.testing.assert_allclose(T[0] @ T[1], self.at(poses, second), atol=2e-6)
        last = None
        for t, message in zip(times, heard):
            self.assertAlmostEqual(seconds_of(message), t, delta=1e-6)
            self.assertEqual(
                (message["header"]["frame_id"], message["child_frame_id"]), ("odom", "eye")
            )
            T = self.pose(message["pose"]["pose"])
            np.testing.assert_allclose(T, self.at(poses, message), atol=2e-6)
            if last is not None:
                moved = np.linalg.inv(last[1]) @ T
                twist = message["twist"]["twist"]["linear"]
                expected = moved[:3, :3].T @ moved[:3, 3] / (t - last[0])
                np.testing.assert_allclose(list(twist.values()), expected, atol=1e-4)
            last = t, T

    def test_path_and_points(self):
        came = self.run_and_listen()
        poses = self.saved()
        path = came["/sgs/path"][-1]
        self.assertEqual(path["header"]["frame_id"], "map")
        self.assertEqual(len(path["poses"]), FRAMES)
        for one in path["poses"]:
            np.testing.assert_allclose(self.pose(one["pose"]), self.at(poses, one), atol=2e-6)
        cloud = came["/sgs/cloud"][-1]
        names = [(field["name"], field["offset"], field["datatype"]) for field in cloud["fields"]]
        self.assertEqual(names, [("x", 0, 7), ("y", 4, 7), ("z", 8, 7), ("rgb", 12, 7)])
        self.assertEqual((cloud["height"], cloud["point_step"]), (1, 16))
        self.assertEqual(cloud["row_step"], 16 * cloud["width"])
        self.assertEqual(len(cloud["data"]), cloud["row_step"])
        points = np.frombuffer(cloud["data"], "<f4").reshape(-1, 4)[:, :3]
        # The points of the map, which others read: in the axes of the first camera.
        self.done(SGS, "export", self.run_folder, "points", self.folder / "points.ply")
        theirs = read_points(self.folder / "points.ply") @ self.R_MAP_WORLD.T
        self.assertEqual(len(points), len(theirs))
        np.testing.assert_allclose(points, theirs, atol=1e-5)
        self.assertIn("which way is up is not known", self.log())
        self.assertEqual(came["/sgs/grid"], [])

    def test_free_floor(self):
        node = self.listening()
        command = "run", "synth:flat", "--frames", "0:120", "--ros2", "--ros2-up", "0,-1,0"
        self.done(SGS, *command, "-o", self.run_folder, *TRACK)
        last = float(rows(self.run_folder / "trajectory.txt")[-1][0])
        node.wait(lambda: any(seconds_of(one) > last - 1e-3 for one in node.came["/sgs/grid"]))
        grid = node.came["/sgs/grid"][-1]
        self.assertEqual(grid["header"]["frame_id"], "map")
        info = grid["info"]
        self.assertAlmostEqual(info["resolution"], 0.05, places=6)
        cells = np.frombuffer(grid["data"], np.int8).reshape(info["height"], info["width"])
        self.assertEqual(set(np.unique(cells)), {-1, 0, 100})
        self.assertEqual(info["origin"]["orientation"], {"x": 0, "y": 0, "z": 0, "w": 1})
        # The way ahead of the first camera is free, and something stands somewhere.
        origin = info["origin"]["position"]
        column, row = (int((v - o) / 0.05) for v, o in ((1.0, origin["x"]), (0, origin["y"])))
        self.assertEqual(cells[row, column], 0)

    def test_nobody_has_to_listen(self):
        command = SGS, "run", self.color.folder, "-o", self.run_folder, "--ros2", "--no-eval"
        self.done(*command)
        self.assert_same_run(self.color.folder)

    def test_requests_that_make_no_sense(self):
        for options, words in (
            (("--ros2", "--ros2-up", "up"), "no direction"),
            (("--ros2", "--ros2-domain", "300"), "300 not in range"),
            (("--ros2-domain", "3"), "requires --ros2"),
        ):
            self.assertIn(words, self.run_camera(*options, source=self.color.folder, code=2))
        self.environment["ROS_DOMAIN_ID"] = "one"
        said = self.run_camera("--ros2", *TRACK, source=self.color.folder)
        self.assertIn("ROS_DOMAIN_ID is 'one'", said)


def read_points(path):
    head, data = path.read_bytes().split(b"end_header\n", 1)
    count = int(head.split(b"element vertex ")[1].split()[0])
    return (
        np.frombuffer(data[: count * (len(data) // count)], np.uint8)
        .reshape(count, -1)[:, :12]
        .copy()
        .view("<f4")
        .astype(float)
    )


class Trouble(Ros2Test):
    def test_nobody_publishes(self):
        said = self.refused("nobody publishes anything", f"domain {self.domain}", "ROS_DOMAIN_ID",
                            source=self.camera("wait=1"))  # fmt: skip
        self.assertNotIn("topics with images", said)

    def test_other_topics(self):
        node = self.foreign()
        node.advertise("/left/image_mono", "sensor_msgs/Image")
        node.advertise("/left/camera_info", "sensor_msgs/CameraInfo")
        self.refused(
            "topics with images that are there: /left/image_mono",
            "with camera infos: /left/camera_info",
            "color=/TOPIC",
            source=self.camera("wait=3"),
        )
        self.refused("not all of /here, /there is published",
                     source=self.camera("wait=2,color=/here,depth=/there"))  # fmt: skip

    def test_nothing_comes(self):
        node = self.foreign()
        self.advertise(node)
        self.refused(f"no image has come on {COLOR}", "running", source=self.camera("wait=3"))

    def test_two_cameras(self):
        node = self.foreign()
        self.advertise(node)
        replaced = [topic.replace("camera", "other", 1) for topic in (COLOR, DEPTH, INFO)]
        self.advertise(node, b"r", *replaced)
        listed = self.done(SGS, "info", "--cameras").stdout
        for name in "camera:ros2:/camera", "camera:ros2:/other":
            self.assertIn(name, listed)
        self.refused("2 cameras are published", "camera:ros2:/camera; camera:ros2:/other", code=2)
        self.playing(node)
        source = f"camera:ros2:/camera,every=on,frames={FRAMES}"
        self.run_camera(*TRACK, source=source)
        self.assertEqual(self.tracked(), FRAMES)

    def test_best_effort(self):
        node = self.foreign()
        self.advertise(node, b"")
        self.refused("best effort", "leave out every=on", source=self.camera("wait=3,every=on"))
        # What gets lost is lost; but what comes is used.
        ended = threading.Event()
        self.addCleanup(ended.set)

        def play():
            for k in itertools.count():
                if ended.wait(0.03):
                    return
                stamp = header(self.color.times[0] + k / 30)
                node.publish(INFO, self.info(header=stamp))
                node.publish(COLOR, {**self.color_image(k % FRAMES), "header": stamp})
                node.publish(DEPTH, {**self.depth_image(k % FRAMES), "header": stamp})

        threading.Thread(target=play, daemon=True).start()
        self.run_camera(*TRACK, source=self.camera("frames=5"))

    def test_a_publisher_that_goes_and_comes_back(self):
        node = self.foreign()
        self.advertise(node)
        run = self.begin(self.camera("every=on"))
        self.play(node, range(6))
        self.wait_for_frames(6)
        for topic in COLOR, DEPTH, INFO:
            node.withdraw(topic)
        self.wait_for_log("nobody publishes")
        other = self.foreign()
        self.advertise(other)
        self.play(other, range(6, FRAMES))
        self.wait_for_frames(FRAMES)
        run.send_signal(signal.SIGINT)
        run.communicate(timeout=TIMEOUT)
        times = [float(row[0]) for row in rows(self.run_folder / "trajectory.txt")]
        self.assertEqual(len(times), FRAMES)
        self.assertTrue((np.diff(times) > 0).all())

    def wait_for(self, condition, what):
        until = time.monotonic() + TIMEOUT
        while not condition():
            self.assertLess(time.monotonic(), until, what)
            time.sleep(0.05)

    def wait_for_log(self, words):
        log = self.run_folder / "log.txt"
        self.wait_for(lambda: log.exists() and words in log.read_text(), words)

    def wait_for_frames(self, count):
        journal = self.run_folder / "frames.csv"
        lines = lambda: journal.read_text().count("\n") - 1 if journal.exists() else 0
        self.wait_for(lambda: lines() >= count, f"{count} frames")


if __name__ == "__main__":
    unittest.main()
