# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""More recordings as other people have them: fisheye lenses and the files that say so, pictures in
other codings, clocks that jump a little, lists of other machines and systems, files that are not
what they are called. What is advised is done, and works.

Usage: elsewhere_test.py SGS_EXECUTABLE [unittest arguments]
"""
import io
import json
import re
import shutil
import socket
import subprocess
import unittest

import numpy as np
from PIL import Image

import foreign_writers as foreign
import ros2_messages as ros2
from found_case import COLOR, DEPTH, DEPTH_FRAME, FRAME, FRAMES, SGS, TRACK_ONLY, Found

FISHEYE = (-0.02, 0.01, -0.003, 0.0005)


def pictured(theta):
    """Kannala and Brandt's polynomial."""
    k1, k2, k3, k4 = FISHEYE
    t = theta * theta
    return theta * (1 + t * (k1 + t * (k2 + t * (k3 + t * k4))))


class Lenses(Found):
    """The same pictures as a fisheye would have taken them."""

    def bent(self):
        fx, fy, cx, cy = self.k
        w, h = self.size
        u, v = np.meshgrid(np.arange(w, dtype=float), np.arange(h, dtype=float))
        x, y = (u - cx) / fx, (v - cy) / fy
        r = np.hypot(x, y)
        theta = r.copy()
        for _ in range(20):
            slope = (pictured(theta + 1e-6) - pictured(theta - 1e-6)) / 2e-6
            theta -= (pictured(theta) - r) / slope
        scale = np.where(r > 1e-9, np.tan(theta) / np.maximum(r, 1e-9), 1)
        su, sv = fx * x * scale + cx, fy * y * scale + cy
        inside = (su >= 0) & (su <= w - 2) & (sv >= 0) & (sv <= h - 2)
        u0, v0 = (np.clip(np.floor(a).astype(int), 0, n - 2) for a, n in ((su, w), (sv, h)))
        a, b = (su - u0)[..., None], (sv - v0)[..., None]
        nearest = (
            np.clip(np.rint(sv).astype(int), 0, h - 1),
            np.clip(np.rint(su).astype(int), 0, w - 1),
        )
        color, depth = [], []
        for c, d in zip(self.r.color, self.r.depth):
            c = c.astype(float)
            top = c[v0, u0] * (1 - a) + c[v0, u0 + 1] * a
            low = c[v0 + 1, u0] * (1 - a) + c[v0 + 1, u0 + 1] * a
            mixed = np.rint(top * (1 - b) + low * b) * inside[..., None]
            color.append(mixed.astype(np.uint8))
            depth.append((d[nearest] * inside).astype(np.uint16))
        return color, depth

    def fisheye_bag(self, name="f.db3", **info):
        color, depth = self.bent()
        messages = []
        for i in range(FRAMES):
            messages += [self.color_info(i, **info), *self.pair(i, color=color[i], depth=depth[i])]
        return self.bag(messages, name)

    def assert_near(self, *what, within=0.004):
        path, log = self.track(*what)
        self.assertEqual(len(path), FRAMES, log)
        self.assertLess(np.abs(path[:, 1:4] - self.reference[:, 1:4]).max(), within)

    def test_a_fisheye_of_a_camera_info(self):
        for model in ("equidistant", "fisheye", "kannala_brandt"):
            path = self.fisheye_bag(model=model, d=FISHEYE)
            info = self.info(path)
            self.assertEqual(info["lens"], "fisheye")
            self.assertEqual(info["distortion"], list(FISHEYE))
            self.assertIn("fisheye k1 k2 k3 k4", self.sgs("info", path).stdout)
            self.assert_near(path)
        # With six numbers nobody knows what they are.
        text = self.refused(self.fisheye_bag(model="equidistant", d=(*FISHEYE, 0.1, 0.1)))
        self.assertIn("equidistant", text)
        numbers = ",".join(map(str, (*self.k, "fisheye", *FISHEYE)))
        self.assert_near(self.folder / "f.db3", "--camera", numbers)

    def test_the_files_that_calibrations_come_in(self):
        (fx, fy, cx, cy), (w, h), d = self.k, self.size, list(FISHEYE)
        flat = f"data: [{fx}, 0, {cx}, 0, {fy}, {cy}, 0, 0, 1]"
        files = {
            "ros.yaml": f"image_width: {w}\nimage_height: {h}\ncamera_name: head\n"
            f"camera_matrix:\n  rows: 3\n  cols: 3\n  {flat}\ndistortion_model: equidistant\n"
            f"distortion_coefficients:\n  rows: 1\n  cols: 4\n  data: {d}\n",
            "opencv.yml": f"%YAML:1.0\n---\nimage_width: {w}\nimage_height: {h}\nfisheye_model: 1\n"
            f"camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   {flat}\n"
            f"distortion_coefficients: !!opencv-matrix\n   rows: 4\n   cols: 1\n   dt: d\n   data: {d}\n",
            "kalibr.yaml": f"cam0:\n  camera_model: pinhole\n  distortion_coeffs: {d}\n"
            f"  distortion_model: equidistant\n  intrinsics: [{fx}, {fy}, {cx}, {cy}]\n"
            f"  resolution: [{w}, {h}]\n",
            "orb.yaml": '%YAML:1.0\n\n#-----\nCamera.type: "KannalaBrandt8"\n'
            + "".join(f"Camera.{n}: {v}\n" for n, v in zip(("fx", "fy", "cx", "cy"), self.k))
            + "".join(f"Camera.k{i + 1}: {v}\n" for i, v in enumerate(d))
            + f"Camera.width: {w}\nCamera.height: {h}\nDepthMapFactor: 1000.0\n",
        }
        bag = self.fisheye_bag(model="equidistant", d=(0.0,) * 4)
        self.assertIn("fisheye,0,0,0,0", self.warnings(bag))
        for name, text in files.items():
            with self.subTest(name):
                foreign.put(self.folder / name, text)
                self.assert_near(bag, "--camera", self.folder / name)
        # Beside the images it needs no option.
        color, depth = self.bent()
        folder = self.folder / "tum"
        foreign.write_tum(self.replaced(color=color, depth=depth), folder)
        (folder / "camera.txt").unlink()
        foreign.put(folder / "camera.yaml", files["ros.yaml"])
        self.assertIn("--depth-scale", self.refused(folder))
        self.assert_near(folder, "--depth-scale", "1000")
        foreign.put(folder / "camera.yaml", files["orb.yaml"])
        self.assert_near(folder)
        self.assertIn("camera.yaml", self.info(folder)["unit_source"])
        (folder / "camera.yaml").unlink()
        lens = " ".join(map(str, FISHEYE))
        foreign.put(folder / "camera.txt", f"{fx} {fy} {cx} {cy} {w} {h} 1000 fisheye {lens}\n")
        self.assert_near(folder)

    def test_files_that_are_no_cameras(self):
        bag = self.bag(self.plain())
        for name, text, word in (
            ("two.yaml", "cam0: {}\ncam1: {}\n", "several cameras"),
            ("none.yaml", "a: b\n", "no focal lengths"),
            (
                "odd.yaml",
                "camera_matrix: {data: [1, 0, 1, 0, 1, 1, 0, 0, 1]}\n"
                "distortion_model: ftheta\ndistortion_coefficients: {data: [1, 2]}\n",
                "ftheta",
            ),
            ("torn.yaml", "camera_matrix: [", "torn.yaml"),
        ):
            foreign.put(self.folder / name, text)
            said = self.refused(bag, "--camera", self.folder / name)
            self.assertIn(word, said)
            self.assertIn("--camera fx,fy,cx,cy", said)
        self.assertIn("no file", self.refused(bag, "--camera", "nowhere.yaml"))
        size = "camera_matrix: {data: [500, 0, 300, 0, 500, 200, 0, 0, 1]}\n"
        foreign.put(self.folder / "large.yaml", f"image_width: 640\nimage_height: 400\n{size}")
        self.assertIn("640x400", self.refused(bag, "--camera", self.folder / "large.yaml"))

    def replaced(self, **other):
        import dataclasses

        return dataclasses.replace(self.r, **other)


