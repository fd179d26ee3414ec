# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Writes a sequence in the layouts of other data sets and programs, from their published formats.

Shares no code with the program under test. A `Recording` is what a TUM folder holds; each
`write_...` puts it into another layout.
"""
import dataclasses
import io
import json
import math
import pathlib
import shutil
import struct
import zipfile
import zlib

import numpy as np
from PIL import Image

OPENGL = np.diag([1.0, -1.0, -1.0, 1.0])
Y_UP = np.diag([1.0, -1.0, 1.0, 1.0])


@dataclasses.dataclass
class Recording:
    """Images as arrays (height x width x 3 of uint8, height x width of uint16), poses 4x4."""

    times: list
    color: list
    depth: list
    poses: list  # camera to world, OpenCV axes
    fx: float
    fy: float
    cx: float
    cy: float
    depth_scale: float

    @property
    def width(self):
        return self.color[0].shape[1]

    @property
    def height(self):
        return self.color[0].shape[0]

    @property
    def K(self):
        return np.array([[self.fx, 0, self.cx], [0, self.fy, self.cy], [0, 0, 1.0]])


def png(array):
    """A PNG file of 8-bit grey or colour, or of 16-bit grey."""
    height, width = array.shape[:2]
    bits = 16 if array.dtype == np.uint16 else 8
    kind = 2 if array.ndim == 3 else 0
    rows = array.astype(">u2") if bits == 16 else array
    data = b"".join(b"\0" + rows[y].tobytes() for y in range(height))
    chunks = (
        (b"IHDR", struct.pack(">IIBBBBB", width, height, bits, kind, 0, 0, 0)),
        (b"IDAT", zlib.compress(data, 1)),
        (b"IEND", b""),
    )
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(d)) + k + d + struct.pack(">I", zlib.crc32(k + d)) for k, d in chunks
    )


@dataclasses.dataclass
class Picture:
    """How colour is kept."""

    ending: str
    pack: object  # of an array

    def put(self, path, array):
        put(path.with_name(path.name + self.ending), self.pack(array))


def put(path, content):
    path.parent.mkdir(parents=True, exist_ok=True)
    if isinstance(content, bytes):
        path.write_bytes(content)
    else:
        path.write_text(content)


def jpeg(array):
    data = io.BytesIO()
    Image.fromarray(array).save(data, "jpeg", quality=95)
    return data.getvalue()


PNG, JPEG = Picture(".png", png), Picture(".jpg", jpeg)


def matrix_text(matrix):
    return "".join(" ".join(repr(float(v)) for v in row) + "\n" for row in matrix)


def quaternion(R):
    """x y z w of a rotation matrix."""
    w = math.sqrt(max(0.0, 1 + R[0, 0] + R[1, 1] + R[2, 2])) / 2
    x = math.copysign(math.sqrt(max(0.0, 1 + R[0, 0] - R[1, 1] - R[2, 2])) / 2, R[2, 1] - R[1, 2])
    y = math.copysign(math.sqrt(max(0.0, 1 - R[0, 0] + R[1, 1] - R[2, 2])) / 2, R[0, 2] - R[2, 0])
    z = math.copysign(math.sqrt(max(0.0, 1 - R[0, 0] - R[1, 1] + R[2, 2])) / 2, R[1, 0] - R[0, 1])
    return x, y, z, w


def rotation(x, y, z, w):
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def rotation_vector(R):
    angle = math.acos(min(1.0, max(-1.0, (np.trace(R) - 1) / 2)))
    axis = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    length = np.linalg.norm(axis)
    return axis * (angle / length) if length > 1e-12 else np.zeros(3)


def read_tum(folder):
    """The recording of a TUM folder whose colour and depth images have equal times."""
    folder = pathlib.Path(folder)

    def rows(name):
        lines = (folder / name).read_text().splitlines()
        return [line.split() for line in lines if line and not line.startswith("#")]

    camera = [float(v) for v in rows("camera.txt")[0]]
    poses = {}
    for row in rows("groundtruth.txt"):
        v = [float(x) for x in row]
        T = np.eye(4)
        T[:3, :3] = rotation(*v[4:])
        T[:3, 3] = v[1:4]
        poses[round(v[0], 6)] = T
    colors, depths = rows("rgb.txt"), rows("depth.txt")
    times = [float(row[0]) for row in colors]
    return Recording(
        times,
        [np.asarray(Image.open(folder / row[1]).convert("RGB")) for row in colors],
        [np.asarray(Image.open(folder / row[1])).astype(np.uint16) for row in depths],
        [poses[round(t, 6)] for t in times],
        *camera[:4],
        camera[6],
    )


def write_tum(r, out):
    """Without sgs.toml: camera.txt alone says the camera."""
    lists = {"rgb": "", "depth": ""}
    truth = ""
    for i, t in enumerate(r.times):
        put(out / f"rgb/{i}.png", png(r.color[i]))
        put(out / f"depth/{i}.png", png(r.depth[i]))
        for kind in lists:
            lists[kind] += f"{t!r} {kind}/{i}.png\n"
        T = r.poses[i]
        numbers = [t, *T[:3, 3], *quaternion(T[:3, :3])]
        truth += " ".join(repr(float(v)) for v in numbers) + "\n"
    for kind, text in lists.items():
        put(out / f"{kind}.txt", text)
    put(out / "groundtruth.txt", truth)
    put(
        out / "camera.txt",
        f"{r.fx} {r.fy} {r.cx} {r.cy} {r.width} {r.height} {r.depth_scale}\n",
    )


def write_eth3d(r, out):
    write_tum(r, out)
    (out / "camera.txt").unlink()
    put(out / "calibration.txt", f"{r.fx} {r.fy} {r.cx} {r.cy}\n")


def write_bonn(r, out):
    write_tum(r, out)
    (out / "camera.txt").unlink()


def write_icl(r, out):
    """Frame numbers for times, depth first, poses of a left-handed world with y up."""
    associations = truth = ""
    for i in range(len(r.times)):
        put(out / f"rgb/{i}.png", png(r.color[i]))
        put(out / f"depth/{i}.png", png(r.depth[i]))
        associations += f"{i} depth/{i}.png {i} rgb/{i}.png\n"
        T = Y_UP @ r.poses[i] @ Y_UP
        numbers = [*T[:3, 3], *quaternion(T[:3, :3])]
        truth += f"{i} " + " ".join(repr(float(v)) for v in numbers) + "\n"
    put(out / "associations.txt", associations)
    put(out / "livingRoom2.gt.freiburg", truth)


def write_scannet(r, out, picture=PNG):
    for i in range(len(r.times)):
        picture.put(out / f"color/{i}", r.color[i])
        put(out / f"depth/{i}.png", png(r.depth[i]))
        pose = r.poses[i] if i != 2 else np.full((4, 4), -math.inf)
        put(out / f"pose/{i}.txt", matrix_text(pose))
    K = np.eye(4)
    K[:3, :3] = r.K
    for kind in "color", "depth":
        put(out / f"intrinsic/intrinsic_{kind}.txt", matrix_text(K))
        put(out / f"intrinsic/extrinsic_{kind}.txt", matrix_text(np.eye(4)))


def sens_header(r, color_coding=1, depth_coding=1, frames=None, depth_K=None, sizes=None):
    def floats(matrix):
        return struct.pack("<16f", *np.asarray(matrix, float).ravel())

    K = np.eye(4)
    K[:3, :3] = r.K
    name = b"StructureSensor"
    sizes = sizes or (r.width, r.height, r.depth[0].shape[1], r.depth[0].shape[0])
    return (
        struct.pack("<IQ", 4, len(name))
        + name
        + floats(K)
        + floats(np.eye(4))
        + floats(K if depth_K is None else depth_K)
        + floats(np.eye(4))
        + struct.pack("<ii4If", color_coding, depth_coding, *sizes, r.depth_scale)
        + struct.pack("<Q", len(r.times) if frames is None else frames)
    )


def sens_frame(r, i, color=None, depth=None, lengths=None):
    color = png(r.color[i]) if color is None else color
    depth = zlib.compress(r.depth[i].astype("<u2").tobytes()) if depth is None else depth
    microseconds = round(r.times[i] * 1e6)
    return (
        struct.pack("<16f", *r.poses[i].ravel())
        + struct.pack("<QQ", microseconds, microseconds)
        + struct.pack("<QQ", *(lengths or (len(color), len(depth))))
        + color
        + depth
    )


def write_sens(r, out, pack_color=png, pack_depth=None, **header):
    """`pack_...`: how an array becomes bytes; the codings in the header have to say the same."""
    frames = [
        sens_frame(r, i, pack_color(r.color[i]), pack_depth(r.depth[i]) if pack_depth else None)
        for i in range(len(r.times))
    ]
    put(out, sens_header(r, **header) + b"".join(frames))


def write_seven_scenes(r, out):
    for i in range(len(r.times)):
        depth = r.depth[i].copy()
        depth[depth == 0] = 65535
        put(out / f"frame-{i:06}.color.png", png(r.color[i]))
        put(out / f"frame-{i:06}.depth.png", png(depth))
        put(out / f"frame-{i:06}.pose.txt", matrix_text(r.poses[i]).replace(" ", "\t "))


def write_open3d(r, out, picture=PNG):
    log = ""
    for i in range(len(r.times)):
        picture.put(out / f"color/{i + 1:05}", r.color[i])
        put(out / f"depth/{i + 1:05}.png", png(r.depth[i]))
        log += f"{i} {i} {i + 1}\n" + matrix_text(r.poses[i])
    put(out / "trajectory.log", log)
    intrinsics = dict(width=r.width, height=r.height, intrinsic_matrix=list(r.K.T.ravel()))
    put(out / "camera_intrinsic.json", json.dumps(intrinsics))


def write_sun3d(r, out, picture=PNG):
    poses = ""
    for i, t in enumerate(r.times):
        name = f"{i + 1:07}-{round(t * 1e6):012}"
        turned = (r.depth[i].astype(np.uint32) << 3 | r.depth[i].astype(np.uint32) >> 13) & 0xFFFF
        picture.put(out / "image" / name, r.color[i])
        PNG.put(out / "depth" / name, turned.astype(np.uint16))
        poses += matrix_text(r.poses[i][:3])
    put(out / "intrinsics.txt", matrix_text(r.K))
    put(out / "extrinsics/20140312192711.txt", poses)


def write_transforms(r, out, names=None, times=True, order=None, cameras=None, picture=PNG):
    """nerfstudio: pixel centres at halves, OpenGL axes, frames in any order."""
    frames = []
    for i in range(len(r.times)):
        name = names[i] if names else f"{i}"
        picture.put(out / f"images/{name}", r.color[i])
        put(out / f"depths/{name}.png", png(r.depth[i]))
        frames.append(
            dict(
                file_path=f"images/{name}{picture.ending}",
                depth_file_path=f"depths/{name}.png",
                transform_matrix=(r.poses[i] @ OPENGL).tolist(),
            )
        )
        if times:
            frames[i]["timestamp"] = r.times[i]
        if cameras:
            frames[i].update(cameras[i])
    document = dict(
        camera_model="OPENCV",
        fl_x=r.fx,
        fl_y=r.fy,
        cx=r.cx + 0.5,
        cy=r.cy + 0.5,
        w=r.width,
        h=r.height,
        depth_unit_scale_factor=1 / r.depth_scale,
        frames=[frames[i] for i in order or range(len(frames))],
    )
    put(out / "transforms.json", json.dumps(document))


def write_polycam(r, out, corrected=True, picture=PNG):
    """Names are microseconds, ARKit's axes, a camera per picture."""
    folders = ("corrected_images", "corrected_cameras") if corrected else ("images", "cameras")
    for i, t in enumerate(r.times):
        name = f"{round(t * 1e6)}"
        picture.put(out / f"keyframes/{folders[0]}/{name}", r.color[i])
        put(out / f"keyframes/depth/{name}.png", png(r.depth[i]))
        confidence = np.where(r.depth[i] > 0, 255, 0).astype(np.uint8)
        put(out / f"keyframes/confidence/{name}.png", png(confidence))
        T = r.poses[i] @ OPENGL
        camera = dict(fx=r.fx, fy=r.fy, cx=r.cx, cy=r.cy, width=r.width, height=r.height)
        camera.update({f"t_{a}{b}": T[a, b] for a in range(3) for b in range(4)})
        put(out / f"keyframes/{folders[1]}/{name}.json", json.dumps(camera))


