# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings as the recorder of Azure Kinect cameras leaves them: Matroska (RFC 9559) with its tracks,
tags and attachment, written here element by element, so that nothing is shared with the reader.
"""
import json
import struct

import numpy as np

COLOR, DEPTH, IMU = 1, 2, 3
NAMES = {1: "COLOR", 2: "DEPTH", 3: "IMU"}
TICK_NS = 1000


def element(name, *parts):
    body = b"".join(parts)
    return bytes.fromhex(name) + struct.pack(">Q", 1 << 56 | len(body)) + body


def unsigned(name, value):
    return element(name, struct.pack(">Q", value))


def text(name, value):
    return element(name, value.encode())


def tag(name, value, target=b""):
    pair = element("67C8", text("45A3", name), text("4487", str(value)))
    return element("7373", element("63C0", target), pair)


def bitmap_header(code, width, height):
    """What names a packing of pictures, as in AVI files."""
    return struct.pack(
        "<IIIHHIIIIII", 40, width, height, 1, 16, *struct.unpack("<I", code), *[0] * 5
    )


def video_track(number, code, size):
    width, height = size
    return element(
        "AE",
        *(unsigned("D7", number), unsigned("73C5", 100 + number), unsigned("83", 1)),
        *(text("536E", NAMES[number]), text("86", "V_MS/VFW/FOURCC")),
        element("63A2", bitmap_header(code, width, height)),
        unsigned("23E383", 10**9 // 30),
        element("E0", unsigned("B0", width), unsigned("BA", height)),
    )


def imu_track():
    return element(
        "AE",
        *(unsigned("D7", IMU), unsigned("73C5", 100 + IMU), unsigned("83", 17)),
        *(text("536E", NAMES[IMU]), text("86", "S_K4A/IMU")),
    )


def image_block(track, ticks, data):
    return element("A3", bytes([0x80 | track]) + struct.pack(">hB", ticks, 0x80) + data)


def sample_block(ticks, samples):
    """Several samples of one size, as fixed-size lacing has them."""
    fixed = 0x04
    head = bytes([0x80 | IMU]) + struct.pack(">hBB", ticks, fixed, len(samples) - 1)
    return element("A0", element("A1", head, *samples), unsigned("9B", 1 + len(samples)))


def sample(time_ns, acceleration, rate, gyroscope_later_ns=2000):
    return struct.pack("<Q3fQ3f", time_ns, *acceleration, time_ns + gyroscope_later_ns, *rate)


def unit_lens(k, whole, corner=(0, 0)):
    """cx cy fx fy in parts of the sensor, of a camera whose pictures begin at `corner` of `whole`."""
    fx, fy, cx, cy = k
    return [
        (cx + corner[0] + 0.5) / whole[0],
        (cy + corner[1] + 0.5) / whole[1],
        fx / whole[0],
        fy / whole[1],
    ]


def camera(location, unit, T, sensor, lens=(0,) * 8):
    k1, k2, p1, p2, k3, k4, k5, k6 = lens
    return {
        "Intrinsics": {
            "ModelParameterCount": 14,
            "ModelParameters": [*unit, k1, k2, k3, k4, k5, k6, 0, 0, p2, p1],
            "ModelType": "CALIBRATION_LensDistortionModelBrownConrady",
        },
        "Location": "CALIBRATION_CameraLocation" + location,
        "MetricRadius": 1.7,
        "Rt": {"Rotation": T[:3, :3].ravel().tolist(), "Translation": T[:3, 3].tolist()},
        "SensorWidth": sensor[0],
        "SensorHeight": sensor[1],
    }


def inertial(kind, T):
    return {
        "SensorType": "CALIBRATION_InertialSensorType_" + kind,
        "Rt": {"Rotation": T[:3, :3].ravel().tolist(), "Translation": T[:3, 3].tolist()},
    }


def calibration(color, depth, accelerometer=np.eye(4), gyroscope=np.eye(4)):
    sensors = [inertial("Gyro", gyroscope), inertial("Accelerometer", accelerometer)]
    return {"CalibrationInformation": {"Cameras": [depth, color], "InertialSensors": sensors}}


class Recording:
    """What is to be recorded; every part may be taken out or spoilt before bytes() puts it together."""

    def __init__(self, color_code, color_size, depth_size, calibrated):
        self.tracks = {
            COLOR: video_track(COLOR, color_code, color_size),
            DEPTH: video_track(DEPTH, b"b16g", depth_size),
        }
        self.attachment = json.dumps(calibrated).encode()
        self.named_by_tag = "calibration.json"
        self.parts = []  # (device time in ns, track, bytes)
        self.finished = True

    def image(self, track, time_ns, data):
        self.parts.append((time_ns, track, data))

    def imu(self, time_ns, acceleration, rate=(0, 0, 0)):
        self.tracks[IMU] = imu_track()
        self.parts.append((time_ns, IMU, sample(time_ns, acceleration, rate)))

    def blocks(self, parts, start_ns):
        """Samples that follow each other lie in one block."""
        at = 0
        while at < len(parts):
            time_ns, track, data = parts[at]
            ticks = (time_ns - start_ns) // TICK_NS
            if track != IMU:
                yield image_block(track, ticks, data)
                at += 1
                continue
            end = at
            while end < len(parts) and parts[end][1] == IMU:
                end += 1
            yield sample_block(ticks, [part[2] for part in parts[at:end]])
            at = end

    def clusters(self, start_ns):
        """Of 32 ms, which is how long the recorder's are."""
        parts = sorted(self.parts, key=lambda part: part[0])
        at = 0
        while at < len(parts):
            first, end = parts[at][0], at
            while end < len(parts) and parts[end][0] < first + 32_000_000:
                end += 1
            time = unsigned("E7", (first - start_ns) // TICK_NS)
            yield element("1F43B675", time, *self.blocks(parts[at:end], first))
            at = end

    def bytes(self):
        times = [part[0] for part in self.parts]
        info = [unsigned("2AD7B1", TICK_NS), text("4D80", "test"), text("5741", "test")]
        tags = [
            tag(f"K4A_{name}_TRACK", 100 + number, unsigned("63C5", 100 + number))
            for number, name in NAMES.items()
            if number in self.tracks
        ]
        tags.append(tag("K4A_DEVICE_SERIAL_NUMBER", "000000000000"))
        if self.finished:
            tags.append(tag("K4A_START_OFFSET_NS", min(times)))
            info.append(element("4489", struct.pack(">d", (max(times) - min(times)) / TICK_NS)))
        attached = b""
        if self.attachment is not None:
            attached = element(
                "61A7",
                *(text("466E", self.named_by_tag), text("4660", "application/octet-stream")),
                *(element("465C", self.attachment), unsigned("46AE", 7)),
            )
            tags.append(tag("K4A_CALIBRATION_FILE", self.named_by_tag, unsigned("63C6", 7)))
        segment = b"".join(
            [
                element("EC", bytes(1024)),
                element("1549A966", *info),
                element("1654AE6B", *self.tracks.values()),
                element("1941A469", attached) if attached else b"",
                element("1254C367", *tags),
                *self.clusters(min(times)),
            ]
        )
        head = element(
            "1A45DFA3", text("4282", "matroska"), unsigned("4287", 2), unsigned("4285", 2)
        )
        size = len(segment) if self.finished else (1 << 56) - 1
        return head + bytes.fromhex("18538067") + struct.pack(">Q", 1 << 56 | size) + segment


def video(size, frames=3):
    """A video of something, as programs write them."""
    track = element(
        "AE",
        *(unsigned("D7", 1), unsigned("73C5", 1), unsigned("83", 1), text("86", "V_VP8")),
        element("E0", unsigned("B0", size[0]), unsigned("BA", size[1])),
    )
    blocks = [image_block(1, 33 * i, bytes(100)) for i in range(frames)]
    segment = [
        element(
            "1549A966", unsigned("2AD7B1", 10**6), text("4D80", "test"), text("5741", "test")
        ),
        element("1654AE6B", track),
        element("1F43B675", unsigned("E7", 0), *blocks),
    ]
    head = element("1A45DFA3", text("4282", "matroska"), unsigned("4287", 2), unsigned("4285", 2))
    return head + element("18538067", *segment)
