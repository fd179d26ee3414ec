#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Runs live twice, alone and under load: ten thousand half-open connections and 64 viewers that want
everything, one of which reads a byte a second.

Usage: scripts/load.py SGS_EXECUTABLE SECONDS [RECORDING]

RECORDING as in scripts/soak.py. Says how many frames were dropped and what tracking and memory took
with and without the load, what viewers got and when the slow one was cut off. Exits with 1 where a run
failed, the server did not answer in between, a viewer was left without anything, or the slow one was
kept for ever.
"""
import csv
import os
import pathlib
import resource
import socket
import subprocess
import sys
import tempfile
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "scripts"))
from soak import Client, Closed, make_loop, port_of, quantile, recording, status  # noqa: E402

HALF_OPEN, VIEWERS = 10000, 64
EVERYTHING = {"type": "subscribe", "map": "splats", "panes": ["color", "depth", "render", "error"]}


def healthy(port):
    with socket.create_connection(("127.0.0.1", port), timeout=20) as s:
        s.sendall(f"GET /healthz HTTP/1.1\r\nHost: localhost:{port}\r\n\r\n".encode())
        s.shutdown(socket.SHUT_WR)
        return b" 200 " in s.recv(4096)


class Load:
    """All of it; `stop()` ends it."""

    def __init__(self, port):
        self.port, self.stopped = port, threading.Event()
        self.got, self.refused, self.unanswered, self.opened = [], 0, 0, 0
        self.slow_s = None
        # The slow one takes the first place: at a full house it would be turned away untested.
        self.slow = Client(port, timeout=30, receive_buffer=4096)
        self.threads = [threading.Thread(target=self.read_slowly)]
        self.threads += [threading.Thread(target=self.view) for _ in range(VIEWERS - 1)]
        self.threads += [threading.Thread(target=self.half_open)]
        for thread in self.threads:
            thread.start()

    def view(self):
        count = 0
        try:
            with Client(self.port, timeout=30) as client:
                client.send(EVERYTHING)
                while not self.stopped.is_set():
                    client.receive()
                    count += 1
        except ConnectionRefusedError:
            self.refused += 1
            return
        except (Closed, OSError):
            pass
        self.got.append(count)

    def read_slowly(self):
        """Until it is cut off."""
        since = time.monotonic()
        try:
            with self.slow as client:
                client.send(EVERYTHING)
                while not self.stopped.is_set():
                    client.send({"type": "subscribe", "map": "none"})
                    client.send(EVERYTHING)
                    if not client.socket.recv(1):
                        break
                    self.stopped.wait(1)
                else:
                    return
        except OSError:
            pass
        elapsed_s = time.monotonic() - since
        if self.goes_on():
            self.slow_s = elapsed_s

    def goes_on(self):
        """Whether the run does: at its end all are cut off, and nobody is answered."""
        return not self.stopped.wait(3)

    def answers(self):
        try:
            return healthy(self.port)
        except OSError:
            return False

    def half_open(self):
        held = []
        while not self.stopped.is_set():
            for _ in range(HALF_OPEN):
                if self.stopped.is_set():
                    break
                try:
                    s = socket.create_connection(("127.0.0.1", self.port), timeout=20)
                    s.send(b"GET / HTTP/1.1\r\nHost: local")
                    held.append(s)
                except OSError:
                    self.unanswered += 1 if self.goes_on() else 0
                    continue
                self.opened += 1
                if self.opened % 1000 == 0 and not self.answers() and self.goes_on():
                    self.unanswered += 1
            self.stopped.wait(1)
            for s in held:
                s.close()
            held = []

    def stop(self):
        self.stopped.set()
        for thread in self.threads:
            thread.join()


def run(sgs, loop, out, loaded):
    """Whether all went well; prints what was measured."""
    log = out.with_suffix(".log")
    with open(log, "w") as said:
        process = subprocess.Popen(
            [sgs, "run", loop, "-o", out, "--realtime", "--viewer", "0", "--no-eval"],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=said,
        )
    load = Load(port_of(log)) if loaded else None
    most = {"memory_mb": 0, "handles": 0}
    while process.poll() is None:
        try:
            now = status(process.pid)
        except (FileNotFoundError, ProcessLookupError, AttributeError):
            break
        most = {key: max(value, now[key]) for key, value in most.items()}
        time.sleep(1)
    if load:
        load.stop()
    if process.wait() not in (0, 3):
        print(log.read_text()[-2000:])
        return False
    with open(out / "frames.csv") as file:
        frames = list(csv.DictReader(file))
    cost = [float(row["track_ms"]) for row in frames if row["track_ms"]]
    count = int(frames[-1]["index"]) + 1
    print(
        f"{'under load' if loaded else 'alone'}: {count} frames came, {count - len(frames)} dropped; tracking "
        f"{quantile(cost, 0.5):.2f} ms, p95 {quantile(cost, 0.95):.2f} ms; at most "
        f"{most['memory_mb']:.0f} MB, {most['handles']} handles"
    )
    if not load:
        return True
    print(
        f"{load.opened} connections half opened, {load.unanswered} without an answer; {len(load.got)} viewers "
        f"got {min(load.got, default=0)} to {max(load.got, default=0)} messages each, {load.refused} refused"
    )
    kept = "kept" if load.slow_s is None else f"cut off after {load.slow_s:.0f} s"
    print(f"the one that reads a byte a second: {kept}")
    served = load.refused == 0 and min(load.got, default=0) > 0
    return load.unanswered == 0 and served and load.slow_s is not None


def main():
    sgs, seconds = str(pathlib.Path(sys.argv[1]).resolve()), float(sys.argv[2])
    _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
    with tempfile.TemporaryDirectory(prefix="sgs-load-") as folder:
        scratch = pathlib.Path(folder)
        make_loop(recording(sgs, scratch), scratch / "loop", seconds)
        sound = run(sgs, scratch / "loop", scratch / "alone", False)
        return 0 if run(sgs, scratch / "loop", scratch / "loaded", True) and sound else 1


if __name__ == "__main__":
    sys.exit(main())
