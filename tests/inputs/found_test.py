# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings as they are found: what is in them is believed, contradictions are named, one bad
message costs one message, and what a refusal advises is done here and works.

Usage: found_test.py SGS_EXECUTABLE [unittest arguments]
"""
import json
import re
import shutil
import subprocess
import unittest

import numpy as np

import foreign_writers as foreign
import ros2_messages as ros2
from found_case import COLOR, DEPTH, DEPTH_FRAME, FRAME, FRAMES, START_NS, TRACK_ONLY, Found


class Believed(Found):
    def test_the_sdk_s_text_is_calibration_extrinsics_and_unit(self):
        lens = "width={};height={};fx={};ppx={};fy={};ppy={};model=Brown Conrady;coeffs=0,0,0,0,0"
        fx, fy, cx, cy = self.k
        lens = lens.format(*self.size, fx, cx, fy, cy)
        place = "rotation=1,0,0,0,1,0,0,0,1;translation=0,0,0"
        messages = []
        streams = ("/device_0/sensor_0/Depth_0", "/device_0/sensor_1/Color_0")
        for stream in streams:
            messages.append((stream + "/camera_info", ros2.STRING, 1, ros2.string(lens)))
            messages.append((stream + "/tf/ref_0", ros2.STRING, 1, ros2.string(place)))
        for unit in (0.001, 0.00025):
            with self.subTest(unit=unit):
                option = "/device_0/sensor_0/option/Depth_Units/value"
                all_of_it = messages + [(option, ros2.STRING, 1, ros2.string(f"{unit:.6f}"))]
                for i, ns in enumerate(self.stamps):
                    at = ns - START_NS  # the SDK counts from the start of recording
                    depth = np.minimum(self.r.depth[i] * round(0.001 / unit), 65534)
                    far = self.r.depth[i] * round(0.001 / unit) > 65534
                    depth = np.where(far, 0, depth).astype(np.uint16)
                    c = ros2.image(self.r.color[i], "rgb8", at, "Color")
                    d = ros2.image(depth, "mono16", at, "Depth")
                    all_of_it.append((streams[1] + "/image/data", ros2.IMAGE, at, c))
                    all_of_it.append((streams[0] + "/image/data", ros2.IMAGE, at, d))
                path = self.bag(all_of_it, f"sdk{unit}.db3")
                info = self.info(path)
                self.assertEqual(info["depth_scale"], 1 / unit)
                self.assertIn("Depth_Units", info["unit_source"])
                self.assertIn("/tf/ref_0", info["relation_source"])
                self.assertIn("/camera_info", info["calibration_source"])
                self.assert_same(path)

    def test_messages_packed_one_by_one(self):
        if not shutil.which("zstd"):
            self.skipTest("zstd is not installed")
        pack = lambda data: subprocess.run(
            ["zstd", "-1qc"], input=data, stdout=subprocess.PIPE, check=True
        ).stdout
        self.assert_same(self.bag([(t, k, n, pack(d)) for t, k, n, d in self.plain()]))

    def test_p_where_there_is_no_k(self):
        messages = [
            self.color_info(i, k=None, p=self.k) if "info" in m[0] else m
            for i in range(FRAMES)
            for m in (self.color_info(i), *self.pair(i))
        ]
        path = self.bag(messages)
        self.assertIn("P is taken", self.warnings(path))
        self.assert_same(path)

    def test_registered_depth_does_not_need_its_own_info(self):
        empty = [
            (DEPTH + "/camera_info", ros2.INFO, ns, ros2.camera_info(None, self.size, ns, FRAME))
            for ns in self.stamps
        ]
        self.assert_same(self.bag(empty + self.plain()))

    def test_binning_and_region_of_interest(self):
        """The same pictures, said to be every second pixel of a part of larger ones."""
        fx, fy, cx, cy = self.k
        w, h = self.size
        whole = (2 * fx, 2 * fy, 2 * (cx + 0.5) - 0.5 + 100, 2 * (cy + 0.5) - 0.5 + 60)
        other = dict(k=whole, size=(2 * w + 200, 2 * h + 90))
        other.update(binning=(2, 2), roi=(100, 60, 2 * h, 2 * w))
        messages = [m for i in range(FRAMES) for m in (self.color_info(i, **other), *self.pair(i))]
        self.assert_same(self.bag(messages), within=1e-4)

    def test_an_unknown_unit_is_asked_for(self):
        """Orbbec's SDK: Z16 of a setting that it does not write beside the images."""
        messages = [self.color_info(i) for i in range(FRAMES)]
        for i, ns in enumerate(self.stamps):
            c = ros2.image(self.r.color[i], "rgb8", ns, "")
            d = ros2.image(self.r.depth[i], "Z16", ns, "")
            messages.append(("/cam/sensor_2/frameType_2", ros2.IMAGE, ns, c))
            messages.append(("/cam/sensor_3/frameType_3", ros2.IMAGE, ns, d))
        path = self.bag(messages)
        camera = ("--camera", ",".join(map(str, self.k)))
        text = self.refused(path, *camera)
        self.assertIn("--depth-scale", text)
        known = (*camera, "--depth-scale", "1000")
        self.assertIn("--extrinsics aligned", self.refused(path, *known))
        self.assert_same(path, *known, "--extrinsics", "aligned")


