# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Messages of ROS 2 in CDR (OMG DDS-XTypes 1.3, 7.4.3: plain CDR 1) and rosbag2's SQLite files.

Shares no code with the program under test, and needs no ROS.
"""
import pathlib
import sqlite3
import struct

import numpy as np

IMAGE, INFO = "sensor_msgs/msg/Image", "sensor_msgs/msg/CameraInfo"
TF, STRING = "tf2_msgs/msg/TFMessage", "std_msgs/msg/String"
IMU = "sensor_msgs/msg/Imu"


class Writer:
    """Fields one after the other, each aligned to its size behind the four bytes of the head."""

    def __init__(self):
        self.body = b""

    def number(self, form, *values):
        size = struct.calcsize(form)
        for value in values:
            self.body += bytes(-len(self.body) % size) + struct.pack("<" + form, value)
        return self

    def octets(self, data):
        self.number("I", len(data))
        self.body += data
        return self

    def text(self, value):
        return self.octets(value.encode() + b"\0")

    def header(self, stamp_ns, frame):
        return self.number("i", stamp_ns // 10**9).number("I", stamp_ns % 10**9).text(frame)

    def done(self):
        return b"\0\1\0\0" + self.body


def image(pixels, encoding, stamp_ns, frame, big_endian=0, height=None):
    """`height`: of the picture, where its data have more rows (NV12)."""
    size = (height or pixels.shape[0], pixels.shape[1])
    w = Writer().header(stamp_ns, frame).number("I", *size).text(encoding)
    data = np.ascontiguousarray(pixels)
    w.number("B", big_endian).number("I", data.nbytes // data.shape[0])
    return w.octets(data.tobytes()).done()


def camera_info(k, size, stamp_ns, frame, **other):
    """`k`: fx fy cx cy, or None; other: p (the same for P), model, d, binning, roi (x y h w)."""
    w = Writer().header(stamp_ns, frame).number("I", size[1], size[0])
    d = other.get("d", (0.0,) * 5)
    w.text(other.get("model", "plumb_bob")).number("I", len(d)).number("d", *d)
    fx, fy, cx, cy = k or (0.0,) * 4
    w.number("d", *map(float, (fx, 0, cx, 0, fy, cy, 0, 0, 1 if k else 0)))
    w.number("d", *np.eye(3).ravel().tolist())
    fx, fy, cx, cy = other.get("p", k) or (0.0,) * 4
    w.number("d", *map(float, (fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, 1, 0)))
    w.number("I", *other.get("binning", (0, 0))).number("I", *other.get("roi", (0,) * 4))
    return w.number("B", 0).done()


def transforms(stamp_ns, *edges):
    """Edges (parent, child, translation, quaternion xyzw)."""
    w = Writer().number("I", len(edges))
    for parent, child, t, q in edges:
        w.header(stamp_ns, parent).text(child)
        w.number("d", *map(float, t)).number("d", *map(float, q))
    return w.done()


def imu(stamp_ns, frame, acceleration):
    """Accelerations in m/s^2; nothing else was measured."""
    w = Writer().header(stamp_ns, frame).number("d", 0.0, 0.0, 0.0, 1.0, -1.0, *([0.0] * 8))
    w.number("d", 0.0, 0.0, 0.0, -1.0, *([0.0] * 8))
    return w.number("d", *map(float, acceleration)).number("d", *([0.0] * 9)).done()


def string(value):
    return Writer().text(value).done()


def write_db3(path, messages):
    """Messages (topic, type, time of recording in ns, bytes) as rosbag2's storage has them."""
    path = pathlib.Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.unlink(missing_ok=True)
    base = sqlite3.connect(path)
    base.executescript(
        "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT,"
        " serialization_format TEXT, offered_qos_profiles TEXT);"
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER,"
        " data BLOB);"
    )
    ids = {}
    for topic, kind, time_ns, data in messages:
        if topic not in ids:
            ids[topic] = len(ids) + 1
            row = (ids[topic], topic, kind, "cdr", "")
            base.execute("INSERT INTO topics VALUES (?, ?, ?, ?, ?)", row)
        base.execute(
            "INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)",
            (ids[topic], time_ns, data),
        )
    base.commit()
    base.close()
    return path
