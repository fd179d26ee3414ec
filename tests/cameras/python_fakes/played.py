# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""The rendered scene for fakes of Python packages, as fake_cameras.write_scene() leaves it. Variants
come by the environment: FAKE_CAMERA_..."""
import os
import pathlib
import struct
import types

import numpy as np


def variant(name, otherwise=""):
    return os.environ.get("FAKE_CAMERA_" + name.upper(), otherwise)


def _camera(line):
    width, height, fx, fy, cx, cy = (float(word) for word in line.split()[:6])
    return types.SimpleNamespace(width=int(width), height=int(height), fx=fx, fy=fy, cx=cx, cy=cy)


class Scene:
    def __init__(self):
        with open(variant("scene"), "rb") as file:
            lines = [file.readline().decode() for _ in range(4)]
            self.color, self.depth = _camera(lines[0]), _camera(lines[1])
            self.count = int(lines[3].split()[1])
            self.frames = [self._frame(file) for _ in range(self.count)]
        self.next_file = pathlib.Path(variant("state")) / "next"

    def _frame(self, file):
        image = lambda camera: camera.width * camera.height
        (t_ms,) = struct.unpack("<d", file.read(8))
        color = np.frombuffer(file.read(3 * image(self.color)), np.uint8)
        depth = np.frombuffer(file.read(2 * image(self.depth)), "<u2")
        return (
            t_ms / 1000,
            color.reshape(self.color.height, self.color.width, 3),
            depth.reshape(self.depth.height, self.depth.width),
        )

    def played(self):
        return int(self.next_file.read_text()) if self.next_file.exists() else 0

    def take(self):
        """The next frame, from where the last process stopped; None behind the last one."""
        k = self.played()
        if k >= self.count:
            return None
        # Whole at any time: the process ends when it likes, and the test reads meanwhile.
        written = self.next_file.with_name("written")
        written.write_text(str(k + 1))
        written.replace(self.next_file)
        return self.frames[k]

    def unplugged(self):
        """Whether the cable has come off, once."""
        at, mark = variant("unplug"), self.next_file.with_name("unplugged")
        if not at or self.played() != int(at) or mark.exists():
            return False
        mark.touch()
        return True


def serials():
    text = variant("devices", "0123")
    return [] if text == "none" else text.split(",")
