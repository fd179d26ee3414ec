# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Drives `sgs run --viewer` and `sgs view` through the network as the page does.

Usage: viewer_test.py SGS_EXECUTABLE [unittest arguments]
"""
import http.client
import json
import pathlib
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest

sys.dont_write_bytecode = True  # the source tree stays as it is
from ws_client import Client, Closed, MapView, PathView, is_type

SGS = pathlib.Path(sys.argv.pop(1)).resolve()
FRAMES = 24
JPEG = b"\xff\xd8"


def read_splats(path):
    """Positions of a splat PLY as this program writes it: little-endian floats, x y z first."""
    head, body = path.read_bytes().split(b"end_header\n", 1)
    count = int(re.search(rb"element vertex (\d+)", head)[1])
    row = 4 * len(re.findall(rb"property float", head))
    assert len(body) == row * count
    return [struct.unpack_from("<3f", body, row * i) for i in range(count)]


def view_request(seq):
    """A picture of the map from the origin."""
    pose = [0, 0, 0, 0, 0, 0, 1]
    return {"type": "view", "seq": seq, "pose": pose, "fov_y": 0.9, "width": 320, "height": 240}


class Program:
    """A running sgs with a viewer; its stderr is read to the end."""

    def __init__(self, *arguments, cwd):
        self.process = subprocess.Popen(
            [str(SGS), *map(str, arguments)],
            cwd=cwd,
            text=True,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
        self.errors = []
        self.port = None
        while self.port is None:
            line = self.process.stderr.readline()
            assert line, "the program ended: " + "".join(self.errors)
            self.errors.append(line)
            if match := re.match(r"viewer +http://\S+:(\d+)/(?:\?token=(\w+))?$", line):
                self.port, self.token = int(match[1]), match[2]
        self.reader = threading.Thread(target=lambda: self.errors.extend(self.process.stderr))
        self.reader.start()

    def wait(self, timeout=120):
        code = self.process.wait(timeout)
        self.reader.join()
        self.output = self.process.stdout.read()
        self.process.stdout.close()
        self.process.stderr.close()
        return code

    def stop(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        return self.wait()

    def kill(self):
        if self.process.poll() is None:
            self.process.kill()
            self.wait()


class Case(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.shared = pathlib.Path(tempfile.mkdtemp(prefix="sgs-viewer-"))
        cls.sequence = cls.shared / "sequence"
        subprocess.run(
            [SGS, "synth", "room_desk", cls.sequence, "--frames", str(FRAMES), "--quiet"],
            check=True,
            capture_output=True,
        )
        cls.plain = cls.shared / "plain"
        subprocess.run(
            [SGS, "run", cls.sequence, "-o", cls.plain, "--quiet", "--no-eval"],
            check=True,
            capture_output=True,
            cwd=cls.shared,
        )

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.shared, ignore_errors=True)

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="case-", dir=self.shared))
        self.out = self.folder / "out"

    def start(self, *arguments):
        program = Program(*arguments, cwd=self.folder)
        self.addCleanup(program.kill)
        return program

    def start_run(self, *arguments, source=None):
        return self.start(
            "run",
            source or self.sequence,
            "-o",
            self.out,
            "--quiet",
            "--no-eval",
            "--viewer",
            0,
            *arguments,
        )

    def assert_same_bits(self):
        for name in ("trajectory.txt", "map.ply"):
            self.assertEqual((self.plain / name).read_bytes(), (self.out / name).read_bytes(), name)


class Run(Case):
    def test_a_client_sees_the_run_to_its_end(self):
        program = self.start_run()
        splats, path, counts, metrics, last = MapView(), PathView(), [], None, None
        with Client(program.port) as client:
            client.send({"type": "subscribe", "map": "splats", "panes": []})
            hello = client.receive()
            self.assertEqual((hello["type"], hello["protocol"], hello["live"]), ("hello", 2, True))
            self.assertEqual(hello["camera"]["width"], 640)
            self.assertEqual(hello["frames_total"], FRAMES)
            with self.assertRaises(Closed) as closed:
                while True:
                    message = client.receive()
                    if isinstance(message, bytes):
                        splats.apply(message)
                        continue
                    if message["type"] == "metrics":
                        metrics = message
                        continue
                    path.apply(message)
                    if message["type"] == "state":
                        last = message
                        counts.append(message["gaussians"])
        self.assertEqual(closed.exception.code, 1001)
        self.assertEqual(program.wait(), 0)
        self.assertTrue(last["finished"])
        self.assertLess(counts[0], counts[-1])
        self.assertEqual(len(path.estimate), FRAMES)
        lines = {line["key"]: line["value"] for line in metrics["lines"]}
        self.assertEqual(lines["frames_tracked"], str(FRAMES))
        # What the client has put together is the map that was saved, to the bit.
        self.assertTrue(splats.complete)
        saved = read_splats(self.out / "map.ply")
        self.assertEqual(len(saved), last["gaussians"])
        self.assertEqual(saved, [splats.records[key][:3] for key in sorted(splats.records)])
        self.assertIn(f"sgs view {self.out}", "".join(program.errors))
        self.assert_same_bits()

    def test_late_clients_get_the_history_and_reconnecting_works(self):
        program = self.start_run()
        with Client(program.port) as first:
            while first.wait_for(is_type("state"))["frame"] < FRAMES // 2:
                pass
            first.send({"type": "control", "action": "pause"})
            paused = first.wait_for(lambda m: is_type("state")(m) and m["paused"])
        with Client(program.port) as second:
            path = PathView()
            while True:
                message = second.receive()
                if message["type"] in ("path", "state"):
                    path.apply(message)
                if message["type"] == "state":
                    break
            self.assertTrue(message["paused"])
            self.assertGreaterEqual(len(path.estimate), paused["frame"])
            second.send({"type": "control", "action": "resume"})
            second.wait_for(lambda m: is_type("state")(m) and not m["paused"])
        self.assertEqual(program.wait(), 0)
        self.assert_same_bits()

    def test_pause_step_resume(self):
        program = self.start_run()
        with Client(program.port) as client:
            client.wait_for(is_type("state"))
            client.send({"type": "control", "action": "pause"})
            frame = client.wait_for(lambda m: is_type("state")(m) and m["paused"])["frame"]
            for _ in range(3):
                client.send({"type": "control", "action": "step"})
                frame += 1
                stepped = client.wait_for(lambda m: is_type("state")(m) and m["frame"] >= frame)
                # A frame that was already under way when the pause came is one more.
                self.assertLessEqual(stepped["frame"], frame + 1)
                self.assertTrue(stepped["paused"])
            # While pictures are drawn, many a frame would pass were the run not held.
            for seq in range(1, 6):
                client.send(view_request(seq))
                while not (isinstance(message := client.receive(), bytes) and message[1] == 4):
                    if is_type("state")(message):
                        self.assertLessEqual(message["frame"], frame + 1)
            client.send({"type": "control", "action": "resume"})
            client.wait_for(is_type("metrics"))
        self.assertEqual(program.wait(), 0)
        self.assert_same_bits()
        # Pauses count neither as system nor as wall time.
        self.assertGreater(json.loads((self.out / "metrics.json").read_text())["fps_wall"], 0)

    def test_the_map_of_the_first_frame_arrives_though_the_run_is_paused(self):
        program = self.start_run("--set", "mapper.first_keyframe_iterations=300")
        with Client(program.port) as client:
            client.send({"type": "control", "action": "step"})  # and pause
            state = client.wait_for(lambda m: is_type("state")(m) and m["paused"])
            # Mapping what the frame brought takes longer than tracking it; no other frame comes.
            while state["map_version"] == 0:
                state = client.wait_for(is_type("state"))
            self.assertGreater(state["gaussians"], 0)
            client.send({"type": "control", "action": "resume"})
            client.wait_for(is_type("metrics"))
        self.assertEqual(program.wait(), 0)

    def test_a_run_paused_by_nobody_goes_on(self):
        program = self.start_run()
        with Client(program.port) as client:
            client.wait_for(is_type("state"))
            client.send({"type": "control", "action": "pause"})
            client.wait_for(lambda m: is_type("state")(m) and m["paused"])
        self.assertEqual(program.wait(timeout=60), 0)
        self.assert_same_bits()

    def test_pictures(self):
        program = self.start_run("--viewer-stay")
        with Client(program.port) as client:
            client.send(
                {"type": "subscribe", "map": "none", "panes": ["color", "depth", "render", "error"]}
            )
            panes = set()
            while panes != {0, 1, 2, 3}:
                message = client.wait_for(lambda m: isinstance(m, bytes))
                self.assertEqual((message[0], message[8:10]), (2, JPEG))
                panes.add(message[1])
            client.send({"type": "subscribe", "map": "none", "panes": []})
            client.send(view_request(77))
            view = client.wait_for(lambda m: isinstance(m, bytes) and m[1] == 4)
            self.assertEqual((struct.unpack_from("<I", view, 4)[0], view[8:10]), (77, JPEG))
            if "metrics" not in client.passed:
                client.wait_for(is_type("metrics"))
            self.assertIsNone(program.process.poll())  # stays
            client.send(view_request(78))
            client.wait_for(lambda m: isinstance(m, bytes) and m[4] == 78)
        self.assertEqual(program.stop(), 0)

    def test_the_port_is_checked(self):
        taken = socket.create_server(("127.0.0.1", 0))
        self.addCleanup(taken.close)
        for arguments, code, word in (
            (("--viewer", taken.getsockname()[1]), 1, "in use"),
            (("--viewer", 70000), 2, "65535"),
            (("--viewer=x",), 2, "port"),
            (("--viewer", "--viewer-address", "nowhere"), 2, "nowhere"),
        ):
            done = subprocess.run(
                [str(SGS), "run", str(self.sequence), "-o", "out", *map(str, arguments)],
                cwd=self.folder,
                capture_output=True,
                text=True,
                timeout=60,
            )
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn(word, done.stderr)


class Http(Case):
    def fetch(self, port, path, method="GET"):
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
        connection.request(method, path)
        response = connection.getresponse()
        return response, response.read()

    def test_page_and_everything_it_names_are_there(self):
        program = self.start("view", self.plain, "--port", 0)
        response, page = self.fetch(program.port, "/")
        self.assertEqual(response.status, 200)
        self.assertIn("text/html", response.headers["Content-Type"])
        self.assertIn("default-src 'self'", response.headers["Content-Security-Policy"])
        self.assertEqual(response.headers["X-Content-Type-Options"], "nosniff")
        for name in re.findall(r'(?:src|href)="\.?(/[^":]+)"', page.decode()):
            part, body = self.fetch(program.port, name)
            self.assertEqual(part.status, 200, name)
            self.assertTrue(body, name)
        head, body = self.fetch(program.port, "/", "HEAD")
        self.assertEqual((head.status, body), (200, b""))
        self.assertEqual(int(head.headers["Content-Length"]), len(page))
        self.assertEqual(self.fetch(program.port, "/healthz")[1], b"ok\n")
        self.assertEqual(program.stop(), 0)


class Token(Case):
    def test_who_comes_from_elsewhere_needs_the_token(self):
        program = self.start("view", self.plain, "--port", 0, "--viewer-address", "0.0.0.0")
        self.assertRegex(program.token, "^[0-9a-f]{32}$")
        for path in ("/ws", "/ws?token=", "/ws?token=" + "0" * 32):
            with self.assertRaises(ConnectionRefusedError) as refused:
                Client(program.port, path=path)
            self.assertEqual(refused.exception.args[0], 403)
        with Client(program.port, path="/ws?token=" + program.token) as client:
            self.assertEqual(client.receive()["type"], "hello")
        self.assertEqual(program.stop(), 0)

    def test_on_this_machine_there_is_none(self):
        program = self.start("view", self.plain, "--port", 0)
        self.assertIsNone(program.token)
        with Client(program.port) as client:
            self.assertEqual(client.receive()["type"], "hello")
        self.assertEqual(program.stop(), 0)


class View(Case):
    def test_replay_pause_and_again(self):
        program = self.start("view", self.plain, "--port", 0)
        splats, path = MapView(), PathView()
        with Client(program.port) as client:
            client.send({"type": "subscribe", "map": "points", "panes": ["render", "color"]})
            self.assertFalse(client.receive()["live"])
            kinds = set()
            started = time.monotonic()
            axes = []
            while True:
                message = client.receive()
                if isinstance(message, bytes):
                    kinds.add(message[0])
                    if message[0] == 1:
                        splats.apply(message)
                elif message["type"] == "metrics":
                    kinds.add("metrics")
                else:
                    path.apply(message)
                    axes.append(message.get("values", {}).get("axis"))
                    if message.get("finished") and message["paused"]:
                        break
            self.assertGreater(time.monotonic() - started, 0.5 * FRAMES / 30)  # sensor rate
            self.assertEqual(len(path.estimate), FRAMES)
            for axis in axes[-1]:
                self.assertAlmostEqual(sum(x * x for x in axis), 1, places=2)
            client.send({"type": "control", "action": "resume"})
            again = client.wait_for(lambda m: isinstance(m, dict) and m["type"] == "path")
            self.assertEqual((again["first"], again["estimate"]), (0, []))
            path.apply(again)
            while True:
                message = client.wait_for(lambda m: isinstance(m, dict))
                if message["type"] == "state":
                    self.assertEqual(message["frame"], 0)
                    break
            while not {1, 2, "metrics"} <= kinds:
                message = client.receive()
                if isinstance(message, bytes):
                    kinds.add(message[0])
                    if message[0] == 1:
                        splats.apply(message)
                else:
                    kinds.add(message["type"])
        self.assertEqual(len(splats.records), len(read_splats(self.plain / "map.ply")))
        self.assertEqual(program.stop(), 0)

    def test_the_map_is_refined_from_the_page(self):
        copy = self.folder / "run"
        shutil.copytree(self.plain, copy)
        program = self.start("view", copy, "--port", 0)
        refine = {"type": "control", "action": "refine"}

        def note(wanted):
            return lambda m: isinstance(m, dict) and m["type"] == "refinement" and wanted(m)

        with Client(program.port) as client:
            self.assertTrue(client.receive()["refines"])
            client.send(refine)
            client.wait_for(note(lambda m: m["running"] and m["share"] > 0))
            client.send(refine)  # enough
            end = client.wait_for(note(lambda m: not m["running"]))
            self.assertIn("run-refined", end["text"])
            client.send({"type": "subscribe", "map": "points", "panes": []})
            # The replay goes on with the refined map.
            client.wait_for(lambda m: isinstance(m, dict) and m.get("map_version", 0) > 1)
        self.assertEqual(program.stop(), 0)
        self.assertEqual((copy / "map.ply").read_bytes(), (self.plain / "map.ply").read_bytes())
        refined = self.folder / "run-refined"
        for name in ("map.ply", "refine.toml", "report.html", "metrics.json"):
            self.assertTrue((refined / name).exists(), name)

    def test_the_replay_outlives_its_input(self):
        copy = self.folder / "run"
        shutil.copytree(self.plain, copy)
        config = (copy / "config.toml").read_text()
        (copy / "config.toml").write_text(config.replace(str(self.sequence), "/nowhere"))
        program = self.start("view", copy, "--port", 0)
        with Client(program.port) as client:
            client.send({"type": "subscribe", "map": "none", "panes": ["render"]})
            self.assertFalse(client.receive()["refines"])
            client.wait_for(lambda m: isinstance(m, bytes) and m[1] == 2)
        self.assertEqual(program.stop(), 0)

    def test_no_run_folder(self):
        done = subprocess.run(
            [str(SGS), "view", str(self.folder), "--port", "0"],
            capture_output=True,
            text=True,
            timeout=60,
        )
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("config.toml", done.stderr)


class Neutrality(Case):
    def test_ten_clients_one_of_which_never_reads_change_nothing(self):
        program = self.start_run()
        deaf = Client(program.port, receive_buffer=4096)
        self.addCleanup(deaf.close)
        everything = {
            "type": "subscribe",
            "map": "splats",
            "panes": ["color", "depth", "render", "error"],
        }
        deaf.send(everything)
        received = []

        def watch(number):
            count = 0
            try:
                with Client(program.port) as client:
                    client.send(everything)
                    for turn in range(10**6):
                        if turn % 50 == number:
                            client.send(
                                {
                                    "type": "view",
                                    "seq": turn,
                                    "fov_y": 1,
                                    "width": 160,
                                    "height": 120,
                                    "pose": [0, 0, 0, 0, 0, 0, 1],
                                }
                            )
                        client.receive()
                        count += 1
            except (Closed, ConnectionError):
                received.append(count)

        threads = [threading.Thread(target=watch, args=(n,)) for n in range(9)]
        for thread in threads:
            thread.start()
        self.assertEqual(program.wait(), 0)
        for thread in threads:
            thread.join(timeout=30)
        self.assertEqual(len(received), 9)
        self.assertGreater(min(received), 5)
        self.assert_same_bits()


if __name__ == "__main__":
    unittest.main(verbosity=2)
