# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Messages of a rendered sequence, and writers of bags that share no code with the reader: Debian's
python3-rosbag, npm's @mcap/core and @foxglove/rosmsg2-serialization, python's sqlite3.

A message is (topic, type, value, record time in ns); a value holds what the definition names, bytes
for image data, ROS 1 spelling; or it is the bytes of a message that is packed already.
"""
import json
import pathlib
import shutil
import sqlite3
import struct
import subprocess
import unittest

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
COLOR, DEPTH = "/camera/color/image_raw", "/camera/aligned_depth_to_color/image_raw"
RAW_DEPTH = "/camera/depth/image_rect_raw"
COLOR_FRAME, DEPTH_FRAME = "camera_color_optical_frame", "camera_depth_optical_frame"


def header(stamp_ns, frame):
    sec, nsec = divmod(stamp_ns, 10**9)
    return {"stamp": {"sec": sec, "nsec": nsec}, "frame_id": frame}


def image(pixels, encoding, stamp_ns, frame, padding=0):
    """sensor_msgs/Image of an array; `padding` bytes follow each row."""
    rows = np.ascontiguousarray(pixels).view(np.uint8).reshape(pixels.shape[0], -1)
    rows = np.pad(rows, ((0, 0), (0, padding)), constant_values=77)
    return {
        "header": header(stamp_ns, frame),
        "height": pixels.shape[0],
        "width": pixels.shape[1],
        "encoding": encoding,
        "is_bigendian": 0,
        "step": rows.shape[1],
        "data": rows.tobytes(),
    }


def camera_info(k, size, stamp_ns, frame, model="plumb_bob", lens=(0.0,) * 5):
    fx, fy, cx, cy = k
    K = [fx, 0, cx, 0, fy, cy, 0, 0, 1]
    return {
        "header": header(stamp_ns, frame),
        "height": size[1],
        "width": size[0],
        "distortion_model": model,
        "D": [float(v) for v in lens],
        "K": [float(v) for v in K],
        "R": [1.0, 0, 0, 0, 1.0, 0, 0, 0, 1.0],
        "P": [float(v) for v in (fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, 1, 0)],
        "binning_x": 0,
        "binning_y": 0,
        "roi": {"x_offset": 0, "y_offset": 0, "height": 0, "width": 0, "do_rectify": False},
    }


def vector(v):
    return dict(zip("xyz", map(float, v)))


def quaternion(q):
    return dict(zip("xyzw", map(float, q)))


def transform(parent, child, t, q, stamp_ns):
    return {
        "header": header(stamp_ns, parent),
        "child_frame_id": child,
        "transform": {"translation": vector(t), "rotation": quaternion(q)},
    }


def pose(t, q):
    return {"position": vector(t), "orientation": quaternion(q)}


def fill_ros1(message, value):
    """Fills a genpy message from nested dicts."""
    import genpy

    for key, part in value.items():
        if key == "stamp":
            part = genpy.Time(part["sec"], part["nsec"])
        elif isinstance(part, dict):
            part = fill_ros1(getattr(message, key), part)
        elif isinstance(part, list) and part and isinstance(part[0], dict):
            from geometry_msgs.msg import TransformStamped

            part = [fill_ros1(TransformStamped(), item) for item in part]
        setattr(message, key, part)
    return message


def ros1_message(kind, value):
    import importlib

    package, name = kind.split("/")
    return fill_ros1(getattr(importlib.import_module(package + ".msg"), name)(), value)


def write_rosbag(path, messages, compression="none", chunk_bytes=300_000, **options):
    try:
        import genpy
        import rosbag
    except ImportError:
        raise unittest.SkipTest("python3-rosbag is not installed") from None
    with rosbag.Bag(str(path), "w", compression, chunk_bytes, **options) as bag:
        for topic, kind, value, time_ns in messages:
            time = genpy.Time(0, 0) + genpy.Duration(*divmod(time_ns, 10**9))
            if isinstance(value, bytes):  # packed already; who reads it goes by the type's name
                definition = type("Definition", (), {"_full_text": "", "_md5sum": "0" * 32})
                bag.write(topic, (kind, bytes(value), "0" * 32, 0, definition), time, raw=True)
            else:
                bag.write(topic, ros1_message(kind, value), time)
    return path


class Node:
    """Runs write_mcap.mjs and read_mcap.mjs; installs what it needs on first use."""

    def __init__(self, folder, scratch):
        self.folder, self.scratch = folder, scratch

    def ready(self):
        if not shutil.which("node"):
            raise unittest.SkipTest("node is not installed")
        if not (self.folder / "node_modules/@mcap/core").exists():
            if not shutil.which("npm"):
                raise unittest.SkipTest("npm is not installed")
            self.folder.mkdir(parents=True, exist_ok=True)
            for name in ("package.json", "package-lock.json"):
                shutil.copy(HERE / name, self.folder)
            done = subprocess.run(
                ["npm", "ci", "--ignore-scripts", "--no-audit", "--no-fund"],
                cwd=self.folder,
                capture_output=True,
                text=True,
                timeout=600,
            )
            if done.returncode != 0:
                raise unittest.SkipTest(f"npm could not install @mcap/core: {done.stderr[-300:]}")
        # Beside node_modules, where their imports are looked for.
        for name in ("write_mcap.mjs", "read_mcap.mjs"):
            shutil.copy(HERE / name, self.folder)

    def file(self, data):
        self.count = getattr(self, "count", 0) + 1
        path = self.scratch / f"blob{self.count}"
        path.write_bytes(data)
        return str(path)

    def ros2_value(self, value):
        if isinstance(value, bytes):
            return {"$file": self.file(value)}
        if isinstance(value, list):
            return [self.ros2_value(part) for part in value]
        if isinstance(value, dict):
            names = {"D": "d", "K": "k", "R": "r", "P": "p"}
            return {names.get(key, key): self.ros2_value(part) for key, part in value.items()}
        return value

    def run(self, messages, cdr=True, compression="", mcap=None, blobs=None):
        self.ready()
        if compression and not shutil.which(compression):
            raise unittest.SkipTest(f"{compression} is not installed")
        entries = []
        for topic, kind, value, time_ns in messages:
            entry = {"topic": topic, "time_ns": str(time_ns)}
            if cdr:
                entry["type"] = kind.replace("/", "/msg/")
                entry["value"] = self.ros2_value(value)
            else:
                import io

                packed = io.BytesIO()
                ros1_message(kind, value).serialize(packed)
                entry["type"] = kind
                entry["file"] = self.file(packed.getvalue())
            entries.append(entry)
        plan = self.scratch / "plan.json"
        plan.write_text(
            json.dumps(
                {
                    "cdr": cdr,
                    "compression": compression,
                    "mcap": str(mcap) if mcap else None,
                    "blobs": str(blobs) if blobs else None,
                    "messages": entries,
                }
            )
        )
        done = subprocess.run(
            ["node", self.folder / "write_mcap.mjs", plan],
            capture_output=True,
            text=True,
            timeout=300,
        )
        assert done.returncode == 0, done.stderr
        for path in self.scratch.glob("blob*"):
            path.unlink()

    def write_mcap(self, path, messages, **options):
        self.run(messages, mcap=path, **options)
        return path

    def read_mcap(self, path):
        self.ready()
        done = subprocess.run(
            ["node", self.folder / "read_mcap.mjs", path],
            capture_output=True,
            text=True,
            timeout=300,
        )
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    def pack_cdr(self, messages):
        path = self.scratch / "packed"
        self.run(messages, blobs=path)
        data, at, packed = path.read_bytes(), 0, []
        while at < len(data):
            (length,) = struct.unpack_from("<I", data, at)
            packed.append(data[at + 4 : at + 4 + length])
            at += 4 + length
        return packed


def write_db3(path, messages, packed, journal="delete"):
    """A file of rosbag2's SQLite storage; `packed` are the messages as CDR."""
    base = sqlite3.connect(path)
    base.execute(f"PRAGMA journal_mode={journal}")
    base.execute(
        "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
        "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL)"
    )
    base.execute(
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, "
        "timestamp INTEGER NOT NULL, data BLOB NOT NULL)"
    )
    base.execute("CREATE INDEX timestamp_idx ON messages (timestamp ASC)")
    ids = {}
    for (topic, kind, _, time_ns), data in zip(messages, packed):
        if topic not in ids:
            ids[topic] = len(ids) + 1
            base.execute(
                "INSERT INTO topics VALUES (?, ?, ?, 'cdr', '')",
                (ids[topic], topic, kind.replace("/", "/msg/")),
            )
        base.execute(
            "INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)",
            (ids[topic], time_ns, data),
        )
    base.commit()
    base.close()
    return path


def write_metadata(folder, files, storage="sqlite3", mode=""):
    """The metadata.yaml of rosbag2, as far as a reader needs it."""
    names = "".join(f"    - {name}\n" for name in files)
    (folder / "metadata.yaml").write_text(
        "rosbag2_bagfile_information:\n"
        "  version: 5\n"
        f"  storage_identifier: {storage}\n"
        f"  relative_file_paths:\n{names}"
        '  compression_format: "zstd"\n'
        f'  compression_mode: "{mode}"\n'
    )
