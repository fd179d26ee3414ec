# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""A WebSocket client of a few lines (RFC 6455, standard library only) and a decoder of the viewer's
binary messages (docs/viewer.md), independent of the server's own code."""
import base64
import json
import os
import socket
import struct

RECORD = struct.Struct("<I10f4B")  # id, position, scale, quaternion w x y z, r g b a


class Closed(Exception):
    """The server closed the connection; `code` is that of its close frame, if there was one."""

    def __init__(self, code=None):
        super().__init__(f"closed ({code})")
        self.code = code


def upgrade_request(port, host=None, origin=None, path="/ws"):
    lines = [
        f"GET {path} HTTP/1.1",
        f"Host: {host or f'127.0.0.1:{port}'}",
        "Upgrade: websocket",
        "Connection: Upgrade",
        "Sec-WebSocket-Version: 13",
        "Sec-WebSocket-Key: " + base64.b64encode(os.urandom(16)).decode(),
    ]
    if origin is not None:
        lines.append(f"Origin: {origin}")
    return ("\r\n".join(lines) + "\r\n\r\n").encode()


class Client:
    def __init__(self, port, host=None, origin=None, timeout=120, receive_buffer=None, path="/ws"):
        self.passed = set()
        self.socket = socket.socket()
        if receive_buffer:
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
        self.socket.settimeout(timeout)
        try:
            self.socket.connect(("127.0.0.1", port))
            self.socket.sendall(upgrade_request(port, host, origin, path))
            head = b""
            while b"\r\n\r\n" not in head:
                chunk = self.socket.recv(4096)
                if not chunk:
                    raise Closed()
                head += chunk
            head, self.buffer = head.split(b"\r\n\r\n", 1)
            status = int(head.split()[1])
            if status != 101:
                raise ConnectionRefusedError(status)
        except BaseException:
            self.socket.close()
            raise

    def close(self):
        self.socket.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def _read(self, count):
        while len(self.buffer) < count:
            chunk = self.socket.recv(1 << 16)
            if not chunk:
                raise Closed()
            self.buffer += chunk
        data, self.buffer = self.buffer[:count], self.buffer[count:]
        return data

    def send_frame(self, opcode, payload=b"", final=True, mask=True):
        size = len(payload)
        head = bytes([(0x80 if final else 0) | opcode])
        bit = 0x80 if mask else 0
        if size < 126:
            head += bytes([bit | size])
        elif size < 65536:
            head += struct.pack(">BH", bit | 126, size)
        else:
            head += struct.pack(">BQ", bit | 127, size)
        if mask:
            key = os.urandom(4)
            payload = bytes(b ^ key[i % 4] for i, b in enumerate(payload))
            head += key
        self.socket.sendall(head + payload)

    def send(self, message):
        self.send_frame(1, (message if isinstance(message, str) else json.dumps(message)).encode())

    def receive(self):
        """The next message: a dict, or bytes of a binary one. Answers pings on the way."""
        while True:
            first, second = self._read(2)
            size = second & 0x7F
            if size == 126:
                size = struct.unpack(">H", self._read(2))[0]
            elif size == 127:
                size = struct.unpack(">Q", self._read(8))[0]
            payload = self._read(size)
            opcode = first & 0x0F
            if opcode == 8:
                raise Closed(struct.unpack(">H", payload[:2])[0] if size >= 2 else None)
            if opcode == 9:
                self.send_frame(10, payload)
            elif opcode == 1:
                return json.loads(payload)
            elif opcode == 2:
                return payload

    def wait_for(self, wanted):
        """Receives until `wanted(message)`; returns that message. The types of those it passes over
        are remembered in `passed`: a run may end before what one waits for comes."""
        while True:
            message = self.receive()
            if isinstance(message, dict):
                self.passed.add(message["type"])
            if wanted(message):
                return message


def is_type(name):
    return lambda message: isinstance(message, dict) and message["type"] == name


class MapView:
    """What a client knows of the map after some binary messages."""

    def __init__(self):
        self.records, self.version, self.complete = {}, None, False

    def apply(self, message):
        kind, flags, version, changed, removed = struct.unpack_from("<BBxxxxxxQII", message)
        assert kind == 1
        assert len(message) == 24 + RECORD.size * changed + 4 * removed
        if flags & 1:
            self.records = {}
        for i in range(changed):
            record = RECORD.unpack_from(message, 24 + RECORD.size * i)
            self.records[record[0]] = record[1:]
        for (gone,) in struct.iter_unpack("<I", message[24 + RECORD.size * changed :]):
            del self.records[gone]
        self.version, self.complete = version, bool(flags & 2)


class PathView:
    """The path as a page puts it together from "path" and "state"."""

    def __init__(self):
        self.estimate, self.status = [], []

    def apply(self, message):
        if message["type"] == "path":
            first = message["first"]
            assert first <= len(self.estimate), "a gap in the path"
            self.estimate[first:] = message["estimate"]
            self.status[first:] = message["status"]
        elif message["type"] == "state":
            frame = message["frame"]
            assert frame <= len(self.estimate), "a gap in the path"
            self.estimate[frame:] = [message["pose"]]
            self.status[frame:] = [["ok", "degenerate", "lost"].index(message["status"])]
