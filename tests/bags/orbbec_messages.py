# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Messages of recordings that OrbbecSDK v2 makes: bags of ROS 1 with types of its own, and images and
samples that have more behind what ROS puts into them. Packed as the SDK's public headers have them.
"""
import struct

SENSORS = {"color": 2, "depth": 3, "accelerometer": 4, "gyroscope": 5}
FRAMES = {"color": 2, "depth": 3, "accelerometer": 4, "gyroscope": 7}
FLEXIBLE_UNIT, UNIT_LEVEL = 176, 75


class Packed(bytes):
    """A message that is packed already."""


def header(time_ns):
    return struct.pack("<IIII", 0, *divmod(time_ns, 10**9), 0)  # without a frame


def sized(data):
    return struct.pack("<I", len(data)) + data


def topic(stream):
    return f"/cam/sensor_{SENSORS[stream]}/frameType_{FRAMES[stream]}"


def tail(time_ns):
    """Frame number, and three clocks in microseconds."""
    return struct.pack("<4Q", 7, *[time_ns // 1000] * 3)


def image(stream, pixels, encoding, time_ns):
    height, width = pixels.shape[:2]
    data = pixels.tobytes()
    packed = (
        header(time_ns)
        + struct.pack("<II", height, width)
        + sized(encoding.encode())
        + struct.pack("<BI", 0, len(data) // height)
        + sized(data)
        + struct.pack("<f", 1)
        + tail(time_ns)
        + sized(b"")
        + struct.pack("<IB", 0, 16)
    )
    return (topic(stream), "sensor_msgs/Image", Packed(packed), time_ns)


def imu(stream, value, time_ns):
    felt = stream == "accelerometer"
    rate, acceleration = ((0, 0, 0), value) if felt else (value, (0, 0, 0))
    packed = (
        header(time_ns)
        + struct.pack("<4d9d", *[0] * 13)
        + struct.pack("<3d9d", *rate, *[0] * 9)
        + struct.pack("<3d9d", *acceleration, *[0] * 9)
        + sized(struct.pack("<3f", *value))
        + struct.pack("<IQf", 12, 7, 30)
        + struct.pack("<3Q", *[time_ns // 1000] * 3)
    )
    return (topic(stream), "sensor_msgs/Imu", Packed(packed), time_ns)


def transform(rotation, translation_m):
    return struct.pack("<9f", *rotation) + struct.pack("<3f", *(1000 * v for v in translation_m))


def profile(stream, k, size, extrinsics, time_ns, lens=(0,) * 8):
    """Of a stream of images; `extrinsics` as transform() packs them."""
    packed = header(time_ns) + struct.pack("<BB", SENSORS[stream], 28) + extrinsics
    packed += struct.pack("<3H4f8fB", *size, 30, *k, *lens, 1)
    name = f"/cam/streamProfileType_{SENSORS[stream]}"
    return (name, "custom_msg/OBStreamProfileInfo", Packed(packed), time_ns)


def imu_profile(stream, extrinsics, time_ns):
    packed = header(time_ns) + struct.pack("<6B", SENSORS[stream], 20, 1, 5, 0, 0) + extrinsics
    packed += struct.pack("<27d", *[0] * 27)
    name = f"/cam/streamProfileType_{SENSORS[stream]}"
    return (name, "custom_msg/OBImuStreamProfileInfo", Packed(packed), time_ns)


def setting(number, data, time_ns):
    packed = header(time_ns) + struct.pack("<I", number) + sized(data)
    packed += struct.pack("<I", len(data))
    return ("/cam/property", "custom_msg/OBProperty", Packed(packed), time_ns)
