#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Converts a Record3D capture (.r3d) into a folder that `sgs run` reads (transforms.json).

    python3 record3d_to_transforms.py CAPTURE.r3d OUT

Record3D compresses depth with Apple's LZFSE, which needs `pip install pyliblzfse`. Pictures are
copied as they are, depth becomes 16-bit PNG in millimetres, measurements of low confidence are left
out. OUT must not exist; it appears when everything is there.
"""
import argparse
import json
import math
import os
import pathlib
import shutil
import struct
import sys
import zipfile
import zlib

import numpy as np

LARGEST_ENTRY = 64 << 20  # bytes of one packed or unpacked file of the capture
LARGEST_SIDE = 8192
MILLIMETRES = 1000
LZFSE_END = b"bvx$"


class BadCapture(Exception):
    pass


def read_entry(archive, name):
    """A file of the archive; what announces more than a frame can hold is refused unread."""
    try:
        entry = archive.getinfo(name)
    except KeyError:
        raise BadCapture(f"{name} is missing") from None
    if entry.file_size > LARGEST_ENTRY:
        raise BadCapture(f"{name} would unpack to {entry.file_size} bytes")
    with archive.open(entry) as stream:
        content = stream.read(LARGEST_ENTRY + 1)
    if len(content) > LARGEST_ENTRY:
        raise BadCapture(f"{name} unpacks to more than it says")
    return content


def announced_bytes(packed):
    """The sum of what the blocks of an LZFSE stream say they hold; walks over their headers.

    Block layout: github.com/lzfse/lzfse, the header structures of its reference implementation.
    """
    total = at = 0
    while packed[at : at + 4] != LZFSE_END:
        kind = packed[at : at + 4]
        if len(packed) < at + 12 or kind not in (b"bvx-", b"bvxn", b"bvx1", b"bvx2"):
            raise BadCapture("damaged LZFSE stream")
        total += struct.unpack_from("<I", packed, at + 4)[0]
        if total > LARGEST_ENTRY:
            raise BadCapture("depth would unpack to more than a frame can hold")
        if kind == b"bvx-":
            at += 8 + struct.unpack_from("<I", packed, at + 4)[0]
        elif kind == b"bvxn":
            at += 12 + struct.unpack_from("<I", packed, at + 8)[0]
        else:
            return total  # later blocks have packed headers; the decoder stops at the frame's size
    return total


def unpack(packed, size):
    """`size` bytes out of an LZFSE stream, or as they are."""
    if len(packed) == size:
        return packed
    if announced_bytes(packed) > size:
        raise BadCapture("depth unpacks to more than its image")
    if packed[:4] == b"bvx-":  # stored, not compressed
        length = struct.unpack_from("<I", packed, 4)[0]
        if length == size and packed[8 + length : 12 + length] == LZFSE_END:
            return packed[8 : 8 + length]
    try:
        import liblzfse
    except ImportError:
        raise BadCapture("depth is compressed with LZFSE; `pip install pyliblzfse`") from None
    content = liblzfse.decompress(packed)
    if len(content) != size:
        raise BadCapture(f"depth has {len(content)} bytes where {size} make an image")
    return content


def png16(image):
    height, width = image.shape
    rows = np.zeros((height, 1 + 2 * width), np.uint8)
    rows[:, 1:] = image.astype(">u2").view(np.uint8).reshape(height, 2 * width)
    chunks = (
        (b"IHDR", struct.pack(">IIBBBBB", width, height, 16, 0, 0, 0, 0)),
        (b"IDAT", zlib.compress(rows.tobytes())),
        (b"IEND", b""),
    )
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(d)) + k + d + struct.pack(">I", zlib.crc32(k + d)) for k, d in chunks
    )


def pose_matrix(pose):
    """Camera to world, OpenGL axes; None for what is no pose."""
    x, y, z, w, *position = (float(v) for v in pose)
    length = math.sqrt(x * x + y * y + z * z + w * w)
    if len(position) != 3 or not abs(length - 1) < 1e-2:
        return None
    x, y, z, w = (v / length for v in (x, y, z, w))
    return [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), position[0]],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), position[1]],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), position[2]],
        [0, 0, 0, 1],
    ]


def frame_camera(meta, index):
    """Values for transforms.json, whose pixel centres lie at halves; K is column by column."""
    own = meta.get("perFrameIntrinsicCoeffs") or []
    if index < len(own):
        fx, fy, cx, cy = own[index][:4]
    else:
        K = meta["K"]
        fx, fy, cx, cy = K[0], K[4], K[6], K[7]
    return dict(fl_x=fx, fl_y=fy, cx=cx + 0.5, cy=cy + 0.5)


def depth_image(archive, meta, number):
    width, height = int(meta["dw"]), int(meta["dh"])
    if not (0 < width <= LARGEST_SIDE and 0 < height <= LARGEST_SIDE):
        raise BadCapture(f"depth of {width}x{height} pixels cannot be")
    packed = read_entry(archive, f"rgbd/{number}.depth")
    metres = np.frombuffer(unpack(packed, 4 * width * height), "<f4").reshape(height, width)
    with np.errstate(invalid="ignore"):
        raw = np.round(metres.astype(float) * MILLIMETRES)
        raw = np.where((raw > 0) & (raw < 65535), raw, 0).astype(np.uint16)
    name = f"rgbd/{number}.conf"
    if name in archive.namelist():
        sure = np.frombuffer(unpack(read_entry(archive, name), width * height), np.uint8)
        raw[sure.reshape(height, width) == 0] = 0
    return raw


def convert(archive, out):
    meta = json.loads(read_entry(archive, "metadata"))
    numbers = sorted(
        int(pathlib.PurePosixPath(name).stem)
        for name in archive.namelist()
        if name.startswith("rgbd/") and name.endswith(".jpg")
    )
    if not numbers:
        raise BadCapture("no pictures in it")
    times = meta.get("frameTimestamps") or [i / float(meta.get("fps", 30)) for i in numbers]
    poses = meta.get("poses") or []
    (out / "images").mkdir(parents=True)
    (out / "depths").mkdir()
    frames = []
    for index, number in enumerate(numbers):
        (out / f"images/{number}.jpg").write_bytes(read_entry(archive, f"rgbd/{number}.jpg"))
        (out / f"depths/{number}.png").write_bytes(png16(depth_image(archive, meta, number)))
        frame = dict(
            file_path=f"images/{number}.jpg",
            depth_file_path=f"depths/{number}.png",
            w=int(meta["w"]),
            h=int(meta["h"]),
            **frame_camera(meta, index),
        )
        if index < len(times):
            frame["timestamp"] = float(times[index])
        matrix = pose_matrix(poses[index]) if index < len(poses) else None
        if matrix:
            frame["transform_matrix"] = matrix
        frames.append(frame)
    document = dict(camera_model="OPENCV", depth_unit_scale_factor=1 / MILLIMETRES, frames=frames)
    (out / "transforms.json").write_text(json.dumps(document, indent=1))
    return len(frames)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("capture", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    arguments = parser.parse_args()
    if arguments.out.exists():
        sys.exit(f"{arguments.out}: exists; give a new folder")
    part = arguments.out.with_name(f"{arguments.out.name}.part-{os.getpid()}")
    try:
        with zipfile.ZipFile(arguments.capture) as archive:
            count = convert(archive, part)
        part.rename(arguments.out)
    except (BadCapture, OSError, zipfile.BadZipFile, KeyError, ValueError, TypeError) as error:
        sys.exit(f"{arguments.capture}: {error}")
    finally:
        shutil.rmtree(part, ignore_errors=True)
    print(f"{arguments.out}: {count} frames; `sgs run {arguments.out}`")


if __name__ == "__main__":
    main()
