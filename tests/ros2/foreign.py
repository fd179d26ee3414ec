# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Messages of ROS 2 packed and read as its documentation says (OMG CDR, XCDR version 1), and a
participant of another DDS that carries them (foreign_node.cc)."""
import collections
import struct
import subprocess
import threading
import time

# The types, written down from the public interface definitions.
TYPES = {
    "Time": [("sec", "i"), ("nanosec", "I")],
    "Header": [("stamp", "Time"), ("frame_id", "s")],
    "Point": [("x", "d"), ("y", "d"), ("z", "d")],
    "Quaternion": [("x", "d"), ("y", "d"), ("z", "d"), ("w", "d")],
    "Pose": [("position", "Point"), ("orientation", "Quaternion")],
    "PoseStamped": [("header", "Header"), ("pose", "Pose")],
    "PoseWithCovariance": [("pose", "Pose"), ("covariance", "36d")],
    "Twist": [("linear", "Point"), ("angular", "Point")],
    "TwistWithCovariance": [("twist", "Twist"), ("covariance", "36d")],
    "Transform": [("translation", "Point"), ("rotation", "Quaternion")],
    "TransformStamped": [("header", "Header"), ("child_frame_id", "s"), ("transform", "Transform")],
    "tf2_msgs/TFMessage": [("transforms", "TransformStamped[]")],
    "nav_msgs/Odometry": [
        ("header", "Header"),
        ("child_frame_id", "s"),
        ("pose", "PoseWithCovariance"),
        ("twist", "TwistWithCovariance"),
    ],
    "nav_msgs/Path": [("header", "Header"), ("poses", "PoseStamped[]")],
    "MapMetaData": [
        ("map_load_time", "Time"),
        ("resolution", "f"),
        ("width", "I"),
        ("height", "I"),
        ("origin", "Pose"),
    ],
    "nav_msgs/OccupancyGrid": [("header", "Header"), ("info", "MapMetaData"), ("data", "bytes")],
    "RegionOfInterest": [
        ("x_offset", "I"),
        ("y_offset", "I"),
        ("height", "I"),
        ("width", "I"),
        ("do_rectify", "B"),
    ],
    "sensor_msgs/CameraInfo": [
        ("header", "Header"),
        ("height", "I"),
        ("width", "I"),
        ("distortion_model", "s"),
        ("d", "d[]"),
        ("k", "9d"),
        ("r", "9d"),
        ("p", "12d"),
        ("binning_x", "I"),
        ("binning_y", "I"),
        ("roi", "RegionOfInterest"),
    ],
    "sensor_msgs/Image": [
        ("header", "Header"),
        ("height", "I"),
        ("width", "I"),
        ("encoding", "s"),
        ("is_bigendian", "B"),
        ("step", "I"),
        ("data", "bytes"),
    ],
    "sensor_msgs/CompressedImage": [("header", "Header"), ("format", "s"), ("data", "bytes")],
    "sensor_msgs/Imu": [
        ("header", "Header"),
        ("orientation", "Quaternion"),
        ("orientation_covariance", "9d"),
        ("angular_velocity", "Point"),
        ("angular_velocity_covariance", "9d"),
        ("linear_acceleration", "Point"),
        ("linear_acceleration_covariance", "9d"),
    ],
    "PointField": [("name", "s"), ("offset", "I"), ("datatype", "B"), ("count", "I")],
    "sensor_msgs/PointCloud2": [
        ("header", "Header"),
        ("height", "I"),
        ("width", "I"),
        ("fields", "PointField[]"),
        ("is_bigendian", "B"),
        ("point_step", "I"),
        ("row_step", "I"),
        ("data", "bytes"),
        ("is_dense", "B"),
    ],
}
HEAD = b"\0\1\0\0"  # plain CDR, little-endian


def pack(kind, value):
    """A message, from nested dicts; what is left out is zero or empty."""
    out = bytearray()

    def numbers(code, count, values):
        size = struct.calcsize(code)
        out.extend(b"\0" * (-len(out) % size))
        out.extend(struct.pack(f"<{count}{code}", *values))

    def put(kind, value):
        if kind in TYPES:
            for name, part in TYPES[kind]:
                put(part, (value or {}).get(name))
        elif kind == "s":
            text = (value or "").encode() + b"\0"
            numbers("I", 1, [len(text)])
            out.extend(text)
        elif kind == "bytes":
            numbers("I", 1, [len(value or b"")])
            out.extend(value or b"")
        elif kind.endswith("[]"):
            numbers("I", 1, [len(value or [])])
            for one in value or []:
                put(kind[:-2], one)
        else:
            count = int(kind[:-1] or 1)
            values = [value or 0] if kind[:-1] == "" else list(value or [0] * count)
            numbers(kind[-1], count, values)

    put(kind, value)
    return HEAD + bytes(out)


def unpack(kind, data):
    """The same read; fails where bytes are missing or left."""
    assert data[:2] == HEAD[:2], data[:4]
    body, at = data[4:], 0

    def numbers(code, count):
        nonlocal at
        at += -at % struct.calcsize(code)
        values = struct.unpack_from(f"<{count}{code}", body, at)
        at += count * struct.calcsize(code)
        return values

    def get(kind):
        nonlocal at
        if kind in TYPES:
            return {name: get(part) for name, part in TYPES[kind]}
        if kind in ("s", "bytes"):
            (length,) = numbers("I", 1)
            at += length
            assert at <= len(body)
            value = body[at - length : at]
            return value if kind == "bytes" else value.rstrip(b"\0").decode()
        if kind.endswith("[]"):
            return [get(kind[:-2]) for _ in range(numbers("I", 1)[0])]
        values = numbers(kind[-1], int(kind[:-1] or 1))
        return values if kind[:-1] else values[0]

    value = get(kind)
    assert 0 <= len(body) - at < 4, (kind, at, len(body))  # padding to four bytes
    return value


def dds_type(kind):
    return kind.replace("/", "::msg::dds_::") + "_"


class ForeignNode:
    """Publishes and subscribes by Fast DDS; topics are those of ROS ("/tf")."""

    def __init__(self, program, domain):
        self.process = subprocess.Popen(
            [program, str(domain)], stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )
        self.kinds, self.matched = {}, collections.Counter()
        self.came = collections.defaultdict(list)
        self.changed = threading.Condition()
        threading.Thread(target=self._listen, daemon=True).start()

    def _listen(self):
        def part():
            (size,) = struct.unpack("<I", self.process.stdout.read(4))
            return self.process.stdout.read(size)

        while what := self.process.stdout.read(1):
            topic, _, data = part().decode()[2:], part(), part()
            with self.changed:
                if what == b"M":
                    self.matched[topic] = int(data)
                else:
                    self.came[topic].append(unpack(self.kinds[topic], data))
                self.changed.notify_all()

    def _tell(self, what, topic, kind="", data=b""):
        parts = ("rt" + topic).encode(), dds_type(kind).encode() if kind else b"", data
        self.process.stdin.write(what)
        for part in parts:
            self.process.stdin.write(struct.pack("<I", len(part)) + part)
        self.process.stdin.flush()

    def advertise(self, topic, kind, flags=b"r"):
        self.kinds[topic] = kind
        self._tell(b"W", topic, kind, flags)

    def subscribe(self, topic, kind, flags=b"r"):
        self.kinds[topic] = kind
        self._tell(b"R", topic, kind, flags)

    def publish(self, topic, value):
        data = value if isinstance(value, bytes) else pack(self.kinds[topic], value)
        self._tell(b"P", topic, data=data)

    def withdraw(self, topic):
        self._tell(b"G", topic)

    def happens(self, condition, seconds):
        """Waits for it; whether it is so."""
        until = time.monotonic() + seconds
        with self.changed:
            while not condition():
                if not self.changed.wait(until - time.monotonic()):
                    return False
        return True

    def wait(self, condition, seconds=120):
        assert self.happens(condition, seconds), "nothing came"

    def close(self):
        """As a node that is killed."""
        self.process.kill()
        self.process.wait()
        self.process.stdin.close()
        self.process.stdout.close()
