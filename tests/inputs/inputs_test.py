# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""One rendered sequence in every layout that can be read, written by foreign_writers.py.

Usage: inputs_test.py SGS_EXECUTABLE [unittest arguments]
"""
import dataclasses
import json
import pathlib
import resource
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import zlib

import numpy as np

import foreign_writers as foreign

SGS = pathlib.Path(sys.argv.pop(1)).resolve()
FRAMES = 20
TRACK_ONLY = ("--set", "mapper.iterations_per_frame=0", "--no-eval", "--quiet")
MEMORY_LIMIT = 3 << 30  # bytes of address space: far less than the hostile files below announce


def limit_memory():
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_LIMIT, MEMORY_LIMIT))


def positions(path):
    rows = [line.split() for line in path.read_text().splitlines() if not line.startswith("#")]
    return np.array([[float(v) for v in row[1:4]] for row in rows])


class Case(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.shared = pathlib.Path(tempfile.mkdtemp(prefix="sgs-inputs-"))
        master = cls.shared / "master"
        command = [SGS, "synth", "room_desk", master, "--frames", str(FRAMES), "--quiet"]
        subprocess.run(command, check=True, capture_output=True)
        cls.full = foreign.read_tum(master)
        cls.full.depth = [((d + 2) // 5).astype(np.uint16) for d in cls.full.depth]  # millimetres
        cls.full.depth_scale = 1000
        # Every second pixel: the camera at half its size, to the bit.
        half = dataclasses.replace(
            cls.full,
            color=[np.ascontiguousarray(c[::2, ::2]) for c in cls.full.color],
            depth=[np.ascontiguousarray(d[::2, ::2]) for d in cls.full.depth],
            # Numbers that single precision holds, too: .sens files have no more.
            **{k: float(np.float32(getattr(cls.full, k) / 2)) for k in ("fx", "fy", "cx", "cy")},
        )
        cls.counted = dataclasses.replace(half, times=[i / 30 for i in range(FRAMES)])
        cls.timed = dataclasses.replace(half, times=[round(i / 30, 3) for i in range(FRAMES)])
        cls.references = {}
        for name in "counted", "timed":
            foreign.write_tum(getattr(cls, name), cls.shared / name)
            out = cls.shared / f"{name}-run"
            command = [SGS, "run", cls.shared / name, "-o", out, *TRACK_ONLY]
            subprocess.run(command, check=True, capture_output=True, cwd=cls.shared)
            cls.references[name] = out

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.shared, ignore_errors=True)

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="case-", dir=self.shared))

    def sgs(self, *arguments, code=0):
        done = subprocess.run(
            [str(SGS), *map(str, arguments)],
            capture_output=True,
            text=True,
            cwd=self.folder,
            timeout=240,
            preexec_fn=limit_memory,
        )
        self.assertEqual(done.returncode, code, f"{arguments}\n{done.stdout}\n{done.stderr}")
        return done

    def info(self, what, *options):
        return json.loads(self.sgs("info", what, "--json", *options).stdout)

    def run_sequence(self, what, *options):
        out = self.folder / "run"
        foreign.remove(out)
        self.sgs("run", what, "-o", out, *TRACK_ONLY, *options)
        return out

    def assert_same_trajectory(self, run, reference):
        """Equal bits; and the same error against the truth, so that this is the same, too."""
        reference = self.references[reference]
        self.assertEqual(
            (run / "trajectory.txt").read_text(), (reference / "trajectory.txt").read_text()
        )
        self.assert_truth(run, reference)

    def assert_truth(self, run, reference):
        ate = [
            json.loads((folder / "metrics.json").read_text())["ate_rmse_m"]
            for folder in (run, reference)
        ]
        self.assertIsNotNone(ate[0])
        self.assertAlmostEqual(ate[0], ate[1], delta=0.001)

    def assert_near_trajectory(self, run, reference):
        reference = self.references[reference]
        mine, theirs = (positions(folder / "trajectory.txt") for folder in (run, reference))
        self.assertEqual(mine.shape, theirs.shape)
        self.assertLess(np.linalg.norm(mine - theirs, axis=1).max(), 0.001)
        self.assert_truth(run, reference)


class Layouts(Case):
    def lossless(self, write, layout, recording, *options, file=None, **arguments):
        """`sgs info` names the layout; the run and the run of what `sgs convert` makes of it are
        those of the TUM folder, to the bit."""
        with self.subTest(layout):
            folder = self.folder / layout.replace(" ", "_")
            what = folder / file if file else folder
            write(getattr(self, recording), what, **arguments)
            started = time.monotonic()
            info = self.info(what, *options)
            seconds = time.monotonic() - started
            self.assertEqual(info["layout"], layout)
            self.assertEqual(info["frames"], FRAMES)
            self.assertGreaterEqual(info["truth_rows"], FRAMES - 1)
            self.assertFalse(info["sparse"])
            run = self.run_sequence(what, *options)
            self.assert_same_trajectory(run, recording)
            converted = self.folder / f"{folder.name}-converted"
            self.sgs("convert", what, converted, "--quiet", *options)
            self.assertEqual(self.info(converted)["layout"], "tum")
            self.assert_same_trajectory(self.run_sequence(converted), recording)
            print(f"{layout}: sgs info took {seconds:.2f} s", file=sys.stderr)

    def test_layouts_with_their_own_calibration(self):
        self.lossless(foreign.write_scannet, "scannet", "counted")
        self.lossless(foreign.write_sens, "scannet .sens", "timed", file="scene0000_00.sens")
        self.lossless(foreign.write_open3d, "open3d", "counted")  # numbers from 1
        self.lossless(foreign.write_sun3d, "sun3d", "timed")
        backwards = list(reversed(range(FRAMES)))
        self.lossless(foreign.write_transforms, "nerfstudio", "timed", order=backwards)
        self.lossless(foreign.write_polycam, "polycam", "timed")
        self.lossless(foreign.write_arkit_scenes, "arkitscenes", "timed")

    def test_other_codings_and_folders_without_loss(self):
        as_bytes = dict(
            pack_color=lambda array: array.tobytes(),
            pack_depth=lambda array: array.astype("<u2").tobytes(),
            color_coding=0,
            depth_coding=0,
        )
        self.lossless(foreign.write_sens, "scannet .sens", "timed", file="raw.sens", **as_bytes)
        self.lossless(foreign.write_polycam, "polycam", "timed", corrected=False)

    def test_jpegs_move_no_pose_by_more_than_a_millimetre(self):
        jpeg = dict(picture=foreign.JPEG)
        for write, layout, recording, file, options in (
            (foreign.write_scannet, "scannet", "counted", None, jpeg),
            (
                *(foreign.write_sens, "scannet .sens", "timed", "scene.sens"),
                dict(pack_color=foreign.jpeg, color_coding=2),
            ),
            (foreign.write_open3d, "open3d", "counted", None, jpeg),
            (foreign.write_sun3d, "sun3d", "timed", None, jpeg),
            (foreign.write_transforms, "nerfstudio", "timed", None, jpeg),
            (foreign.write_polycam, "polycam", "timed", None, jpeg),
        ):
            with self.subTest(layout):
                folder = self.folder / layout.replace(" ", "_")
                what = folder / file if file else folder
                write(getattr(self, recording), what, **options)
                self.assertEqual(self.info(what)["layout"], layout)
                self.assert_near_trajectory(self.run_sequence(what), recording)

    def test_layouts_with_published_calibrations(self):
        c = self.counted
        camera = ("--camera", f"{c.fx},{c.fy},{c.cx},{c.cy}", "--depth-scale", c.depth_scale)
        self.lossless(foreign.write_seven_scenes, "7-scenes", "counted", *camera)
        self.lossless(foreign.write_icl, "icl-nuim", "counted", *camera)

    def test_published_calibrations_are_used_and_sizes_checked(self):
        three = dataclasses.replace(self.full, times=self.counted.times[:3])
        known = {
            "7-scenes": (foreign.write_seven_scenes, 585.0, 1000),
            "icl-nuim": (foreign.write_icl, 480.0, 5000),
            "bonn": (foreign.write_bonn, 542.576870, 5000),
        }
        for name, (write, fy, depth_scale) in known.items():
            with self.subTest(name):
                folder = self.folder / f"rgbd_bonn_{name}"
                write(three, folder)
                info = self.info(folder)
                self.assertEqual(info["fy"], fy)
                self.assertEqual(info["depth_scale"], depth_scale)
                small = self.folder / f"small_rgbd_bonn_{name}"
                write(dataclasses.replace(self.counted, times=three.times), small)
                done = self.sgs("info", small, code=2)
                self.assertIn("640x480", done.stderr)

    def test_eth3d_calibration(self):
        r = dataclasses.replace(self.timed, depth=[d * 5 for d in self.timed.depth])
        folder = self.folder / "sofa_1"
        foreign.write_eth3d(r, folder)
        info = self.info(folder)
        self.assertEqual((info["fx"], info["depth_scale"]), (r.fx, 5000))
        self.assertIn("calibration.txt", info["calibration_source"])
        self.assert_near_trajectory(self.run_sequence(folder), "timed")

    def test_names_in_natural_order_where_there_are_no_times(self):
        names = [f"frame_{i}" for i in range(FRAMES)]  # frame_10 comes after frame_9
        folder = self.folder / "capture"
        foreign.write_transforms(self.counted, folder, names=names, times=False)
        self.assert_same_trajectory(self.run_sequence(folder / "transforms.json"), "counted")
        self.assertIn("order of their names", " ".join(self.info(folder)["warnings"]))

    def test_what_a_recording_knows_of_a_pose_may_be_missing(self):
        folder = self.folder / "scan"
        foreign.write_scannet(self.counted, folder)  # frame 2 has -inf
        info = self.info(folder)
        self.assertEqual(info["truth_rows"], FRAMES - 1)
        self.assertIn("no usable pose", " ".join(info["warnings"]))


class Sizes(Case):
    """Colour and depth of different size, cameras that change, images that are too wide."""

    def test_colour_finer_than_depth_is_reduced_to_it(self):
        fine = dataclasses.replace(self.timed, color=self.full.color, **self.full_camera())
        K = np.eye(4)
        K[:3, :3] = self.timed.K
        sens = self.folder / "fine.sens"
        foreign.write_sens(fine, sens, depth_K=K)
        info = self.info(sens)
        self.assertEqual((info["width"], info["delivered"]["width"]), (640, 320))
        self.assertAlmostEqual(info["delivered"]["cx"], self.timed.cx)
        self.assert_near_trajectory(self.run_sequence(sens), "timed")

    def full_camera(self):
        return {k: getattr(self.full, k) for k in ("fx", "fy", "cx", "cy")}

    def shifted(self):
        """Windows of each image, cut elsewhere in each frame: principal points that wander."""
        r, cameras, color, depth = self.timed, [], [], []
        for i in range(FRAMES):
            x, y = (0, 4, 8)[i % 3], (0, 2)[i % 2]
            color.append(np.ascontiguousarray(r.color[i][y : y + 236, x : x + 312]))
            depth.append(np.ascontiguousarray(r.depth[i][y : y + 236, x : x + 312]))
            cameras.append((r.fx, r.fy, r.cx - x, r.cy - y))
        return dataclasses.replace(r, color=color, depth=depth), cameras

    def test_intrinsics_that_change_from_frame_to_frame(self):
        recording, cameras = self.shifted()
        scene = self.folder / "42444946"
        foreign.write_arkit_scenes(recording, scene, cameras=cameras)
        self.assert_near_trajectory(self.run_sequence(scene), "timed")
        capture = self.folder / "capture"
        keys = ("fl_x", "fl_y", "cx", "cy")
        shifts = (0, 0, 0.5, 0.5)
        own = [dict(zip(keys, np.add(c, shifts).tolist())) for c in cameras]
        foreign.write_transforms(recording, capture, cameras=own)
        self.assert_near_trajectory(self.run_sequence(capture), "timed")

    def test_wide_images_are_reduced_and_the_camera_with_them(self):
        wide = dataclasses.replace(self.full, times=self.timed.times)
        folder = self.folder / "wide"
        foreign.write_tum(wide, folder)
        self.assertEqual(self.info(folder)["delivered"]["width"], 640)
        info = self.info(folder, "--max-width", 320)
        self.assertEqual(info["delivered"]["width"], 320)
        self.assertAlmostEqual(info["delivered"]["cx"], (self.full.cx + 0.5) / 2 - 0.5, 5)
        # Means of pixels are less noisy than every second pixel: what is learned differs.
        learned = ("photometric.estimate_noise", "delay.estimate", "readout.estimate")
        fixed = [word for key in learned for word in ("--set", f"tracker.{key}=false")]
        out = self.folder / "timed-fixed"
        self.sgs("run", self.shared / "timed", "-o", out, *TRACK_ONLY, *fixed)
        self.references["fixed"] = out
        run = self.run_sequence(folder, "--max-width", 320, *fixed)
        self.assert_near_trajectory(run, "fixed")


class BadInput(Case):
    def refused(self, what, *words, options=(), code=1):
        text = self.sgs("info", what, *options, code=code).stderr
        for word in words:
            self.assertIn(word, text)

    def test_truncated_sens_keeps_its_whole_frames(self):
        sens = self.folder / "cut.sens"
        foreign.write_sens(self.timed, sens)
        content = sens.read_bytes()
        sens.write_bytes(content[: len(content) * 3 // 4])
        info = self.info(sens)
        self.assertLess(info["frames"], FRAMES)
        self.assertGreater(info["frames"], FRAMES // 2)
        self.assertIn("cut off", " ".join(info["warnings"]))
        for size in 3, 40, 300, 500:
            sens.write_bytes(content[:size])
            self.refused(sens, "cut.sens")

    def test_sens_with_lengths_that_lie(self):
        r, huge = self.timed, 1 << 60
        frame = foreign.sens_frame(r, 0)
        sens = self.folder / "liar.sens"
        foreign.put(sens, struct.pack("<IQ", 4, huge) + b"x" * 1000)
        self.refused(sens, "sensor's name")
        foreign.put(sens, foreign.sens_header(r, frames=huge) + frame)
        self.assertEqual(self.info(sens)["frames"], 1)
        foreign.put(sens, foreign.sens_header(r) + foreign.sens_frame(r, 0, lengths=(huge, 10)))
        self.refused(sens, "first frame")
        lengths = (2**64 - 8, 2**64 - 8)
        foreign.put(sens, foreign.sens_header(r) + foreign.sens_frame(r, 0, lengths=lengths))
        self.refused(sens, "first frame")
        sizes = (2**31, 2**31, 2**31, 2**31)
        foreign.put(sens, foreign.sens_header(r, sizes=sizes) + frame)
        self.refused(sens, "2147483648x2147483648")

    def test_sens_depth_that_unpacks_to_more_or_less_is_a_bad_frame(self):
        r = self.timed
        bomb = zlib.compress(bytes(r.depth[0].size * 2 + 100_000_000), 9)
        short = zlib.compress(bytes(10))
        sens = self.folder / "bomb.sens"
        frames = [foreign.sens_frame(r, i) for i in range(FRAMES)]
        frames[1] = foreign.sens_frame(r, 1, depth=bomb)
        frames[2] = foreign.sens_frame(r, 2, depth=short)
        foreign.put(sens, foreign.sens_header(r) + b"".join(frames))
        out = self.run_sequence(sens)
        lines = (out / "frames.csv").read_text().splitlines()
        status = [line.split(",")[lines[0].split(",").index("status")] for line in lines[1:]]
        self.assertEqual([i for i in range(FRAMES) if status[i] == "bad"], [1, 2])

    def test_sens_of_another_coding_names_the_way_out(self):
        sens = self.folder / "occi.sens"
        foreign.write_sens(self.timed, sens, depth_coding=2)
        self.refused(sens, "occi", "export")

    def test_depth_in_an_unknown_unit(self):
        for factor in 0.01, 60:
            folder = self.folder / f"unit{factor}"
            r = dataclasses.replace(self.counted, depth_scale=self.counted.depth_scale * factor)
            foreign.write_tum(r, folder)
            self.refused(folder, "median depth", "--depth-scale", "camera.txt")
            self.assertEqual(self.info(folder, "--depth-scale", 1000)["depth_scale"], 1000)
        capture = self.folder / "capture"
        foreign.write_transforms(self.counted, capture)
        text = (capture / "transforms.json").read_text()
        foreign.put(capture / "transforms.json", text.replace('factor": 0.001', 'factor": 1.0'))
        self.refused(capture, "median depth", "--depth-scale")

    def test_missing_intrinsics_name_the_remedy(self):
        redwood = self.folder / "redwood"
        foreign.write_open3d(self.counted, redwood)
        (redwood / "camera_intrinsic.json").unlink()
        self.refused(redwood, "--camera 525,525,319.5,239.5 --depth-scale 1000")
        capture = self.folder / "capture"
        foreign.write_transforms(self.counted, capture)
        text = (capture / "transforms.json").read_text()
        foreign.put(capture / "transforms.json", text.replace('"fl_x"', '"f"'))
        self.refused(capture, "fl_x", "--camera")
        scene = self.folder / "42444946"
        foreign.write_arkit_scenes(self.timed, scene)
        foreign.remove(scene / "lowres_wide_intrinsics")
        self.refused(scene, "lowres_wide_intrinsics")

    def test_json_that_is_deep_damaged_or_of_the_wrong_shape(self):
        path = self.folder / "capture" / "transforms.json"
        foreign.put(path, "[" * 5_000_000)
        self.refused(path.parent, "32 levels")
        foreign.put(path, '{"frames": [')
        self.refused(path.parent, "transforms.json")
        foreign.put(path, '{"frames": [{"file_path": 3}]}')
        self.refused(path.parent, "needed:", "transform_matrix")
        foreign.put(path, '{"frames": [{"file_path": "a.png"}]}')
        self.refused(path.parent, "depth_file_path")

    def test_a_lens_it_cannot_remove_is_refused_with_the_way_out(self):
        capture = self.folder / "capture"
        foreign.write_transforms(self.counted, capture)
        text = (capture / "transforms.json").read_text()
        foreign.put(capture / "transforms.json", text.replace("OPENCV", "THIN_PRISM_FISHEYE"))
        self.refused(capture, "THIN_PRISM_FISHEYE", "undistort")

    def test_record3d_names_the_converter(self):
        foreign.put(self.folder / "a.r3d", b"PK\x03\x04")
        self.refused(self.folder / "a.r3d", "record3d_to_transforms.py")


class Record3d(Case):
    def convert(self, capture, code=0):
        script = pathlib.Path(__file__).resolve().parents[2] / "scripts/record3d_to_transforms.py"
        out = self.folder / "converted"
        command = [sys.executable, script, capture, out]
        done = subprocess.run(command, capture_output=True, text=True, preexec_fn=limit_memory)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertEqual(out.exists(), code == 0)
        return out, done.stderr

    def test_converted_capture_gives_the_trajectory(self):
        capture = self.folder / "a.r3d"
        foreign.write_record3d(self.timed, capture)
        out, _ = self.convert(capture)
        self.assertEqual(self.info(out)["layout"], "nerfstudio")
        self.assert_same_trajectory(self.run_sequence(out), "timed")

    def test_bombs_and_damage_leave_nothing_behind(self):
        capture = self.folder / "a.r3d"
        for depth, word in (
            (bytes(200_000_000), "unpack to 200000000"),
            (b"bvx2" + struct.pack("<II", 2**31, 0) + bytes(64), "more than a frame"),
            (b"bvxn" + struct.pack("<II", 10**7, 5) + b"12345bvx$", "more than its image"),
            (b"nonsense", "damaged LZFSE"),
        ):
            foreign.write_record3d(self.timed, capture, depth={3: depth})
            _, text = self.convert(capture, code=1)
            self.assertIn(word, text)
            self.assertEqual([p.name for p in self.folder.glob("converted*")], [])
        capture.write_bytes(capture.read_bytes()[:5000])
        self.convert(capture, code=1)


if __name__ == "__main__":
    unittest.main()
