# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""`sgs run camera:ros2` and `--ros2` against a participant of another DDS.

Usage: ros2_test.py SGS RENDER_RIG FOLDER_OF_FOREIGN_NODE [unittest arguments]
"""
import os
import pathlib
import sys
import threading
import unittest

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "cameras"))
from fake_cameras import FAKES, FRAMES, SGS, TRACK, CameraTest, parts_of, rows  # noqa: E402
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


if __name__ == "__main__":
    unittest.main()