class Contradictions(Found):
    def test_two_lenses_of_one_frame(self):
        fx, fy, cx, cy = self.k
        other = ros2.camera_info((1.3 * fx, 1.3 * fy, cx, cy), self.size, START_NS, FRAME)
        messages = [(t.replace(DEPTH, "/camera/depth"), k, n, d) for t, k, n, d in self.plain()]
        path = self.bag([("/camera/depth/camera_info", ros2.INFO, START_NS, other), *messages])
        text = self.refused(path)
        self.assertIn("contradict", text)
        for option in ("--extrinsics 0,0,0,0,0,0,1", "--extrinsics aligned"):
            self.assertIn(option, text)
            self.assertEqual(self.sgs("info", path, *option.split()).returncode, 0)
        self.assert_same(path, "--extrinsics", "aligned")

    def test_equidistant_without_coefficients_is_said(self):
        messages = self.plain()
        messages[0] = self.color_info(0, model="equidistant", d=(0.0,) * 4)
        messages = [
            self.color_info(0, model="equidistant", d=(0.0,) * 4) if "info" in m[0] else m
            for m in messages
        ]
        path = self.bag(messages)
        self.assertIn("fisheye", self.warnings(path))
        self.assert_same(path)

    def test_the_order_of_bytes_is_looked_at(self):
        for flag, order in ((1, "<u2"), (0, ">u2")):
            messages = []
            for i, ns in enumerate(self.stamps):
                messages += [self.color_info(i), self.pair(i)[0]]
                d = ros2.image(self.r.depth[i].astype(order), "16UC1", ns, FRAME, flag)
                messages.append((DEPTH + "/image_raw", ros2.IMAGE, ns, d))
            path = self.bag(messages, f"flag{flag}.db3")
            self.assertIn("is_bigendian", self.warnings(path))
            self.assert_same(path)

    def test_registered_depth_of_half_the_size(self):
        messages = []
        for i in range(FRAMES):
            half = self.r.depth[i][::2, ::2]
            messages += [self.color_info(i), *self.pair(i, depth=half)]
        path, _ = self.track(self.bag(messages))
        self.assertEqual(len(path), FRAMES)
        self.assertLess(np.abs(path[:, 1:4] - self.reference[:, 1:4]).max(), 0.004)

    def test_counters_of_their_own(self):
        for apart in (2, 500):
            folder = self.folder / f"apart{apart}"
            for i in range(FRAMES):
                foreign.put(folder / f"color/{700 + i:06d}.png", foreign.png(self.r.color[i]))
                foreign.put(
                    folder / f"depth/{700 + apart + i:06d}.png", foreign.png(self.r.depth[i])
                )
            matrix = [self.r.fx, 0, 0, 0, self.r.fy, 0, self.r.cx, self.r.cy, 1]
            said = {"width": self.size[0], "height": self.size[1], "intrinsic_matrix": matrix}
            foreign.put(folder / "camera_intrinsic.json", json.dumps(said))
            self.assertIn("counter of its own", self.warnings(folder))
            self.assert_same(folder, within=1e-4)