class Pictures(Found):
    def coded(self, code, encoding, height=None):
        messages = []
        for i, ns in enumerate(self.stamps):
            data = ros2.image(code(self.r.color[i]), encoding, ns, FRAME, height=height)
            messages += [self.color_info(i), (COLOR + "/image_raw", ros2.IMAGE, ns, data)]
            messages.append(self.pair(i)[1])
        return self.bag(messages, f"{encoding}.db3")

    def test_colours_in_other_codings(self):
        def bayer(c):
            out = c[..., 1].copy()
            out[::2, ::2] = c[::2, ::2, 0]
            out[1::2, 1::2] = c[1::2, 1::2, 2]
            return out

        def nv12(c):
            r, g, b = (c[..., k].astype(float) for k in range(3))
            y = 16 + 0.257 * r + 0.504 * g + 0.098 * b
            u = 128 - 0.148 * r - 0.291 * g + 0.439 * b
            v = 128 + 0.439 * r - 0.368 * g - 0.071 * b
            behind = np.stack([u[::2, ::2], v[::2, ::2]], -1).reshape(c.shape[0] // 2, -1)
            return np.rint(np.vstack([y, behind])).astype(np.uint8)

        self.assert_same(self.coded(lambda c: c.astype(np.uint16) * 257, "rgb16"))
        self.assert_same(self.coded(lambda c: c[..., ::-1].astype(np.uint16) * 257, "bgr16"))
        self.assert_same(self.coded(bayer, "bayer_rggb8"), within=2e-3)
        self.assert_same(self.coded(nv12, "nv12", height=self.size[1]), within=1e-3)
        self.assertIn("rgb8", self.refused(self.coded(lambda c: c[..., 0], "jpeg2000")))

    def turned(self, folder, orientation, transpose):
        shutil.copytree(self.shared / "tum", folder)
        foreign.put(folder / "rgb.txt", (folder / "rgb.txt").read_text().replace(".png", ".jpg"))
        for file in list((folder / "rgb").iterdir()):
            picture, data = Image.open(file).transpose(transpose), io.BytesIO()
            exif = Image.Exif()
            exif[0x0112] = orientation
            picture.save(data, "jpeg", quality=97, exif=exif)
            foreign.put(file.with_suffix(".jpg"), data.getvalue())
            file.unlink()
        return folder

    def test_pictures_that_viewers_turn(self):
        folder = self.turned(self.folder / "head", 3, Image.ROTATE_180)
        self.assertIn("Exif orientation 3", self.warnings(folder))
        text = self.refused(self.turned(self.folder / "side", 6, Image.ROTATE_90))
        self.assertIn("mogrify -auto-orient", text)
        if shutil.which("mogrify"):
            files = map(str, (self.folder / "side/rgb").iterdir())
            subprocess.run(["mogrify", "-auto-orient", *files], check=True)
            self.assert_same(self.folder / "side", within=2e-3)

    def test_a_picture_of_one_pixel_is_a_bad_frame(self):
        messages = []
        for i in range(FRAMES):
            small = self.r.color[i][:1, :1] if i == 5 else None
            messages += [self.color_info(i), *self.pair(i, color=small)]
        path, log = self.track(self.bag(messages))
        self.assertEqual(len(path), FRAMES - 1, log)


class Clocks(Found):
    def moved(self, by_ns, name="m.db3"):
        messages = []
        for i in range(FRAMES):
            messages += [self.color_info(i), *self.pair(i, by_ns(i, self.stamps[i]))]
        return self.bag(messages, name)

    def test_a_clock_set_back_by_less_than_a_second(self):
        path = self.moved(lambda i, ns: ns - (4 * 10**8 if i >= FRAMES // 2 else 0))
        _, log = self.assert_same(path, within=0.005)
        self.assertRegex(log, r"set back by 0\.4")
        self.assertNotIn("single views", log)

    def test_stamps_of_another_age_cost_their_images(self):
        for name, odd in (("first", (0,)), ("three", (0, 1, 2)), ("last", (FRAMES - 1,))):
            with self.subTest(name):
                other = (
                    lambda i, ns: (ns + 3 * 10**17 if name == "last" else i) if i in odd else ns
                )
                path, log = self.track(self.moved(other, f"{name}.db3"))
                self.assertEqual(len(path), FRAMES - len(odd), log)
                self.assertLess(path[-1, 0] - path[0, 0], 1)
                self.assertIn("nothing to do with", log)

    def test_neither_clock_tells_images_apart(self):
        messages = [self.color_info(i) for i in range(FRAMES)]
        for i in range(FRAMES):
            messages += self.pair(i, 0, received=0)
        text = self.refused(self.bag(messages))
        self.assertIn("times of recording", text)
        self.assertIn("sequence.match", text)

    def lists(self, name, time_of):
        folder = self.folder / name
        shutil.copytree(self.shared / "tum", folder)
        for file in ("rgb.txt", "depth.txt"):
            rows = [l.split() for l in (folder / file).read_text().splitlines() if l[0] != "#"]
            text = "".join(
                f"{time_of(i, self.r.times[i])} {row[1]}\n" for i, row in enumerate(rows)
            )
            (folder / file).write_text(text)
        return folder

    def test_lists_of_device_clocks_and_of_counts(self):
        for word, time_of in (
            (
                "nanoseconds",
                lambda i, t: round(t * 1e9) + 123_456_789_012,
            ),  # since it was plugged in
            ("frame numbers", lambda i, t: f"{i}.0"),
        ):
            folder = self.lists(word.replace(" ", "_"), time_of)
            self.assertIn(word, self.warnings(folder))
            path, _ = self.assert_same(folder, within=1e-3)
            self.assertAlmostEqual(path[-1, 0] - path[0, 0], (FRAMES - 1) / 30, delta=0.002)

    def test_a_list_whose_clock_was_set_back_before_its_beginning(self):
        back = lambda i, t: f"{t + 1e9 - (10 if i >= FRAMES // 2 else 0):.6f}"
        folder = self.lists("back", back)
        self.assertIn("set back by", self.warnings(folder))
        self.assert_same(folder, within=0.005)
        # Parts that follow each other in time are put in their order.
        half = FRAMES // 2
        turned = self.folder / "turned"
        shutil.copytree(self.shared / "tum", turned)
        for file in ("rgb.txt", "depth.txt"):
            rows = [l for l in (turned / file).read_text().splitlines() if l[0] != "#"]
            (turned / file).write_text("\n".join(rows[half:] + rows[:half]) + "\n")
        self.assertIn("sorted", self.warnings(turned))
        self.assert_same(turned)

    def test_times_of_a_transforms_file_in_another_unit(self):
        for word, time_of in (
            ("milliseconds", lambda i, t: t * 1000 + 1.7e12),
            ("nanoseconds", lambda i, t: round(t * 1e9) + 17 * 10**17),
            ("frame numbers", lambda i, t: i),
        ):
            folder = self.folder / word.replace(" ", "_")
            foreign.write_transforms(self.r, folder)
            file = folder / "transforms.json"
            data = json.loads(file.read_text())
            for frame in data["frames"]:
                t = frame["timestamp"]
                frame["timestamp"] = time_of(round(t * 30), t)
            file.write_text(json.dumps(data))
            info = self.info(folder)
            self.assertIn(word, " ".join(info["warnings"]))
            self.assertFalse(info["sparse"])
            path, _ = self.track(folder)
            self.assertAlmostEqual(path[-1, 0] - path[0, 0], (FRAMES - 1) / 30, delta=0.002)


class Lists(Found):
    def test_texts_of_other_systems(self):
        for name, code in (
            ("returns", lambda t: t.replace("\n", "\r").encode()),
            ("no mark", lambda t: t.encode("utf-16-le")),
            ("no mark, turned", lambda t: t.encode("utf-16-be")),
            ("mark, turned", lambda t: b"\xfe\xff" + t.encode("utf-16-be")),
            ("mark of UTF-8", lambda t: b"\xef\xbb\xbf" + t.replace("\n", "\r\n").encode()),
        ):
            with self.subTest(name):
                folder = self.copy(name)
                for file in ("rgb.txt", "depth.txt", "camera.txt", "groundtruth.txt"):
                    text = (folder / file).read_text()
                    (folder / file).write_bytes(code(text))
                self.assertGreater(self.info(folder)["truth_rows"], 0)
                self.assert_same(folder)

    def test_names_as_another_machine_had_them(self):
        for name, change in (
            ("absolute", lambda f: "/home/someone/data/walk/" + f),
            ("windows", lambda f: "D:\\data\\walk\\" + f.replace("/", "\\")),
            ("alone", lambda f: f.split("/")[1]),
        ):
            with self.subTest(name):
                folder = self.copy(name)
                for file in ("rgb.txt", "depth.txt"):
                    rows = self.rows(folder, file)
                    (folder / file).write_text("".join(f"{t} {change(f)}\n" for t, f in rows))
                self.assertIn("not there as it is written", self.warnings(folder))
                self.assert_same(folder)

    def test_pictures_that_were_converted_after_the_list(self):
        folder = self.copy("converted")
        for file in list((folder / "rgb").iterdir()):
            foreign.put(file.with_suffix(".jpg"), foreign.jpeg(np.asarray(Image.open(file))))
            file.unlink()
        self.assert_same(folder, within=2e-3)

    def test_lists_of_pairs_under_other_names(self):
        for name in ("associate.txt", "association.txt", "assoc.txt"):
            folder = self.copy(name)
            pairs = zip(self.rows(folder, "rgb.txt"), self.rows(folder, "depth.txt"))
            text = "".join(f"{a} {b} {c} {d}\n" for (a, b), (c, d) in pairs)
            for file in ("rgb.txt", "depth.txt"):
                (folder / file).unlink()
            (folder / name).write_text(text)
            self.assertIn(name, self.info(folder)["times_source"])
            self.assert_same(folder)


class Files(Found):
    def parts(self, folder, names):
        messages = self.plain()
        half = 3 * (FRAMES // 2)
        for name, part in zip(names, (messages[:half], messages[half:])):
            ros2.write_db3(folder / name, part)

    def metadata(self, folder, names):
        head = "rosbag2_bagfile_information:\n  version: 5\n  relative_file_paths:\n"
        foreign.put(folder / "metadata.yaml", head + "".join(f"    - {n}\n" for n in names))

    def test_all_that_a_shell_names(self):
        folder = self.folder / "walk"
        names = ("walk_0.db3", "walk_1.db3")
        self.parts(folder, names)
        self.metadata(folder, names)
        foreign.put(folder / "walk_1.db3-wal", b"")
        foreign.put(folder / "walk_1.db3-shm", bytes(100))
        self.assert_same(*sorted(folder.iterdir()))
        self.assert_same(folder / "metadata.yaml")
        # The recorder did not come to write the last file down.
        self.metadata(folder, names[:1])
        self.assertIn("does not name walk_1.db3", self.warnings(folder))
        self.assert_same(folder)

    def test_two_folders_and_a_bag_for_each_topic(self):
        for k, name in enumerate(("a", "b")):
            self.parts(self.folder / "x", ("0.db3", "1.db3"))
            (self.folder / name).mkdir()
            (self.folder / f"x/{k}.db3").rename(self.folder / name / "part.db3")
        self.assert_same(self.folder / "a", self.folder / "b")
        for prefix in (COLOR, DEPTH):
            one = [m for m in self.plain() if m[0].startswith(prefix)]
            ros2.write_db3(self.folder / f"topics{prefix.replace('/', '_')}.db3", one)
        self.assert_same(*sorted(self.folder.glob("topics*.db3")))

    def test_convert_and_send_take_what_run_takes(self):
        folder = self.folder / "walk"
        self.parts(folder, ("0.db3", "1.db3"))
        files = sorted(folder.iterdir())
        out = self.folder / "converted"
        self.sgs("convert", *files, out, "--stamps", "received", "--quiet")
        self.assertEqual(self.info(out)["frames"], FRAMES)
        self.assert_same(out, within=1e-4)
        again = self.folder / "again"
        self.sgs("convert", "--quiet", folder, again)
        self.assertEqual(self.info(again)["frames"], FRAMES)
        self.assertIn("OUT", self.sgs("convert", "--help").stdout)
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        live = f"live:tcp://127.0.0.1:{port}"
        run = [str(SGS), "run", live, "-o", str(self.folder / "live"), *TRACK_ONLY]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE, "cwd": self.folder}
        with subprocess.Popen(run, **quiet) as receiver:
            self.sgs("send", *files, live, "--quiet")
            _, said = receiver.communicate(timeout=200)
            self.assertEqual(receiver.returncode, 0, said)
        rows = (self.folder / "live/trajectory.txt").read_text().splitlines()
        self.assertEqual(sum(not row.startswith("#") for row in rows), FRAMES)

    def test_an_accelerometer_in_the_second_file(self):
        messages = self.plain()
        half = 3 * (FRAMES // 2)
        felt = []
        for ns, pose in zip(self.stamps, self.r.poses):
            up = np.asarray(pose)[:3, :3].T @ (0, 0, 9.81)
            felt += [("/imu", ros2.IMU, ns, ros2.imu(ns, FRAME, up)) for _ in range(3)]
        ros2.write_db3(self.folder / "0.db3", messages[:half])
        ros2.write_db3(self.folder / "1.db3", messages[half:] + felt[len(felt) // 2 :])
        _, log = self.track(self.folder / "0.db3", self.folder / "1.db3")
        self.assertRegex(log, "(?i)accelerometer|imu")

    def test_a_database_that_was_cut_off(self):
        whole = self.bag(self.plain())
        cut = self.folder / "cut.db3"
        cut.write_bytes(whole.read_bytes()[: whole.stat().st_size * 2 // 3])
        path, log = self.track(cut)
        self.assertGreater(len(path), FRAMES // 2)
        self.assertIn("malformed", log)

    def test_files_that_are_not_what_they_are_called(self):
        whole = self.bag(self.plain())
        named = self.folder / "named.bag"
        shutil.copy(whole, named)
        self.assert_same(named)
        for name, content, words in (
            ("empty.db3", b"", ("0 bytes",)),
            ("page.bag", b"<!DOCTYPE html><html>sign in</html>", ("web page", "download")),
            ("pointer.mcap", b"version https://git-lfs.github.com/spec/v1\n", ("git lfs pull",)),
        ):
            foreign.put(self.folder / name, content)
            text = self.refused(self.folder / name)
            for word in words:
                self.assertIn(word, text)
        packed = self.folder / "packed.db3"
        with packed.open("wb") as out:
            subprocess.run(["gzip", "-c", whole], stdout=out, check=True)
        command = re.search(r"`([^`]+)`", self.refused(packed)).group(1)
        subprocess.run(["bash", "-ec", command], check=True, cwd=self.folder)
        self.assert_same(self.follow(self.refused(f"{packed}.gz")))
        folder = self.folder / "pointers"
        shutil.copytree(self.shared / "tum", folder)
        for file in (folder / "rgb").iterdir():
            file.write_text("version https://git-lfs.github.com/spec/v1\noid sha256:0\n")
        self.assertIn("git lfs pull", self.refused(folder))

    def test_two_folders_deeper_beside_other_files(self):
        folder = self.folder / "download"
        shutil.copytree(self.shared / "tum", folder / "data/walk")
        foreign.put(folder / "README.txt", "read me")
        foreign.put(folder / "scripts/run.sh", "true")
        self.assert_same(folder)

    def test_folders_that_an_sgs_toml_has_to_describe(self):
        camera = ("--camera", ",".join(map(str, self.k)), "--depth-scale", "1000")
        for name, color, depth in (
            ("folders", "left/{:04d}.png", "dense_depth/{:04d}.png"),
            ("one", "{:04d}-color.png", "{:04d}-depth.png"),
        ):
            with self.subTest(name):
                folder = self.folder / name
                for i in range(FRAMES):
                    foreign.put(folder / color.format(i), foreign.png(self.r.color[i]))
                    foreign.put(folder / depth.format(i), foreign.png(self.r.depth[i]))
                text = self.refused(folder, *camera)
                advice = re.search(r"\[sequence\] (color = .*?, fps = 30)", text).group(1)
                foreign.put(folder / "sgs.toml", "[sequence]\n" + advice.replace(", ", "\n") + "\n")
                self.assert_same(folder, *camera, within=1e-3)

    def test_what_other_cameras_programs_record(self):
        for name in ("walk.mp4", "walk.svo", "walk.oni"):
            foreign.put(self.folder / name, b"\0\0\0\x18ftyp")
            self.assertRegex(self.refused(self.folder / name), "depth images|give the folder")
        folder = self.folder / "arrays"
        for i in range(3):
            foreign.put(folder / f"rgb/{i}.png", foreign.png(self.r.color[i]))
            data = io.BytesIO()
            np.save(data, self.r.depth[i])
            foreign.put(folder / f"depth/{i}.npy", data.getvalue())
        self.assertIn("depth holds .npy files", self.refused(folder))

    def test_a_transform_that_is_none_is_named_where_it_is_needed(self):
        nan = float("nan")
        start = self.stamps[0]
        edges = (("l", FRAME, (0, 0, 0), (nan,) * 4), ("l", DEPTH_FRAME, (0, 0, 0), (0, 0, 0, 1)))
        own = ros2.camera_info(self.k, self.size, start, DEPTH_FRAME)
        messages = [
            ("/tf_static", ros2.TF, start, ros2.transforms(start, *edges)),
            ("/camera/depth/camera_info", ros2.INFO, start, own),
        ]
        for i in range(FRAMES):
            messages += [self.color_info(i), *self.pair(i, dframe=DEPTH_FRAME)]
        path = self.bag([(t.replace(DEPTH, "/camera/depth"), k, n, d) for t, k, n, d in messages])
        text = self.refused(path)
        self.assertIn(FRAME, text)
        self.assertIn("NaN", text)
        self.assert_same(path, "--extrinsics", "aligned")


class First(Found):
    def test_info_says_who_says_what(self):
        foreign.write_sens(self.r, self.folder / "a.sens")
        bag = self.bag(self.plain())
        for what, words in (
            (
                bag,
                ("camera_info", "camera_info", "millimetres", "its name", "stamps of the images"),
            ),
            (self.shared / "tum", ("camera.txt", "camera.txt", "camera.txt", "layout", "rgb.txt")),
            (self.folder / "a.sens", ("a.sens", "a.sens", "a.sens", "registered", "in the file")),
        ):
            lines = self.sgs("info", what).stdout.splitlines()
            for start, word in zip(
                ("camera", "distortion", "depth scale", "extrinsics", "times"), words
            ):
                self.assertIn(word, [line for line in lines if line.startswith(start + " ")][0])

    def test_a_first_message_that_cannot_be_read(self):
        messages = self.plain()
        messages[1] = (*messages[1][:3], b"")
        path, _ = self.track(self.bag(messages))
        self.assertEqual(len(path), FRAMES - 1)


if __name__ == "__main__":
    unittest.main()
