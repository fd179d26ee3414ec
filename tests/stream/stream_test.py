# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Frames over a socket and through pipes: `sgs run live:...` against files, and against bad senders.

Usage: stream_test.py SGS_EXECUTABLE [unittest arguments]

`Sender` is written from docs/stream.md and shares no code with the program.
"""
import json
import os
import pathlib
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
import unittest

import numpy as np
from skimage.io import imread

SGS = pathlib.Path(sys.argv.pop(1)).resolve()
FRAMES = 12
TIMEOUT = 240
TRACK = ("--set", "mapper.iterations_per_frame=0", "--no-eval", "--quiet")


class Sender:
    """The protocol, by its document."""

    def __init__(self, write):
        self.write = write

    def part(self, mark, header, *data):
        text = json.dumps(header).encode()
        self.write(mark + struct.pack("<I", len(text)) + text + b"".join(data))

    def hello(self, camera, mark=b"SGS1", **more):
        width, height = camera[4:6]
        numbers = dict(zip(("fx", "fy", "cx", "cy"), camera))
        self.part(mark, dict(camera=dict(numbers, width=width, height=height), **more))

    def frame(self, t, color, depth):
        self.part(b"F", dict(t=t, color_bytes=len(color), depth_bytes=len(depth)), color, depth)

    def frame_with_mask(self, t, color, depth, mask):
        sizes = dict(color_bytes=len(color), depth_bytes=len(depth), mask_bytes=len(mask))
        self.part(b"F", dict(t=t, **sizes), color, depth, mask)

    def end(self):
        self.write(b"E")


def rows(path):
    lines = path.read_text().splitlines()
    return [line.split() for line in lines if line and not line.startswith("#")]


class StreamTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.shared = pathlib.Path(tempfile.mkdtemp(prefix="sgs-stream-"))
        cls.recording = cls.shared / "recording"
        command = [SGS, "synth", "room_desk", cls.recording, "--frames", str(FRAMES), "--quiet"]
        subprocess.run(command, check=True, capture_output=True)
        cls.reference = cls.shared / "reference"
        command = [SGS, "run", cls.recording, "-o", cls.reference, "--no-eval", "--quiet"]
        subprocess.run(command, check=True, capture_output=True, cwd=cls.shared)
        values = [float(v) for v in rows(cls.recording / "camera.txt")[0]]
        cls.camera = [*values[:4], int(values[4]), int(values[5])]
        cls.depth_scale = values[6]
        cls.frames = [
            (float(color[0]), imread(cls.recording / color[1]), imread(cls.recording / depth[1]))
            for color, depth in zip(
                rows(cls.recording / "rgb.txt"), rows(cls.recording / "depth.txt")
            )
        ]

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.shared, ignore_errors=True)

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="case-", dir=self.shared))
        self.run_folder = self.folder / "run"
        self.said = ""

    def start(self, source, *options, **pipes):
        """`sgs run`; for TCP its port is returned, too."""
        patience = () if "--wait" in options else ("--wait", "600")
        process = subprocess.Popen(
            [SGS, "run", source, "-o", self.run_folder, *patience, *options],
            cwd=self.folder,
            stderr=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            **pipes,
        )
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.kill)
        if not source.startswith("live:tcp"):
            return process
        said = self.wait_for(process, "waiting for a sender")
        return process, int(re.search(r"127\.0\.0\.1:(\d+): waiting", said)[1])

    def wait_for(self, process, text):
        """The line of the terminal that holds `text`."""
        for line in process.stderr:
            self.said += line.decode()
            if text in line.decode():
                return line.decode()
        self.fail(f"never said: {text}\n{self.said}")

    def wait_for_state(self, process, text):
        """Until state.toml says `text`: it is written after the line of the terminal."""
        while text not in (self.run_folder / "state.toml").read_text():
            self.assertIsNone(process.poll(), f"never in the state: {text}")
            time.sleep(0.01)

    def finish(self, process, code=0):
        """All that the run said on the terminal."""
        self.said += process.stderr.read().decode()
        process.wait(timeout=TIMEOUT)
        self.assertEqual(process.returncode, code, self.said)
        return self.said

    def connect(self, port):
        connection = socket.create_connection(("127.0.0.1", port))
        self.addCleanup(connection.close)
        return connection, Sender(connection.sendall)

    def send_frames(self, sender, first=0, last=FRAMES):
        for t, color, depth in self.frames[first:last]:
            sender.frame(t, color.tobytes(), depth.astype("<u2").tobytes())

    def u16(self):
        return dict(depth="u16", depth_scale=self.depth_scale, name="by hand")

    def assert_same_run(self):
        for name in "trajectory.txt", "map.ply":
            mine, theirs = ((f / name).read_bytes() for f in (self.run_folder, self.reference))
            self.assertEqual(mine, theirs, name)

    def log(self):
        return (self.run_folder / "log.txt").read_text()

    def send(self, *arguments, code=0):
        done = subprocess.run(
            [SGS, "send", *arguments, "--quiet"], capture_output=True, text=True, timeout=TIMEOUT
        )
        self.assertEqual(done.returncode, code, done.stderr)
        return done.stderr


class Equal(StreamTest):
    """What is sent gives the same bits as what lies in a folder."""

    def test_sgs_send_over_tcp(self):
        process, port = self.start("live:tcp://127.0.0.1:0", "--no-eval")
        self.send(self.recording, f"live:tcp://127.0.0.1:{port}")
        self.finish(process)
        self.assert_same_run()

    def test_a_sender_written_from_the_document(self):
        process, port = self.start("live:tcp://127.0.0.1:0", "--no-eval")
        connection, sender = self.connect(port)
        sender.hello(self.camera, **self.u16())
        self.assertEqual(connection.recv(100), b"ok\n")
        self.send_frames(sender)
        sender.end()
        self.assertEqual(connection.recv(100), b"done\n")
        self.finish(process)
        self.assert_same_run()

    def test_standard_output_to_standard_input(self):
        sending = subprocess.Popen(
            [SGS, "send", self.recording, "live:-", "--quiet"], stdout=subprocess.PIPE
        )
        process = self.start("live:-", "--no-eval", stdin=sending.stdout)
        sending.stdout.close()
        self.finish(process)
        self.assertEqual(sending.wait(timeout=TIMEOUT), 0)
        self.assert_same_run()

    def test_named_pipe(self):
        pipe = self.folder / "pipe"
        os.mkfifo(pipe)
        process = self.start(f"live:{pipe}", "--no-eval")
        self.send(self.recording, f"live:{pipe}")
        self.finish(process)
        self.assert_same_run()

    def test_what_was_recorded_on_the_way_gives_the_same_run(self):
        process, port = self.start("live:tcp://127.0.0.1:0", "--no-eval", "--record", "kept")
        self.send(self.recording, f"live:tcp://127.0.0.1:{port}")
        self.finish(process)
        again = self.folder / "again"
        subprocess.run(
            [SGS, "run", self.folder / "kept", "-o", again, "--no-eval", "--quiet"],
            check=True,
            capture_output=True,
            cwd=self.folder,
        )
        mine, theirs = ((f / "trajectory.txt").read_text() for f in (again, self.reference))
        self.assertEqual(mine, theirs)

    def test_poses_come_with_the_frames(self):
        process, port = self.start("live:tcp://127.0.0.1:0", "--no-eval", "--tracker", "given")
        self.send(self.recording, f"live:tcp://127.0.0.1:{port}", "--poses", "recorded")
        self.finish(process)
        truth = np.array(rows(self.recording / "groundtruth.txt"), float)
        mine = np.array(rows(self.run_folder / "trajectory.txt"), float)
        self.assertEqual(len(mine), FRAMES)
        np.testing.assert_allclose(mine[:, 1:4], truth[:FRAMES, 1:4], atol=1e-6)


class Trouble(StreamTest):
    """Everything that goes wrong is said, and nothing of it harms the run."""

    def test_a_sender_that_goes_away_and_comes_back(self):
        process, port = self.start("live:tcp://127.0.0.1:0", *TRACK[:3], "--trace", "trace.json")
        first, sender = self.connect(port)
        sender.hello(self.camera, **self.u16())
        self.send_frames(sender, 0, 5)
        first.shutdown(socket.SHUT_WR)
        self.assertEqual(first.recv(100), b"ok\n")
        while first.recv(100):  # until the other end has noticed
            pass
        _, sender = self.connect(port)
        sender.hello(self.camera, **self.u16())
        self.send_frames(sender, 5)
        sender.end()
        said = self.finish(process)
        for text in said, self.log(), (self.folder / "trace.json").read_text():
            self.assertIn("went away without saying that it was done", text)
            self.assertIn("a sender is there again", text)
        self.assertEqual(len(rows(self.run_folder / "trajectory.txt")), FRAMES)

    def test_a_sender_that_never_comes_back(self):
        process, port = self.start("live:tcp://127.0.0.1:0", *TRACK[:3], "--wait", "0.5")
        connection, sender = self.connect(port)
        sender.hello(self.camera, **self.u16())
        self.assertEqual(connection.recv(100), b"ok\n")  # unread, it would make closing a reset
        self.send_frames(sender, 0, 6)
        connection.close()
        said = self.finish(process, code=1)
        self.assertIn("no sender for 0.5 s", said)
        state = (self.run_folder / "state.toml").read_text()
        self.assertIn('state = "interrupted"', state)
        self.assertIn("no sender for 0.5 s", state)
        self.assertEqual(len(rows(self.run_folder / "trajectory.txt")), 6)
        self.assertGreater((self.run_folder / "map.ply").stat().st_size, 1000)

    def test_silence_stands_in_the_state_until_it_ends(self):
        process, port = self.start("live:tcp://127.0.0.1:0", *TRACK[:3])
        _, sender = self.connect(port)
        sender.hello(self.camera, **self.u16())
        self.send_frames(sender, 0, 3)
        self.wait_for(process, "no frame for")
        self.wait_for_state(process, "no frame for")
        self.send_frames(sender, 3)
        sender.end()
        self.assertIn("frames come again", self.finish(process))
        self.assertNotIn("no frame for", (self.run_folder / "state.toml").read_text())

    def test_hostile_clients(self):
        process, port = self.start("live:tcp://127.0.0.1:0", *TRACK[:3])
        for attack in (
            b"GET / HTTP/1.1\r\nHost: x\r\n\r\n",
            b"SGS1\xff\xff\xff\x7f",
            b"SGS1\x02\0\0\0{}",
            b"SGS1\x10\0\0\0" + b"[" * 16,
            bytes(range(256)) * 40,
        ):
            connection, _ = self.connect(port)
            connection.sendall(attack)
            self.assertTrue(connection.recv(1000).startswith(b"refused "), attack[:20])
        connection, sender = self.connect(port)
        sender.hello([1e300, 1, 0, 0, 10**9, 10**9])
        self.assertTrue(connection.recv(1000).startswith(b"refused "))
        silent = [self.connect(port)[0] for _ in range(4)]
        connection, sender = self.connect(port)
        sender.hello(self.camera, **self.u16())
        self.assertEqual(connection.recv(100), b"ok\n")
        sender.part(b"F", dict(t=0, color_bytes=2**31, depth_bytes=0))
        self.assertTrue(connection.recv(1000).startswith(b"refused "), "size")
        connection, sender = self.connect(port)
        sender.hello(self.camera, **self.u16())
        self.send_frames(sender)
        sender.end()
        self.assertEqual(connection.recv(3), b"ok\n")
        self.finish(process)
        self.assertEqual(len(rows(self.run_folder / "trajectory.txt")), FRAMES)
        del silent

    def test_bad_frames_are_left_out_with_a_reason(self):
        process, port = self.start("live:tcp://127.0.0.1:0", *TRACK[:3])
        _, sender = self.connect(port)
        sender.hello(self.camera, **self.u16())
        self.send_frames(sender, 0, 4)
        self.send_frames(sender, 2, 3)
        sender.frame(self.frames[4][0], b"short", b"")
        self.send_frames(sender, 4)
        sender.end()
        said = self.finish(process)
        self.assertIn("came too late", said)
        self.assertIn("colour has 5 bytes", said)
        table = (self.run_folder / "frames.csv").read_text()
        self.assertEqual(len(re.findall(r",bad", table)), 2)
        self.assertEqual(len(rows(self.run_folder / "trajectory.txt")), FRAMES)

    def run_with_masks(self, mask_of, code=0):
        """All that is said of the recording's frames with masks; those are functions of the index."""
        self.said = ""
        process, port = self.start("live:tcp://127.0.0.1:0", "--no-eval")
        _, sender = self.connect(port)
        sender.hello(self.camera, mark=b"SGS3", **self.u16())
        for index, (time_s, color, depth) in enumerate(self.frames):
            mask = mask_of(index, np.zeros(depth.shape, np.uint8))
            raw = depth.astype("<u2").tobytes()
            sender.frame_with_mask(time_s, color.tobytes(), raw, mask.tobytes())
        sender.end()
        return self.finish(process, code)

    def test_masks_that_mark_nothing_change_nothing(self):
        self.run_with_masks(lambda index, mask: mask)
        self.assert_same_run()
        self.assertFalse((self.run_folder / "movers.txt").exists())

    def test_what_a_mask_marks_is_left_out(self):
        def right_third(index, mask):
            mask[:, 400:] = 0 if index == 5 else 255
            return mask

        self.run_with_masks(right_third)
        table = (self.run_folder / "frames.csv").read_text().splitlines()
        names = table[0].split(",")
        self.assertNotIn("lost", [row.split(",")[names.index("status")] for row in table[1:]])
        moved = [float(row.split(",")[names.index("movers")] or 0) for row in table[1:]]
        for index, share in enumerate(moved[1:], start=1):
            self.assertAlmostEqual(share, 0 if index == 5 else 240 / 640, delta=0.01)
        marked = rows(self.run_folder / "movers.txt")
        self.assertEqual([int(row[0]) for row in marked], [*range(5), *range(6, FRAMES)])
        squares = np.unpackbits(
            np.frombuffer(bytes.fromhex(marked[0][1]), np.uint8), bitorder="little"
        )
        self.assertTrue((squares.reshape(60, 80)[:, :50] == 0).all())
        self.assertTrue((squares.reshape(60, 80)[:, 50:] == 1).all())

    def test_masks_the_other_way_round_are_told(self):
        def somebody_small(index, mask):
            mask[:] = 255
            mask[:, :128] = 0
            return mask

        said = self.run_with_masks(somebody_small)
        self.assertEqual(said.count("are they the other way round?"), 1)

    def test_masks_by_which_all_moves_are_no_frames(self):
        said = self.run_with_masks(lambda index, mask: mask + (index == 6))
        self.assertIn("by its mask all of the picture moves", said)
        self.assertEqual(len(rows(self.run_folder / "trajectory.txt")), FRAMES - 1)

    def run_by_times(self, times, code):
        """All that is said of the recording's frames with other times."""
        self.said = ""
        process, port = self.start("live:tcp://127.0.0.1:0", *TRACK[:3])
        _, sender = self.connect(port)
        sender.hello(self.camera, **self.u16())
        for time_s, (_, color, depth) in zip(times, self.frames):
            sender.frame(time_s, color.tobytes(), depth.astype("<u2").tobytes())
        sender.end()
        return self.finish(process, code)

    def test_times_in_another_unit_are_told(self):
        said = self.run_by_times([1_700_000_000_000 + 33 * i for i in range(FRAMES)], code=0)
        self.assertEqual(said.count("milliseconds"), 1)
        # As the message asks for.
        said = self.run_by_times([1_700_000_000 + 0.033 * i for i in range(FRAMES)], code=0)
        self.assertNotIn("look like", said)

    def test_a_stream_of_which_one_frame_could_be_used_is_no_run(self):
        said = self.run_by_times([5] * FRAMES, code=3)
        self.assertIn(f"only 1 of {FRAMES} colour images became frames: it came too late", said)

    def test_a_greeting_without_a_camera_is_told_what_to_say(self):
        process, port = self.start("live:tcp://127.0.0.1:0", *TRACK[:3], "--wait", "0.5")
        connection, sender = self.connect(port)
        sender.part(b"SGS1", dict(color="rgb8"))
        words = connection.recv(1000)
        self.assertIn(b"key 'camera' not found (needed: camera {width", words)
        self.assertNotIn(b"exception", words)
        self.finish(process, code=1)

    def test_interrupt_while_waiting(self):
        process, _ = self.start("live:tcp://127.0.0.1:0")
        process.send_signal(signal.SIGINT)
        self.finish(process, code=130)

    def test_interrupt_while_a_sender_is_silent(self):
        process, port = self.start("live:tcp://127.0.0.1:0", *TRACK[:3])
        _, sender = self.connect(port)
        sender.hello(self.camera, **self.u16())
        self.send_frames(sender, 0, 3)
        self.wait_for(process, "no frame for")
        process.send_signal(signal.SIGINT)
        self.finish(process, code=130)
        self.assertEqual(len(rows(self.run_folder / "trajectory.txt")), 3)

    def test_frames_at_the_cameras_rate(self):
        process, port = self.start("live:tcp://127.0.0.1:0", "--no-eval", "--realtime")
        self.send(self.recording, f"live:tcp://127.0.0.1:{port}", "--realtime")
        self.finish(process)
        metrics = json.loads((self.run_folder / "metrics.json").read_text())
        tracked = len(rows(self.run_folder / "trajectory.txt"))
        self.assertEqual(tracked + metrics["frames_dropped"], FRAMES)

    def test_nobody_there(self):
        process, _ = self.start("live:tcp://127.0.0.1:0", "--wait", "0.2")
        self.assertIn("no sender within 0.2 s", self.finish(process, code=1))

    def test_options_that_do_not_apply(self):
        for options in (("--frames", "0:3"), ("--calibration", "auto")):
            process = subprocess.run(
                [SGS, "run", "live:tcp://127.0.0.1:0", *options], capture_output=True, text=True
            )
            self.assertEqual(process.returncode, 2, process.stderr)

    def test_another_machine_is_sent_to_ssh(self):
        process = subprocess.run(
            [SGS, "run", "live:tcp://0.0.0.0:7447"], capture_output=True, text=True, cwd=self.folder
        )
        self.assertNotEqual(process.returncode, 0)
        self.assertIn("ssh -L", process.stderr)

    def test_nobody_to_send_to(self):
        said = self.send(self.recording, "live:tcp://127.0.0.1:9", "--retry", "0", code=1)
        self.assertIn("start the other end first", said)

    def test_a_sender_stops_when_it_is_told_to(self):
        """Its other end takes nothing: the socket is full, and Ctrl-C ends it all the same."""
        with socket.create_server(("127.0.0.1", 0)) as server:
            process = subprocess.Popen(
                [SGS, "send", "synth:room_desk", f"live:tcp://127.0.0.1:{server.getsockname()[1]}"],
                stderr=subprocess.PIPE,
            )
            self.addCleanup(process.stderr.close)
            self.addCleanup(process.kill)
            connection, _ = server.accept()
            connection.sendall(b"ok\n")
            process.send_signal(signal.SIGINT)
            process.communicate(timeout=TIMEOUT)
            self.assertEqual(process.returncode, 130)
            connection.close()


if __name__ == "__main__":
    unittest.main()
