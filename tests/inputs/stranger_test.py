# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings with several faults at once, and by conventions of one's own: calibrations that are
none or lie elsewhere, messages that are wrong about their bytes, rows and names of other programs,
recordings of which a part is packed or lost. What is advised is done, and works.

Usage: stranger_test.py SGS_EXECUTABLE [unittest arguments]
"""
import json
import re
import shutil
import subprocess
import unittest

import numpy as np

import foreign_writers as foreign
import ros2_messages as ros2
from found_case import COLOR, DEPTH, FRAME, FRAMES, SGS, START_NS, TRACK_ONLY, Found


class Calibrations(Found):
    def with_infos(self, *before, **info):
        """Images with an info beside each, behind other messages."""
        messages = list(before)
        for i in range(FRAMES):
            messages += [self.color_info(i, **dict(info)), *self.pair(i)]
        return self.bag(messages)

    def test_a_unit_matrix_is_no_calibration(self):
        path = self.with_infos(k=(1.0, 1.0, 0.0, 0.0))
        self.assertIn("not calibrated", self.refused(path))
        self.assert_same(path, "--camera", ",".join(map(str, self.k)))

    def test_a_matrix_of_nan_stays_the_same(self):
        path = self.with_infos(k=(float("nan"),) * 4, p=self.k)
        said = self.warnings(path)
        self.assertIn("P is taken", said)
        self.assertNotIn("changes on the way", said)
        self.assert_same(path)

    def test_a_principal_point_that_was_left_out(self):
        path = self.with_infos(k=(*self.k[:2], 0.0, 0.0))
        self.assertIn("principal point", self.warnings(path))
        self.assert_same(path, "--camera", ",".join(map(str, self.k)))
        self.assertNotIn("principal point", self.warnings(self.bag(self.plain(), "b.db3")))

    def test_infos_in_a_place_of_their_own(self):
        other = ros2.camera_info((100.0, 100.0, 10.0, 10.0), self.size, START_NS, "other")
        messages = [("/calib/depth", ros2.INFO, START_NS, other)]
        messages += [
            (t.replace(COLOR + "/camera_info", "/calib/rgb"), *m) for t, *m in self.plain()
        ]
        path = self.bag(messages)
        self.assertEqual(self.info(path)["calibration_source"], "/calib/rgb")
        self.assert_same(path)
        # Two of one frame: they are listed, and one is chosen.
        messages.append(("/calib/again", *messages[1][1:]))
        path = self.bag(messages, "two.db3")
        self.assertIn("/calib/rgb", self.refused(path))
        self.assert_same(path, "--topics", "color_info=/calib/rgb")

    def test_another_lens_of_the_same_frame_is_named(self):
        zeros = dict(model="equidistant", d=(0.0,) * 4)
        bent = ros2.camera_info(
            self.k, self.size, START_NS, FRAME, model="equidistant", d=(-0.02, 0.01, -0.003, 0.0005)
        )
        path = self.with_infos(("/factory/camera_info", ros2.INFO, START_NS, bent), **zeros)
        said = self.warnings(path)
        self.assertIn("--topics color_info=/factory/camera_info", said)
        chosen = self.info(path, "--topics", "color_info=/factory/camera_info")
        self.assertEqual(chosen["lens"], "fisheye")

    def test_files_of_ones_own_programs(self):
        fx, fy, cx, cy = self.k
        rows = f"{fx} 0 {cx}\n0 {fy} {cy}\n0 0 1\n"
        named = {"fx": fx, "fy": fy, "ppx": cx, "ppy": cy, "width": self.size[0]}
        named.update(height=self.size[1], coeffs=[0] * 5, model="distortion.brown_conrady")
        folder = self.two_folders("own", lambda i, t: f"{i:06d}.png")
        self.assertIn("--camera FILE", self.refused(folder, "--depth-scale", "1000"))
        for name, text in (
            ("cam_K.txt", rows),
            ("intrinsics.txt", rows.replace("\n", " 0\n") + "0 0 0 1\n"),
            ("K.txt", f"[[{fx}, 0, {cx}],\n [0, {fy}, {cy}],\n [0, 0, 1]]\n"),
            ("intrinsics.json", json.dumps(named)),
            ("camera.json", json.dumps({"intrinsics": {**named, "depth_scale": 0.001}})),
            ("calibration.json", json.dumps({"K": [[fx, 0, cx], [0, fy, cy], [0, 0, 1]]})),
        ):
            with self.subTest(name):
                foreign.put(folder / name, text)
                self.assert_same(folder, "--depth-scale", "1000", within=1e-4)
                self.assertIn(
                    name, self.info(folder, "--depth-scale", "1000")["calibration_source"]
                )
                bag = self.bag(self.plain())
                self.assert_same(bag, "--camera", folder / name, within=1e-4)
                if name == "camera.json":
                    self.assert_same(folder, within=1e-4)
                else:
                    self.assertIn("--depth-scale", self.refused(folder))
                (folder / name).unlink()
        foreign.put(folder / "calibration.json", '{"gripper": 3}')
        text = self.refused(folder)
        self.assertIn("calibration.json", text)
        self.assertIn("--camera fx,fy,cx,cy", text)
        self.assert_same(folder, *self.camera, within=1e-4)


class Mistakes(Found):
    def color_as(self, name, message):
        messages = []
        for i in range(FRAMES):
            color = (COLOR + "/image_raw", ros2.IMAGE, self.stamps[i], message(i))
            messages += [self.color_info(i), color, self.pair(i)[1]]
        return self.bag(messages, f"{name}.db3")

    def test_rows_that_are_said_too_short(self):
        for step in (0, self.size[0]):

            def message(i):
                w = ros2.Writer().header(self.stamps[i], FRAME)
                w.number("I", self.size[1], self.size[0]).text("rgb8")
                w.number("B", 0).number("I", step)
                return w.octets(self.r.color[i].tobytes()).done()

            path = self.color_as(f"step{step}", message)
            self.assertIn(f"step says rows of {step} bytes", self.warnings(path))
            self.assert_same(path)

    def test_grey_of_sixteen_bits_is_a_colour_if_it_is_chosen(self):
        def message(i):
            grey = (self.r.color[i].mean(2) * 256).astype(np.uint16)
            return ros2.image(grey, "mono16", self.stamps[i], FRAME)

        path = self.color_as("mono16", message)
        text = self.refused(path)
        self.assertIn("--topics color=/TOPIC,depth=/TOPIC", text)
        topics = f"color={COLOR}/image_raw,depth={DEPTH}/image_raw"
        self.assert_same(path, "--topics", topics, within=2e-3)

    def test_depth_for_people_is_named(self):
        messages = []
        for i in range(FRAMES):
            seen = ros2.image(
                (self.r.depth[i] // 16).astype(np.uint8), "8UC1", self.stamps[i], FRAME
            )
            depth = (DEPTH + "/image_raw", ros2.IMAGE, self.stamps[i], seen)
            messages += [self.color_info(i), self.pair(i)[0], depth]
        text = self.refused(self.bag(messages))
        self.assertIn("pictures for people (8UC1)", text)
        self.assertIn("16UC1", text)

    def test_aligned_depth_before_other(self):
        folder = self.two_folders("aligned", lambda i, t: f"{t + 1.7e9:.6f}.png", "color")
        (folder / "depth").rename(folder / "aligned_depth")
        for i, t in enumerate(self.r.times):
            other = (self.r.depth[i] // 2).astype(np.uint16)
            foreign.put(folder / f"depth/{t + 1.7e9:.6f}.png", foreign.png(other))
        self.assert_same(folder, *self.camera, within=1e-4)

    def test_a_clock_that_is_set_ahead_is_said(self):
        early = lambda i, ns: ns - START_NS + 13 * 10**9 if i < FRAMES // 2 else ns
        messages = []
        for i in range(FRAMES):
            messages += [self.color_info(i), *self.pair(i, early(i, self.stamps[i]))]
        _, log = self.assert_same(self.bag(messages), within=0.005)
        self.assertIn("set ahead by 16999999", log)
        time = lambda i, t: t + (13 if i < FRAMES // 2 else 1.7e9)
        folder = self.listed("ahead", lambda i, t, n: f"{time(i, t):.6f} {n}")
        self.assertIn("set ahead by 16999999", self.warnings(folder))
        self.assert_same(folder, within=0.005)

    def test_times_too_large_are_waited_for_once(self):
        messages = []
        for i in range(FRAMES):
            stamp = START_NS + (self.stamps[i] - START_NS) * 1000
            messages += [self.color_info(i), *self.pair(i, stamp, received=self.stamps[i])]
        path = self.bag(messages)
        self.assertIn("--stamps received", self.warnings(path))
        out = self.folder / "live"
        self.sgs("run", path, "-o", out, *TRACK_ONLY, "--realtime")
        self.assertEqual((out / "log.txt").read_text().count("is not waited for"), 1)
        self.assert_same(path, "--stamps", "received")


class Rows(Found):
    def test_rows_as_other_programs_write_them(self):
        stamp = lambda t: f"{t + 1.7e9:.6f}"
        for name, row in (
            ("quoted", lambda i, t, n: f'"{stamp(t)}","{n}"'),
            ("counted", lambda i, t, n: f"{i} {stamp(t)} {n}"),
            ("counted with commas", lambda i, t, n: f"{i},{stamp(t)},{n}"),
            ("dates", lambda i, t, n: f"2024-05-01T12:00:{t:06.3f}Z {n}"),
            ("dates with blanks", lambda i, t, n: f"2024-05-01 12:00:{t:06.3f} {n}"),
            ("dates with commas", lambda i, t, n: f"2024-05-01 12:00:{t:06.3f},{n}"),
            ("of the day", lambda i, t, n: f"12:00:{t:06.3f} {n}"),
            ("ticks", lambda i, t, n: f"{round(t * 1e7) + 133 * 10**15} {n}"),
        ):
            with self.subTest(name):
                folder = self.listed(name, row)
                info = self.info(folder)
                self.assertFalse(info["sparse"])
                self.assertEqual("ticks" in " ".join(info["warnings"]), name == "ticks")
                path, _ = self.assert_same(folder, within=1e-3)
                self.assertAlmostEqual(path[-1, 0] - path[0, 0], self.r.times[-1], delta=1e-3)

    def test_comma_tab_and_the_other_utf_16_at_once(self):
        folder = self.copy("all")
        for file in ("rgb.txt", "depth.txt"):
            text = "".join(
                f"{float(t) + 1.7e9:.6f}".replace(".", ",") + f"\t{n}\r\n"
                for t, n in self.rows(folder, file)
            )
            (folder / file).write_bytes(b"\xfe\xff" + text.encode("utf-16-be"))
        self.assert_same(folder)

    def test_rows_that_stand_there_again(self):
        folder = self.copy("thrice")
        for file in ("rgb.txt", "depth.txt"):
            foreign.put(folder / file, (folder / file).read_text() * 3)
        said = self.warnings(folder)
        self.assertIn("48 rows stand there more than once", said)
        self.assertNotIn("set back", said)
        self.assert_same(folder)

    def test_pairs_with_one_time(self):
        folder = self.copy("three")
        pairs = list(zip(self.rows(folder, "rgb.txt"), self.rows(folder, "depth.txt")))
        for file in ("rgb.txt", "depth.txt"):
            (folder / file).unlink()
        text = "".join(f"{t} {c} {d}\n" for (t, c), (_, d) in pairs)
        foreign.put(folder / "associations.txt", text)
        self.assert_same(folder)

    def test_milliseconds_with_fractions_are_asked_about(self):
        folder = self.listed("fraction", lambda i, t, n: f"{t * 1e3 + 81234.5:.3f} {n}")
        self.assertIn("if they are milliseconds", self.warnings(folder))
        self.assertNotIn("milliseconds", self.warnings(self.shared / "tum"))


class Names(Found):
    def test_times_in_names(self):
        since_1970 = lambda t: f"{1_700_000_000 + int(t)}"
        for name, picture in (
            ("two numbers", lambda i, t: f"{since_1970(t)}_{round(t % 1 * 1e9):09d}.png"),
            ("two behind a word", lambda i, t: f"rgb-{since_1970(t)}-{round(t % 1 * 1e6):06d}.png"),
            ("behind a word", lambda i, t: f"left_{t + 1.7e9:.6f}.png"),
            ("since a start", lambda i, t: f"left_{t + 7:.6f}.png"),
            ("behind a count", lambda i, t: f"frame_{i:06d}_{round((t + 1.7e9) * 1e3)}.png"),
            ("dates", lambda i, t: f"2024-05-01-12-00-{t + 1:06.3f}.png"),
            ("short dates", lambda i, t: f"20240501_1200{t + 1:06.3f}.png"),
        ):
            with self.subTest(name):
                folder = self.two_folders(name, picture)
                info = self.info(folder, *self.camera)
                self.assertFalse(info["sparse"])
                self.assertIn("names", info["times_source"])
                path, _ = self.assert_same(folder, *self.camera, within=1e-3)
                self.assertAlmostEqual(path[-1, 0] - path[0, 0], self.r.times[-1], delta=2e-3)

    def test_numbers_that_do_not_tell_pictures_apart(self):
        for name, picture in (
            ("number within", lambda i, t: f"{i + 1}_x.png"),
            ("the same behind", lambda i, t: f"shot{i + 1}-v2.png"),
        ):
            with self.subTest(name):
                folder = self.two_folders(name, picture)
                self.assertIn("in the order of their names", self.warnings(folder, *self.camera))
                self.assert_same(folder, *self.camera, within=1e-4)
        # Not equally many: there is no order to go by.
        next((folder / "depth").iterdir()).unlink()
        self.assertIn("sgs.toml", self.refused(folder, *self.camera))

    def test_numbers_without_zeros_in_front(self):
        folder = self.two_folders("plain", lambda i, t: f"IMG{i + 1}.PNG", "RGB", "Depth")
        self.assert_same(folder, *self.camera, within=1e-4)


class Parts(Found):
    def unpack(self, text):
        """Runs the command in back quotes."""
        command = re.search(r"`([^`]+)`", text).group(1)
        subprocess.run(["bash", "-ec", command], check=True, cwd=self.folder, capture_output=True)

    def test_folders_that_are_packed_one_by_one(self):
        if not (shutil.which("zip") and shutil.which("unzip")):
            self.skipTest("zip and unzip are not installed")
        for name, inner in (("with their folder", True), ("without it", False)):
            folder = self.copy(name)
            for part in ("rgb", "depth"):
                archive = folder / f"{part}.zip"
                where, what = (folder, part) if inner else (folder / part, ".")
                subprocess.run(["zip", "-qr", archive, what], cwd=where, check=True)
                shutil.rmtree(folder / part)
            bare = self.folder / f"{name}, no lists"
            bare.mkdir()
            for part in ("rgb.zip", "depth.zip"):
                shutil.copy(folder / part, bare)
            with self.subTest(name):
                text = self.refused(folder)
                self.assertIn("depth.zip, rgb.zip are packed", text)
                self.unpack(text)
                self.assert_same(folder)
                self.unpack(self.refused(bare, *self.camera))
                self.assert_same(bare, *self.camera, within=1e-4)

    def test_an_empty_folder_is_named(self):
        folder = self.two_folders("empty", lambda i, t: f"{i}.png")
        shutil.rmtree(folder / "rgb")
        (folder / "rgb").mkdir()
        self.assertIn("nothing lies in rgb", self.refused(folder, *self.camera))

    def split(self, folder):
        messages = self.plain()
        half = 3 * (FRAMES // 2)
        ros2.write_db3(folder / "w_0.db3", messages[:half])
        ros2.write_db3(folder / "w_1.db3", messages[half:])
        return folder

    def test_a_last_part_without_content(self):
        folder = self.split(self.folder / "walk")
        for content in (b"", bytes(4096)):
            (folder / "w_2.db3").write_bytes(content)
            files = sorted(folder.iterdir())
            self.assertIn("left out", self.warnings(*files))
            self.assert_same(*files)
            self.assert_same(folder)
        self.assertIn("no such file", self.refused(folder / "w_0.db3", folder / "w_9.db3").lower())

    def test_a_part_that_is_packed_yet(self):
        if not shutil.which("zstd"):
            self.skipTest("zstd is not installed")
        folder = self.split(self.folder / "walk")
        part = folder / "w_1.db3"
        subprocess.run(["zstd", "-q", "--rm", part, "-o", f"{part}.zstd"], check=True)
        said = self.warnings(folder)
        self.assertIn("packed parts are left out", said)
        self.unpack(said)
        self.assertNotIn("packed", self.warnings(folder))
        self.assert_same(folder)

    def test_a_recording_without_an_ending(self):
        path = self.bag(self.plain())
        for name in ("walk", "walk.db3.1"):
            shutil.copy(path, self.folder / name)
            self.assert_same(self.folder / name)

    def test_a_bag_beside_images_is_named(self):
        folder = self.copy("both")
        ros2.write_db3(folder / "walk.db3", self.plain())
        self.assertIn("not walk.db3", self.warnings(folder))
        self.assert_same(folder)
        self.assert_same(folder / "walk.db3")


if __name__ == "__main__":
    unittest.main()
