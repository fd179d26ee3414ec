# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Attacks the viewer's port while a run goes on: the run must end with the bits of an unwatched one,
the server must still answer, and neither memory nor descriptors may be left behind.

Usage: hostile_test.py SGS_EXECUTABLE [unittest arguments]
"""
import json
import os
import pathlib
import random
import re
import resource
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
from ws_client import Client, Closed, is_type, upgrade_request

SGS = pathlib.Path(sys.argv.pop(1)).resolve()
FRAMES = 60
HALF_OPEN = 10000
SPARE_DESCRIPTORS = 200
MORE_MEMORY = 200 << 20  # bytes that a watched and attacked run may take beyond an unwatched one


def connect(port, timeout=20):
    s = socket.create_connection(("127.0.0.1", port), timeout=timeout)
    s.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return s


def read_all(s):
    """What the server says until it closes; a reset counts as closed."""
    data = b""
    try:
        while chunk := s.recv(65536):
            data += chunk
    except ConnectionError:
        pass
    return data


def exchange(port, request):
    """Answer to raw bytes, with nothing sent afterwards."""
    with connect(port) as s:
        try:
            s.sendall(request)
            s.shutdown(socket.SHUT_WR)
        except OSError:
            pass
        return read_all(s)


def status(answer):
    match = re.match(rb"HTTP/1\.[01] (\d{3})", answer)
    return int(match[1]) if match else None


def healthy(port):
    answer = exchange(port, f"GET /healthz HTTP/1.1\r\nHost: localhost:{port}\r\n\r\n".encode())
    return status(answer) == 200 and answer.endswith(b"ok\n")


def peak_rss(pid):
    text = pathlib.Path(f"/proc/{pid}/status").read_text()
    return 1024 * int(re.search(r"VmHWM:\s+(\d+)", text)[1])


def random_bytes(port, rng):
    for _ in range(150):
        exchange(port, rng.randbytes(rng.choice((1, 7, 100, 5000, 20000))))


def http_fuzz(port, rng):
    host = f"Host: localhost:{port}\r\n"
    seeds = [
        f"GET / HTTP/1.1\r\n{host}\r\n",
        f"GET /healthz HTTP/1.0\r\n{host}Connection: keep-alive\r\n\r\n",
        f"POST / HTTP/1.1\r\n{host}Content-Length: 1073741824\r\n\r\nxxxx",
        f"POST / HTTP/1.1\r\n{host}Transfer-Encoding: chunked\r\n\r\nffffffffffffffff\r\n",
        f"GET / HTTP/1.1\r\n{host}Content-Length: 18446744073709551616\r\n\r\n",
        f"GET / HTTP/1.1\r\n{host}Content-Length: -1\r\n\r\n",
        f"GET / HTTP/9.9\r\n{host}\r\n",
        f"GET  /  HTTP/1.1\r\n{host}\r\n",
        f"GET / HTTP/1.1\r\n{host}{host}\r\n",
        "GET / HTTP/1.1\r\n\r\n",
        f"GET / HTTP/1.1\r\n{host} folded: x\r\n\r\n",
        f"GET / HTTP/1.1\r\n{host}Upgrade: h2c\r\n\r\n",
        f"GET /{'a' * 7000} HTTP/1.1\r\n{host}\r\n",
        f"{'G' * 9000} / HTTP/1.1\r\n{host}\r\n",
        f"GET / HTTP/1.1\r\n{host}" + "".join(f"X-{i}: {i}\r\n" for i in range(400)) + "\r\n",
        upgrade_request(port).decode(),
        f"GET /ws HTTP/1.1\r\n{host}Upgrade: websocket\r\n\r\n",
    ]
    for turn in range(300):
        request = bytearray(seeds[turn % len(seeds)].encode())
        if turn >= len(seeds):
            for _ in range(rng.randrange(1, 8)):
                place = rng.randrange(len(request))
                kind = rng.randrange(3)
                if kind == 0:
                    request[place] = rng.randrange(256)
                elif kind == 1:
                    del request[place : place + rng.randrange(1, 20)]
                else:
                    request[place:place] = rng.randbytes(rng.randrange(1, 20))
                if not request:
                    break
        exchange(port, bytes(request))


def websocket_fuzz(port, rng):
    def frames(client):
        kind = rng.randrange(10)
        if kind == 0:
            client.socket.sendall(rng.randbytes(rng.randrange(2, 3000)))
        elif kind == 1:  # a message of 2^62 bytes, announced
            client.socket.sendall(struct.pack(">BBQ", 0x81, 0xFF, 1 << 62) + b"\0\0\0\0x")
        elif kind == 2:
            client.send_frame(rng.choice((3, 7, 11, 15)), b"reserved")
        elif kind == 3:
            client.send_frame(1, b'{"type":"control"}', mask=False)
        elif kind == 4:
            client.send_frame(9, b"x" * 126)  # a control frame too long
        elif kind == 5:
            client.send_frame(1, b"\xff\xfe\xc0")
        elif kind == 6:
            client.send_frame(1, b"x" * rng.choice((4097, 200000)))
        elif kind == 7:
            for _ in range(50):
                client.send_frame(0 if _ else 1, b"[" * 100, final=False)
        elif kind == 8:
            client.send_frame(8, rng.randbytes(rng.randrange(1, 4)))
        else:
            client.send(
                rng.choice(
                    (
                        "[" * 4000,
                        '{"type":"view"}',
                        '{"type":"control","action":"explode"}',
                        "null",
                        "",
                        '{"type":"view","seq":1,"pose":[1e308,0,0,0,0,0,1],"fov_y":1,"width":1,"height":1}',
                        json.dumps({"type": "subscribe", "panes": ["color"] * 300}),
                    )
                )
            )

    for _ in range(80):
        try:
            with Client(port) as client:
                frames(client)
                client.socket.settimeout(0.5)  # some of this is only half of a message
                for _ in range(100):
                    client.receive()
        except (Closed, OSError):
            pass


def flood(port, rng):
    """Requests and pings as fast as they can be written."""
    for opcode, payload in ((9, b"ping"), (1, b'{"type":"subscribe","map":"splats"}')):
        try:
            with Client(port) as client:
                for _ in range(20000):
                    client.send_frame(opcode, payload)
        except (Closed, OSError):
            pass


def endless_fragments(port, rng):
    """A message in fragments that hold nothing and never end: must be cut off."""
    client = Client(port)
    with client:
        client.send_frame(1, b"", final=False)
        empty = struct.pack(">BBI", 0x00, 0x80, 0) * 1000
        started = time.monotonic()
        try:
            while time.monotonic() - started < 60:
                client.socket.sendall(empty)
        except OSError:
            return
    raise AssertionError("the server reads empty fragments for ever")


def endless_header(port, rng):
    """A gigabyte of header: must be cut off early."""
    with connect(port) as s:
        s.sendall(f"GET / HTTP/1.1\r\nHost: localhost:{port}\r\n".encode())
        line = b"X-Padding: " + b"x" * 1000 + b"\r\n"
        sent = 0
        try:
            while sent < 1 << 30:
                sent += s.send(line * 100)
        except OSError:
            return
    raise AssertionError("the server read a gigabyte of header")


def slow_header(port, rng):
    """One byte a second: must be cut off after some seconds."""
    with connect(port) as s:
        started = time.monotonic()
        try:
            while time.monotonic() - started < 60:
                s.sendall(b"G")
                time.sleep(1)
        except OSError:
            return
    raise AssertionError("the server waits for a header for ever")


def paths(port, rng):
    for path in (
        "/../../../../etc/passwd",
        "/%2e%2e/%2e%2e/etc/passwd",
        "/..%2f..%2fetc/passwd",
        "/assets/../../../../etc/passwd",
        "//etc/passwd",
        "/assets/..\\..\\etc\\passwd",
        "file:///etc/passwd",
        "/proc/self/environ",
        "/.git/config",
        "/index.html/.",
        "/assets/%00",
        "/download/../state.toml",
        "/download/%2e%2e/state.toml",
        "/download//etc/passwd",
        "/download/frames.csv",
        "/..;/etc/passwd",
        "/%252e%252e/etc/passwd",
        "*",
        "/\x7f",
        "etc",
    ):
        answer = exchange(
            port, f"GET {path} HTTP/1.1\r\nHost: localhost:{port}\r\n\r\n".encode("latin-1")
        )
        if status(answer) not in (400, 404) or b"root:" in answer:
            raise AssertionError(f"{path}: {answer[:200]}")


def foreigners(port, rng):
    for host in ("evil.example", f"evil.example:{port}", "localhost.evil.example", "10.1.2.3", ""):
        answer = exchange(port, f"GET / HTTP/1.1\r\nHost: {host}\r\n\r\n".encode())
        if status(answer) != 403:
            raise AssertionError(f"Host {host}: {answer[:100]}")
        try:
            Client(port, host=host or "x").close()
            raise AssertionError(f"WebSocket with Host {host}")
        except ConnectionRefusedError as error:
            if error.args[0] != 403:
                raise
    for origin in ("http://evil.example", "null", f"http://localhost:{port + 1}", "file://"):
        try:
            Client(port, host=f"localhost:{port}", origin=origin).close()
            raise AssertionError(f"WebSocket with Origin {origin}")
        except ConnectionRefusedError as error:
            if error.args[0] != 403:
                raise
    Client(port, host=f"localhost:{port}", origin=f"http://localhost:{port}").close()


class Attack(threading.Thread):
    """Runs one attack; `error` is what its own checks said."""

    def __init__(self, attack, port):
        super().__init__(name=attack.__name__)
        self.attack, self.port, self.error = attack, port, None

    def run(self):
        try:
            self.attack(self.port, random.Random(self.name))
        except Exception as error:  # pylint: disable=broad-except
            self.error = error


class Hostile(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="sgs-hostile-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        subprocess.run(
            [SGS, "synth", "room_desk", "sequence", "--frames", str(FRAMES), "--quiet"],
            check=True,
            capture_output=True,
            cwd=self.folder,
        )
        soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
        self.addCleanup(resource.setrlimit, resource.RLIMIT_NOFILE, (soft, hard))
        self.half_open_limit = min(HALF_OPEN, hard - SPARE_DESCRIPTORS) if hard > 0 else HALF_OPEN

    def sgs_run(self, out, *arguments):
        return subprocess.Popen(
            [str(SGS), "run", "sequence", "-o", out, "--no-eval", "--quiet", *arguments],
            cwd=self.folder,
            text=True,
            stderr=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
        )

    def test_a_run_under_attack(self):
        plain = self.sgs_run("plain")
        plain_errors = plain.communicate(timeout=300)[1]
        self.assertEqual(plain.returncode, 0, plain_errors)
        plain_rss = json.loads((self.folder / "plain/metrics.json").read_text())["peak_rss_bytes"]

        process = self.sgs_run("attacked", "--viewer", "0", "--viewer-stay")
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.kill)
        port = int(re.search(r":(\d+)/", process.stderr.readline())[1])
        descriptors = len(os.listdir(f"/proc/{process.pid}/fd"))
        finished = threading.Event()
        watcher = threading.Thread(target=self.watch, args=(port, finished))
        watcher.start()
        attacks = [
            Attack(a, port)
            for a in (
                random_bytes,
                http_fuzz,
                websocket_fuzz,
                flood,
                endless_fragments,
                endless_header,
                slow_header,
                paths,
                foreigners,
            )
        ]
        for attack in attacks:
            attack.start()
        self.assertFalse(finished.is_set(), "the run was over before the attacks began")
        self.half_open(port)
        for attack in attacks:
            attack.join(timeout=200)
            self.assertFalse(attack.is_alive(), attack.name)
            self.assertIsNone(attack.error, attack.name)
        self.never_reads(port)
        self.crowd(port)

        self.assertTrue(finished.wait(timeout=200), "the watcher did not see the end of the run")
        watcher.join()
        self.assertIsNone(process.poll(), "the server died")
        self.assertTrue(healthy(port))
        for name in ("trajectory.txt", "map.ply"):
            self.assertEqual(
                (self.folder / "plain" / name).read_bytes(),
                (self.folder / "attacked" / name).read_bytes(),
                name,
            )
        self.assertLess(peak_rss(process.pid), plain_rss + MORE_MEMORY)
        for _ in range(600):  # what the attackers left is closed within the time limits
            left = len(os.listdir(f"/proc/{process.pid}/fd"))
            if left <= descriptors + 5:
                break
            time.sleep(0.2)
        self.assertLessEqual(left, descriptors + 5)
        process.send_signal(signal.SIGINT)
        errors = process.communicate(timeout=60)[1]
        self.assertEqual(process.returncode, 0, errors)

    @staticmethod
    def watch(port, finished):
        """An ordinary client that sees the run to its end in spite of everything; comes back when
        it finds no room."""
        while not finished.is_set():
            try:
                with Client(port, timeout=100) as client:
                    client.wait_for(is_type("metrics"))
                    finished.set()
            except (Closed, OSError):
                time.sleep(0.2)

    def half_open(self, port):
        """Thousands of connections that never finish their request; the server still answers."""
        held = []
        try:
            for i in range(self.half_open_limit):
                s = socket.socket()
                s.settimeout(20)
                s.connect(("127.0.0.1", port))
                if i % 2:
                    try:
                        s.send(b"GET / HTTP/1.1\r\nHost: local")
                    except OSError:
                        pass  # already thrown out
                held.append(s)
                if i % 2000 == 1999:
                    self.assertTrue(healthy(port))
        finally:
            for s in held:
                s.close()
        self.assertGreaterEqual(len(held), 1000, "too few descriptors for this test (ulimit -n)")

    def never_reads(self, port):
        """A client that asks for the map again and again and reads nothing is dropped."""
        with Client(port, receive_buffer=4096) as deaf:
            deadline = time.monotonic() + 120
            wanted = ("splats", "none")
            try:
                for turn in range(10**6):
                    self.assertLess(time.monotonic(), deadline, "a deaf client is kept for ever")
                    deaf.send({"type": "subscribe", "map": wanted[turn % 2]})
                    time.sleep(0.2 if turn % 2 else 0.4)
            except OSError:
                pass

    def crowd(self, port):
        """There is a bound on the number of clients, and room again when they have gone."""
        clients, refused = [], None
        try:
            for _ in range(100):
                clients.append(Client(port))
        except ConnectionRefusedError as error:
            refused = error.args[0]
        finally:
            for client in clients:
                client.close()
        self.assertEqual(refused, 503)
        self.assertGreaterEqual(len(clients), 16)
        for _ in range(600):
            try:
                Client(port).close()
                return
            except ConnectionRefusedError:
                time.sleep(0.1)
        self.fail("no room again")


if __name__ == "__main__":
    unittest.main(verbosity=2)