class OneBadMessage(Found):
    def test_transforms_that_are_none(self):
        nan = float("nan")
        still, turned = (0, 0, 0), (0, 0, 0, 1)
        edges = [("link", f, still, turned) for f in (FRAME, DEPTH_FRAME)]
        edges.append(("link", "accelerometer", (nan, 0, 0), (nan,) * 4))
        edges.append(("odom", "wheel", still, (0, 0, 0, 0)))
        start = self.stamps[0]
        messages = [
            ("/robot0/tf_static", ros2.TF, start, ros2.transforms(start, *edges)),
            ("/tf", ros2.TF, start, b"\0\1\0\0damaged"),
            (
                "/camera/depth/camera_info",
                ros2.INFO,
                start,
                ros2.camera_info(self.k, self.size, start, DEPTH_FRAME),
            ),
        ]
        for i in range(FRAMES):
            messages += [self.color_info(i), *self.pair(i, dframe=DEPTH_FRAME)]
        messages = [(t.replace(DEPTH, "/camera/depth"), k, n, d) for t, k, n, d in messages]
        path = self.bag(messages)
        said = self.warnings(path)
        self.assertIn("accelerometer", said)
        self.assertIn("wheel", said)
        self.assert_same(path)

    def test_a_clock_set_back_goes_on(self):
        messages = []
        for i in range(FRAMES):
            back = 7 * 10**9 if i >= FRAMES // 2 else 0
            messages += [self.color_info(i), *self.pair(i, self.stamps[i] - back)]
        _, log = self.assert_same(self.bag(messages), within=0.005)
        self.assertRegex(log, r"set back by 7\.0")

    def test_modes_that_change(self):
        fx, fy, cx, cy = self.k
        half = (
            (fx / 2, fy / 2, (cx + 0.5) / 2 - 0.5, (cy + 0.5) / 2 - 0.5),
            (self.size[0] // 2, self.size[1] // 2),
        )
        messages = []
        for i in range(FRAMES):
            if i >= FRAMES // 4:
                messages += [self.color_info(i), *self.pair(i)]
                continue
            small = self.r.color[i][::2, ::2], self.r.depth[i][::2, ::2]
            messages += [self.color_info(i, k=half[0], size=half[1])]
            messages += self.pair(i, color=small[0], depth=small[1])
        path = self.bag(messages)
        info = self.info(path)
        self.assertEqual((info["width"], info["fx"]), (self.size[0], fx))
        self.assert_same(path, within=0.01)

    def test_one_stamp_that_is_wrong(self):
        messages = []
        for i in range(FRAMES):
            ahead = 10**12 if i == 9 else 0
            messages += [self.color_info(i), *self.pair(i, self.stamps[i] + ahead)]
        path, _ = self.track(self.bag(messages))
        self.assertEqual(len(path), FRAMES - 1)

    def test_truth_that_cannot_be_read_is_a_warning(self):
        for text, word in (
            ("1 0 0 0.5 0 1 0 0.25 0 0 1 0.125\n", "1 0 0 0.5 0 1 0 0.25 0 0 1 0.125"),
            ("camera goes round the desk\n", "goes round"),
        ):
            folder = self.folder / f"truth{len(text)}"
            shutil.copytree(self.shared / "tum", folder)
            (folder / "groundtruth.txt").write_text(text)
            self.assertIn(word, self.warnings(folder))
            self.assertIn("eight numbers", self.warnings(folder))
            self.assert_same(folder)

    def test_truth_with_a_heading_is_read(self):
        folder = self.folder / "heading"
        shutil.copytree(self.shared / "tum", folder)
        rows = [
            line.split()
            for line in (folder / "groundtruth.txt").read_text().splitlines()
            if not line.startswith("#")
        ]
        order = [0, 1, 2, 3, 7, 4, 5, 6]
        text = "num,t,x,y,z,qw,qx,qy,qz\n" + "".join(
            f"{i}," + ",".join(row[j] for j in order) + "\n" for i, row in enumerate(rows)
        )
        (folder / "groundtruth.txt").write_text(text)
        self.assertEqual(self.info(folder)["truth_rows"], len(rows))


class Times(Found):
    def tum(self, name, time_of):
        folder = self.folder / name
        shutil.copytree(self.shared / "tum", folder)
        for list_name in ("rgb.txt", "depth.txt"):
            rows = [
                line.split()
                for line in (folder / list_name).read_text().splitlines()
                if not line.startswith("#")
            ]
            text = "".join(f"{time_of(i, float(t))} {file}\n" for i, (t, file) in enumerate(rows))
            (folder / list_name).write_text(text)
        return folder

    def test_units_are_recognised_and_told(self):
        for name, time_of in (
            ("frame numbers", lambda i, t: i + 1),
            ("milliseconds", lambda i, t: round((t + 1.7e9) * 1e3)),
            ("nanoseconds", lambda i, t: round(t * 1000) * 10**6 + START_NS),
        ):
            folder = self.tum(name.replace(" ", "_"), time_of)
            info = self.info(folder)
            self.assertIn(name, " ".join(info["warnings"]))
            self.assertFalse(info["sparse"])
            path, _ = self.assert_same(folder, within=1e-3)
            self.assertAlmostEqual(path[-1, 0] - path[0, 0], (FRAMES - 1) / 30, delta=0.002)
            self.assertLess(self.elapsed(folder), 60)

    def elapsed(self, folder):
        import time

        begin = time.monotonic()
        out = self.folder / "live"
        foreign.remove(out)
        self.sgs("run", folder, "-o", out, *TRACK_ONLY, "--realtime")
        return time.monotonic() - begin

    def test_stamps_that_collapse_are_refused_and_the_advice_works(self):
        folder = self.tum("collapsed", lambda i, t: f"{np.float32(t + 1.7e9):.6f}")
        text = self.refused(folder)
        self.assertIn("lost their digits", text)
        advice = re.search(r"\[sequence\] (color = .*?, fps = 30)", text).group(1)
        (folder / "sgs.toml").write_text("[sequence]\n" + advice.replace(", ", "\n") + "\n")
        self.assert_same(folder, within=1e-3)

    def test_stamps_of_a_bag_that_tell_nothing(self):
        messages = []
        for i, ns in enumerate(self.stamps):
            whole = ns // 10**9 * 10**9 + 10**9
            messages += [self.color_info(i), *self.pair(i, whole, received=ns)]
        path = self.bag(messages)
        self.assertIn("times of recording", self.warnings(path))
        self.assert_same(path)

    def test_two_clocks_and_the_advice(self):
        messages = []
        for i, ns in enumerate(self.stamps):
            color, depth = self.pair(i)[0], self.pair(i, ns + 500 * 10**9)[1]
            messages += [self.color_info(i), color, (*depth[:2], ns, depth[3])]
        path = self.bag(messages)
        self.assertIn("--stamps received", self.refused(path))
        self.assert_same(path, "--stamps", "received")

    def test_hardly_any_frame_is_no_finished_run(self):
        """Depth was recorded for two frames only."""
        messages = [self.color_info(i) for i in range(FRAMES)]
        for i in range(FRAMES):
            messages += self.pair(i)[: 2 if i < 2 else 1]
        _, log = self.track(self.bag(messages), code=3)
        done = self.sgs(
            "run", self.bag(messages, "b.db3"), "-o", self.folder / "o", *TRACK_ONLY, code=3
        )
        self.assertIn(f"only 2 of {FRAMES}", done.stderr)


class Refusals(Found):
    """Every refusal that names an option: what it names works."""

    def test_registered_depth_of_another_shape(self):
        crop = [np.ascontiguousarray(d[30:-30]) for d in self.r.depth]
        fx, fy, cx, cy = self.k
        own = ros2.camera_info(
            (fx, fy, cx, cy - 30), (self.size[0], self.size[1] - 60), START_NS, FRAME
        )
        messages = [("/depth/camera_info", ros2.INFO, START_NS, own)]
        for i in range(FRAMES):
            messages += [self.color_info(i), *self.pair(i, depth=crop[i])]
        path = self.bag(messages)
        text = self.refused(path)
        self.assertIn("--topics depth_info=/TOPIC", text)
        path, _ = self.track(path, "--topics", "depth_info=/depth/camera_info")
        self.assertEqual(len(path), FRAMES)
        self.assertLess(np.abs(path[:, 1:4] - self.reference[:, 1:4]).max(), 0.005)

    def test_no_images_at_all(self):
        info = [self.color_info(i) for i in range(3)]
        text = self.refused(self.bag(info))
        self.assertIn("sensor_msgs/CameraInfo", text)
        self.assertIn("record colour and depth", text)

    def test_topics_that_are_not_there(self):
        path = self.bag(self.plain())
        for option, word in (
            ("color=/nothing", COLOR + "/image_raw"),
            ("color_info=/nothing", COLOR + "/camera_info"),
        ):
            text = self.refused(path, "--topics", option)
            self.assertIn("name one of these", text)
            key = option.split("=")[0]
            self.assertIn(word, text)
            self.assert_same(path, "--topics", f"{key}={word}")

    def test_no_camera_info(self):
        path = self.bag([m for m in self.plain() if "info" not in m[0]])
        self.assertIn("--camera fx,fy,cx,cy", self.refused(path))
        self.assert_same(path, "--camera", ",".join(map(str, self.k)))
        # Beside another topic it is named, or is the only one of this frame.
        elsewhere = [(t.replace(COLOR + "/camera_info", "/calib"), *m) for t, *m in self.plain()]
        self.assert_same(self.bag(elsewhere, "only.db3"))


class Folders(Found):
    def split(self, folder, kinds=("walk_0.db3", "walk_1.db3")):
        messages = self.plain()
        half = 3 * (FRAMES // 2)
        for name, part in zip(kinds, (messages[:half], messages[half:])):
            ros2.write_db3(folder / name, part)
        return [folder / name for name in kinds]

    def test_bags_of_one_recording(self):
        folder = self.folder / "walk"
        parts = self.split(folder)
        foreign.put(folder / "._walk_0.db3", b"\0\5\x16\7")
        foreign.put(folder / "Thumbs.db", b"x")
        self.assertIn("walk_0.db3, walk_1.db3", self.warnings(folder))
        self.assert_same(folder)
        self.assert_same(*parts)
        self.assert_same(*reversed(parts))
        self.assert_same(self.folder / "walk")
        again = self.track(self.folder / "walk")[0]
        self.assertEqual(len(again), FRAMES)
        upper = self.folder / "upper"
        self.split(upper, ("WALK_0.DB3", "WALK_1.DB3"))
        self.assert_same(upper)

    def test_what_is_not_one_recording_is_refused(self):
        folder = self.folder / "two"
        for name in ("a.db3", "b.db3"):
            ros2.write_db3(folder / name, self.plain())
        text = self.refused(folder)
        self.assertIn("same time", text)
        one = re.search(r"for example (\S+?)\)?$", text.strip()).group(1)
        self.assert_same(one)
        self.assertIn(
            "one recording at a time", self.refused(folder / "a.db3", self.shared / "tum")
        )

    def test_archives_are_told_to_be_unpacked(self):
        for command in ("zip -qr tum.zip tum", "tar -czf tum.tgz tum"):
            if not shutil.which(command.split()[0]):
                continue
            archive = command.split()[2]
            foreign.remove(self.folder / "tum")
            subprocess.run(command.split(), check=True, cwd=self.shared)
            shutil.move(str(self.shared / archive), self.folder / archive)
            # It holds a folder, which is then found one deeper.
            self.assert_same(self.follow(self.refused(self.folder / archive)))
        if shutil.which("zstd"):
            path = self.bag(self.plain(), "whole walk.db3")
            subprocess.run(["zstd", "-q", "--rm", path, "-o", f"{path}.zstd"], check=True)
            text = self.refused(f"{path}.zstd")
            self.assertIn("zstd -d", text)
            command = re.search(r"`([^`]+)`", text).group(1)
            subprocess.run(["bash", "-ec", command], check=True, capture_output=True)
            self.assert_same(path)

    def test_one_folder_deeper_and_what_systems_leave_behind(self):
        folder = self.folder / "download"
        shutil.copytree(self.shared / "tum", folder / "TUM")
        (folder / "__MACOSX/TUM").mkdir(parents=True)
        for name in ("__MACOSX/TUM/._rgb.txt", ".DS_Store", "TUM/.DS_Store"):
            foreign.put(folder / name, b"\0\5\x16\7")
        self.assert_same(folder)
        shutil.copytree(folder / "TUM", folder / "second")
        text = self.refused(folder)
        one = re.search(r"for example (\S+?)\)?$", text.strip()).group(1)
        self.assert_same(one)

    def test_names_in_capitals(self):
        folder = self.folder / "capitals"
        shutil.copytree(self.shared / "tum", folder)
        for name in ("rgb.txt", "depth.txt", "camera.txt", "groundtruth.txt", "rgb"):
            (folder / name).rename(folder / name.upper())
        self.assertGreater(self.info(folder)["truth_rows"], 0)
        self.assert_same(folder)

    def test_two_bare_folders(self):
        folder = self.folder / "bare"
        for i, t in enumerate(self.r.times):
            foreign.put(folder / f"image/{t + 1000:.6f}.png", foreign.png(self.r.color[i]))
            foreign.put(folder / f"depth/{t + 1000.004:.6f}.png", foreign.png(self.r.depth[i]))
            foreign.put(folder / f"image/._{t + 1000:.6f}.png", b"\0\5\x16\7")
        camera = ("--camera", ",".join(map(str, self.k)))
        self.assertIn("--camera", self.refused(folder))
        self.assertIn("--depth-scale", self.refused(folder, *camera))
        # Depth is stamped four milliseconds later, and so it is taken.
        self.assert_same(folder, *camera, "--depth-scale", "1000", within=0.002)

    def test_lists_from_elsewhere(self):
        source = self.shared / "tum"
        for name in ("comma", "semicolon", "utf16", "blank", "backslash"):
            with self.subTest(name):
                folder = self.folder / name
                shutil.copytree(source, folder)
                rows = {
                    f: [l.split() for l in (folder / f).read_text().splitlines() if l[0] != "#"]
                    for f in ("rgb.txt", "depth.txt")
                }
                separator = ";" if name == "semicolon" else " "
                if name == "utf16":
                    text = "".join(
                        f"{a} {b} {c} {d}\r\n"
                        for (a, b), (c, d) in zip(rows["rgb.txt"], rows["depth.txt"])
                    )
                    for f in rows:
                        (folder / f).unlink()
                    data = b"\xff\xfe" + text.encode("utf-16-le")
                    (folder / "associations.txt").write_bytes(data)
                    self.assert_same(folder)
                    continue
                if name == "blank":
                    (folder / "rgb").rename(folder / "rgb left")
                for f, lines in rows.items():
                    text = ""
                    for t, file in lines:
                        if name in ("comma", "semicolon"):
                            t = t.replace(".", ",")
                        if name == "blank":
                            file = file.replace("rgb/", "rgb left/")
                        if name == "backslash":
                            file = file.replace("/", "\\")
                        text += f"{t}{separator}{file}\n"
                    (folder / f).write_text(text)
                self.assert_same(folder)

    def test_images_of_several_sizes(self):
        folder = self.folder / "sizes"
        shutil.copytree(self.shared / "tum", folder)
        rows = [l.split() for l in (folder / "rgb.txt").read_text().splitlines() if l[0] != "#"]
        depths = [l.split() for l in (folder / "depth.txt").read_text().splitlines() if l[0] != "#"]
        for i in range(3):
            foreign.put(
                folder / rows[i][1], foreign.png(np.ascontiguousarray(self.r.color[i][::2, ::2]))
            )
            foreign.put(
                folder / depths[i][1], foreign.png(np.ascontiguousarray(self.r.depth[i][::2, ::2]))
            )
        self.assert_same(folder, within=0.01)


if __name__ == "__main__":
    unittest.main()