def write_arkit_scenes(r, out, cameras=None):
    """Poses world to camera as rotation vectors, a few milliseconds off; a camera per picture."""
    trajectory = ""
    for i, t in enumerate(r.times):
        name = f"42444946_{t:.3f}"
        put(out / f"lowres_wide/{name}.png", png(r.color[i]))
        put(out / f"lowres_depth/{name}.png", png(r.depth[i]))
        put(out / f"confidence/{name}.png", png(np.full(r.depth[i].shape, 2, np.uint8)))
        K = cameras[i] if cameras else (r.fx, r.fy, r.cx, r.cy)
        pincam = " ".join(repr(float(v)) for v in (r.width, r.height, *K))
        put(out / f"lowres_wide_intrinsics/42444946_{t + 0.001:.3f}.pincam", pincam + "\n")
        T = np.linalg.inv(r.poses[i])
        numbers = [t + 0.002, *rotation_vector(T[:3, :3]), *T[:3, 3]]
        trajectory += " ".join(repr(float(v)) for v in numbers) + "\n"
    put(out / "lowres_wide.traj", trajectory)


def lzfse_stored(content):
    return b"bvx-" + struct.pack("<I", len(content)) + content + b"bvx$"


def write_record3d(r, path, depth=None):
    """A .r3d archive whose LZFSE blocks are stored ones; `depth` replaces packed depth by frame."""
    path.parent.mkdir(parents=True, exist_ok=True)
    height, width = r.depth[0].shape
    meta = dict(
        w=r.width,
        h=r.height,
        dw=width,
        dh=height,
        fps=30,
        K=list(r.K.T.ravel()),
        frameTimestamps=r.times,
        poses=[],
    )
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for i in range(len(r.times)):
            T = r.poses[i] @ OPENGL
            meta["poses"].append([*quaternion(T[:3, :3]), *T[:3, 3]])
            # PNG under the name of a JPEG: readers go by the bytes, and nothing is lost.
            archive.writestr(f"rgbd/{i}.jpg", png(r.color[i]))
            metres = (r.depth[i] / r.depth_scale).astype("<f4")
            metres[r.depth[i] == 0] = math.nan
            archive.writestr(
                f"rgbd/{i}.depth", (depth or {}).get(i, lzfse_stored(metres.tobytes()))
            )
            sure = np.where(r.depth[i] > 0, 2, 0).astype(np.uint8)
            archive.writestr(f"rgbd/{i}.conf", lzfse_stored(sure.tobytes()))
        archive.writestr("metadata", json.dumps(meta))


def remove(path):
    shutil.rmtree(path, ignore_errors=True)
