# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""What programs in Python that read a camera share.

A family's program gives two functions to main(): `find()` says what is plugged in, `play(options,
stream)` opens a camera and sends its frames. What such a program is started with, what it writes and
says is described in docs/cameras.md ("A family of your own"), the bytes in docs/stream.md.
"""
import argparse
import collections
import json
import math
import os
import queue
import struct
import sys
import threading
import time


class Trouble(Exception):
    """Why a camera cannot be used, and what to do about it. `usage`: it was asked for wrongly."""

    def __init__(self, message, remedy="", usage=False):
        super().__init__(message)
        self.remedy, self.usage = remedy, usage


def say(kind, text):
    """A line for people: kind is note, error or remedy."""
    print(f"{kind}: {' '.join(str(text).split())}", file=sys.stderr, flush=True)


def pinhole(width, height, fx, fy, cx, cy, **lens):
    """A camera as the greeting has it; `lens`: distortion, and lens="fisheye"."""
    return dict(width=width, height=height, fx=fx, fy=fy, cx=cx, cy=cy, **lens)


def scaled(camera, width, height):
    """The same view in images of another size; pixel centres are whole numbers."""
    x, y = width / camera["width"], height / camera["height"]
    return {
        **camera,
        "width": width,
        "height": height,
        "fx": x * camera["fx"],
        "fy": y * camera["fy"],
        "cx": x * (camera["cx"] + 0.5) - 0.5,
        "cy": y * (camera["cy"] + 0.5) - 0.5,
    }


class Stream:
    """Frames on their way to `sgs`. Everything but `stopped` is for one thread."""

    def __init__(self, output, options):
        self.output, self.options = output, options
        self.stopped = threading.Event()
        self.skipped = self.sent = 0

    def greet(self, camera, **more):
        """Once, before the first frame. `camera`, and depth_camera in `more`: see pinhole()."""
        greeting = dict(camera=camera, clock="device", listens=self.options.listen, **more)
        self._write(b"SGS3", greeting)

    def frame(self, t, color, depth, **more):
        """A frame as arrays whose bytes are those of the greeting; the first `skip` are left out.

        t: seconds, when colour was taken; `more`: depth_t, exposure_s and what else is known.
        """
        if self.skipped < self.options.skip:
            self.skipped += 1
            return
        color, depth = color.tobytes(), depth.tobytes()
        sizes = dict(color_bytes=len(color), depth_bytes=len(depth))
        self._write(b"F", dict(t=t, **sizes, **more), color, depth)
        self.sent += 1
        if self.sent == self.options.frames:
            self.stopped.set()

    def samples(self, rows):
        """Inertial samples: rows of t, angular velocity x y z (rad/s), acceleration x y z (m/s2)."""
        packed = b"".join(struct.pack("<7d", *row) for row in rows)
        self.output.write(b"I" + struct.pack("<I", len(packed)) + packed)

    def end(self):
        self.output.write(b"E")
        self.output.flush()

    def _write(self, mark, head, *data):
        text = json.dumps(head).encode()
        self.output.write(mark + struct.pack("<I", len(text)) + text + b"".join(data))
        self.output.flush()


class Inbox:
    """Images that another thread delivers, for the one that sends: a few, then the oldest is dropped,
    or, if `every` is true, the other thread waits."""

    MOST = 4

    def __init__(self, every):
        self.every, self.dropped = every, 0
        self.waiting = queue.Queue(maxsize=self.MOST)

    def put(self, item, stopped):
        while not stopped.is_set():
            try:
                self.waiting.put(item, timeout=0.1 if self.every else 0)
                return
            except queue.Full:
                if not self.every:
                    self._drop()

    def _drop(self):
        try:
            self.waiting.get_nowait()
        except queue.Empty:
            return
        if self.dropped == 0:
            say("note", "images come faster than they are taken: some are dropped")
        self.dropped += 1

    def get(self, seconds):
        """The next one; None if nothing comes for so long."""
        try:
            return self.waiting.get(timeout=seconds)
        except queue.Empty:
            return None


class Pairs:
    """Each depth image with the nearest colour image, at most 0.6 of a period away: what is nearer
    cannot be missing."""

    MOST_APART, MOST_WAITING = 0.6, 8

    def __init__(self, fps):
        self.period_s = 1 / fps
        self.waiting = {"color": collections.deque(), "depth": collections.deque()}
        self.last = dict.fromkeys(self.waiting, -math.inf)

    def behind(self):
        """Of which kind an image has to come next: "color" or "depth"."""
        return min(self.last, key=self.last.get)

    def add(self, kind, t, image):
        back_s = self.last[kind] - t
        if 0 <= back_s < 1:
            return  # it comes twice
        if back_s >= 1:  # the clock was set back; whoever reads the stream moves the times
            for images in self.waiting.values():
                images.clear()
            self.last = dict.fromkeys(self.last, -math.inf)
        self.last[kind] = t
        self.waiting[kind].append((t, image))
        if len(self.waiting[kind]) > self.MOST_WAITING:
            self.waiting[kind].popleft()

    def next(self):
        """((time, colour), (time, depth)), or None as long as it is not certain."""
        colors, depths = self.waiting.values()
        while colors and depths:
            t = depths[0][0]
            nearest = min(colors, key=lambda color: abs(color[0] - t))
            apart = abs(nearest[0] - t)
            if colors[-1][0] < t and apart >= self.period_s / 2:
                return None
            depth = depths.popleft()
            if apart <= self.MOST_APART * self.period_s:
                while colors.popleft() is not nearest:
                    pass
                return nearest, depth
        return None


class _Parser(argparse.ArgumentParser):
    def error(self, message):
        raise Trouble(message, "--help lists the options", usage=True)


def _size(text):
    width, mark, height = text.partition("x")
    if not (mark and width.isdecimal() and height.isdecimal() and int(width) and int(height)):
        raise argparse.ArgumentTypeError(f"'{text}' is no size, such as 640x480")
    return int(width), int(height)


def _count(text):
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"'{text}' is no number")
    return int(text)


def _parse(what, add_options):
    parser = _Parser(description=what, allow_abbrev=False)
    on_or_off = dict(choices=("on", "off"))
    parser.add_argument("--list", action="store_true", help="print what is plugged in, as JSON")
    parser.add_argument("--listen", action="store_true", help="take lines from standard input")
    parser.add_argument("--serial", default="", help="of the camera; default: the first one")
    parser.add_argument("--size", type=_size, help="of the images, such as 640x480")
    parser.add_argument("--fps", type=_count, default=30, help="images a second")
    parser.add_argument("--skip", type=_count, default=15, help="first frames left out")
    parser.add_argument("--frames", type=_count, default=0, help="end after so many; 0: never")
    parser.add_argument("--imu", default="on", help="send inertial samples", **on_or_off)
    parser.add_argument("--every", default="off", help="wait rather than drop", **on_or_off)
    if add_options:
        add_options(parser)
    options = parser.parse_args()
    if options.fps == 0:
        raise Trouble("--fps 0: no rate", usage=True)
    options.imu, options.every = options.imu == "on", options.every == "on"
    return options


def _listen(stream):
    """Lines from `sgs`; the end of its input is a stop, too."""
    for line in sys.stdin:
        if line.strip() == "stop":
            break
        if line.strip() == "lock_exposure":
            say("note", "exposure is not locked: this program cannot")
    stream.stopped.set()
    time.sleep(2)  # a library that hangs while it is asked to stop must not keep the camera
    os._exit(1)


def _list(find, output):
    answer = dict(library="", devices=[])
    try:
        answer["library"], answer["devices"] = find()
    except Trouble as trouble:
        answer["problem"] = dict(message=str(trouble), remedy=trouble.remedy)
    output.write(json.dumps(answer).encode() + b"\n")
    output.flush()


def main(what, find, play, add_options=None):
    """The whole program; ends the process.

    find() -> (library and version, [{"name", "serial", "firmware", "connection"}]); play(options,
    stream) sends until stream.stopped is set. Both raise Trouble. add_options(parser): further ones.
    """
    # Standard output for frames alone; libraries that print there do so to standard error.
    output = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    code = 0
    try:
        options = _parse(what, add_options)
        if options.list:
            _list(find, output)
        else:
            stream = Stream(output, options)
            if options.listen:
                threading.Thread(target=_listen, args=(stream,), daemon=True).start()
            play(options, stream)
            stream.end()
    except (KeyboardInterrupt, BrokenPipeError):
        pass  # nobody reads any more
    except Trouble as trouble:
        say("error", trouble)
        if trouble.remedy:
            say("remedy", trouble.remedy)
        code = 2 if trouble.usage else 1
    sys.stderr.flush()
    os._exit(code)  # threads of a library may still be there
