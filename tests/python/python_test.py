# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""The Python package: the bits of the executable, numpy's types and lifetimes, threads, Ctrl-C, stubs.

Usage: python_test.py SGS_EXECUTABLE PACKAGE_FOLDER [unittest arguments]
"""
import gc
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import unittest

SGS, PACKAGE = sys.argv.pop(1), sys.argv.pop(1)
sys.path.insert(0, PACKAGE)
import numpy as np  # noqa: E402
import sgs  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
FRAMES = 10


def executable(*arguments):
    command = [SGS, *(str(a) for a in arguments)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    if done.returncode != 0:
        raise AssertionError(f"{command}: exit {done.returncode}\n{done.stderr}")
    return done.stdout


def quick_config():
    config = sgs.Config.preset("default")
    config["mapper.iterations_per_frame"] = 1
    return config


class WithSequence(unittest.TestCase):
    """A short rendered sequence on disk and its frames, made once."""

    @classmethod
    def setUpClass(cls):
        if hasattr(WithSequence, "frames"):
            return
        WithSequence.keeper = tempfile.TemporaryDirectory(prefix="sgs-python-")
        WithSequence.folder = pathlib.Path(cls.keeper.name)
        WithSequence.room = cls.folder / "room"
        executable("synth", "room_desk", cls.room, "--frames", FRAMES, "--quiet")
        recording = sgs.open(cls.room)
        WithSequence.camera = recording.camera
        WithSequence.truth = recording.ground_truth
        WithSequence.frames = list(recording)

    def session(self, **options):
        return sgs.Session(self.camera, quick_config(), **options)


class Sessions(WithSequence):
    def test_numpy_frames_give_the_bits_of_the_executable(self):
        with self.session() as session:
            for f in self.frames:
                result = session.feed(f.color.copy(), f.depth.copy(), f.time)
                self.assertEqual(result.T_world_camera.shape, (4, 4))
        session.save(self.folder / "fed")
        executable(
            *("run", self.room, "-o", self.folder / "run", "--quiet", "--no-eval"),
            *("--set", "mapper.iterations_per_frame=1"),
        )
        for name in ("trajectory.txt", "trajectory_online.txt", "keyframes.txt", "map.ply"):
            fed, run = (self.folder / "fed" / name), (self.folder / "run" / name)
            self.assertEqual(fed.read_bytes(), run.read_bytes(), name)

    def test_raw_depth_and_other_orders_of_colour_mean_the_same(self):
        f = self.frames[0]
        raw = np.round(f.depth * 5000).astype(np.uint16)
        metres = (raw / 5000.0).astype(np.float32)
        bgra = np.zeros((*raw.shape, 4), np.uint8)
        bgra[..., :3] = f.color[..., ::-1]
        results = []
        for color, depth, options in (
            (f.color, metres, {}),
            (bgra, raw, {"depth_scale": 5000, "color_order": "bgr"}),
            # Rows that lie apart, upside down in memory.
            (np.flipud(np.flipud(f.color).copy()), np.pad(metres, ((0, 0), (0, 8)))[:, :-8], {}),
        ):
            with self.session() as session:
                session.feed(color, depth, 0, **options)
            results.append(session.snapshot().positions)
        for other in results[1:]:
            np.testing.assert_array_equal(results[0], other)

    def test_a_result_tells_the_weak_directions_with_their_weights(self):
        with sgs.Session(sgs.open("synth:flat", frames="0:1").camera, quick_config()) as session:
            for f in sgs.open("synth:nostructure_texture_near", frames="0:4"):
                result = session.feed(f)
        self.assertEqual(result.spectrum.axes.shape, (6, 6))
        heavy = result.spectrum.weights > 0.5
        weak = result.weak_directions()
        self.assertEqual(len(weak), heavy.sum())
        self.assertGreater(len(weak), 0, "a plain wall hides three directions")
        self.assertEqual(result.status, "degenerate")
        for direction in weak:
            self.assertAlmostEqual(np.linalg.norm(direction.twist), 1, places=2)
            self.assertGreater(direction.weight, 0.5)

    def test_views_of_the_map_are_read_only_and_outlive_the_session(self):
        session = self.session()
        self.assertIsNone(session.snapshot())
        for f in self.frames[:3]:
            session.feed(f)
        session.finish()
        snapshot = session.snapshot()
        positions, colors = snapshot.positions, snapshot.colors
        kept = positions.copy()
        count = len(snapshot)
        del session, snapshot
        gc.collect()
        trash = [np.full((count, 16), 7, np.float32) for _ in range(20)]
        np.testing.assert_array_equal(positions, kept)
        self.assertEqual(colors.shape, (count, 3))
        self.assertEqual(positions.strides, (64, 4))
        del trash
        for view in (positions, self.frames[0].color, self.frames[0].depth):
            with self.assertRaises(ValueError):
                view[0] = 0
            with self.assertRaises(ValueError):
                view.setflags(write=True)

    def test_a_map_is_rendered_from_where_the_camera_was(self):
        with self.session() as session:
            for f in self.frames:
                result = session.feed(f)
        snapshot = session.snapshot()
        color, depth, alpha = snapshot.render(self.camera, result.T_world_camera)
        seen = self.frames[-1].depth
        both = (depth > 0) & (seen > 0)
        self.assertGreater(both.mean(), 0.5)
        self.assertLess(np.median(np.abs(depth - seen)[both]), 0.05)
        self.assertLess(np.abs(color - self.frames[-1].color / 255.0).mean(), 0.15)
        self.assertLessEqual(float(alpha.max()), 1.0)
        self.assertEqual(snapshot.scales.shape, (len(snapshot), 3))
        self.assertTrue(((snapshot.opacities > 0) & (snapshot.opacities < 1)).all())

    def test_a_saved_session_is_a_run_that_can_be_scored(self):
        recording = sgs.open(self.room)
        with self.session() as session:
            for f in recording:
                session.feed(f)
        session.save(self.folder / "scored", recording=recording)
        scores = sgs.evaluate_run(self.folder / "scored")
        self.assertGreater(scores["psnr_db"], 10)
        estimate = session.trajectory()
        self.assertEqual(estimate.poses.shape, (FRAMES, 4, 4))
        direct = sgs.evaluate(self.room / "groundtruth.txt", estimate)
        self.assertAlmostEqual(direct["ate_rmse_m"], scores["ate_rmse_m"], places=6)


class BadInput(WithSequence):
    def refused(self, error, pattern, call, *arguments, **options):
        with self.assertRaisesRegex(error, pattern):
            call(*arguments, **options)

    def test_arrays_of_wrong_type_shape_or_order(self):
        f, session = self.frames[0], self.session()
        color, depth = np.array(f.color), np.array(f.depth)
        feed = session.feed
        self.refused(TypeError, "uint8, not an array of float32", feed, depth, depth, 0)
        self.refused(TypeError, "uint16 or float32", feed, color, depth.astype(float), 0)
        self.refused(TypeError, "uint16 or float32", feed, color, depth.astype(">f4"), 0)
        self.refused(TypeError, "not a list", feed, color.tolist(), depth, 0)
        raw = (depth * 1000).astype(np.uint16)
        self.refused(ValueError, "depth_scale", feed, color, raw, 0)
        self.refused(ValueError, "positive|cannot be", feed, color, raw, 0, depth_scale=-1)
        self.refused(ValueError, "height, width, 3", feed, color[..., 0], depth, 0)
        self.refused(ValueError, "ascontiguousarray", feed, np.asfortranarray(color), depth, 0)
        self.refused(ValueError, "ascontiguousarray", feed, color[:, ::-1], depth, 0)
        self.refused(ValueError, "ascontiguousarray", feed, color, depth.T.copy().T, 0)
        nothing = np.broadcast_to(color[:1], color.shape)
        self.refused(ValueError, "ascontiguousarray", feed, nothing, depth, 0)
        self.refused(ValueError, "pixels, the camera", feed, color[:100], depth, 0)
        self.refused(ValueError, "rgb", feed, color, depth, 0, color_order="gbr")
        self.refused(ValueError, "not later", feed, color, depth, float("nan"))
        self.refused(sgs.Error, "median depth", feed, color, raw, 0, depth_scale=1)
        self.assertEqual(session.frames(), [])
        feed(color, depth, 0)
        self.refused(ValueError, "not later", feed, color, depth, 0)
        session.finish()
        self.refused(ValueError, "finished", feed, color, depth, 1)

    def test_depth_that_is_no_number_is_no_measurement(self):
        f = self.frames[0]
        holes, depth = np.array(f.depth), np.array(f.depth)
        holes[:50], holes[50:60], holes[60:70] = np.nan, np.inf, -1
        depth[:70] = 0
        maps = []
        for image in (holes, depth):
            with self.session() as session:
                session.feed(f.color, image, 0)
            maps.append(session.snapshot().positions)
        np.testing.assert_array_equal(*maps)

    def test_errors_name_the_remedy_and_are_pythons_own_kinds(self):
        config = sgs.Config()
        with self.assertRaisesRegex(KeyError, "mapper.iterations_per_frame") as caught:
            config["mapper.iterations_per_fram"] = 1
        self.assertEqual(caught.exception.code, "unknown key")
        self.assertIsInstance(caught.exception, sgs.Error)
        self.refused(ValueError, "snapshot_lag", config.__setitem__, "slam.snapshot_lag", 0)
        self.refused(KeyError, "nonsense", config.__getitem__, "nonsense")
        self.refused(FileNotFoundError, "no/such", sgs.open, "/no/such/recording")
        self.refused(KeyError, "frames", sgs.open, self.room, frame="0:1")
        self.refused(TypeError, "PathLike", sgs.open, 7)
        self.refused(ValueError, "4x4", sgs.Map.load(str(self.splats())).render, self.camera, 1)
        self.refused(ValueError, "fx", sgs.Session, sgs.Camera(64, 48, 0, 50, 32, 24))
        bent = sgs.Camera(64, 48, 50, 50, 32, 24, [0.1, 0, 0, 0], lens="fisheye")
        self.assertEqual((bent.lens, self.camera.lens), ("fisheye", "brown"))
        self.assertIn("lens='fisheye'", repr(bent))
        sgs.Session(bent)
        five = sgs.Camera(64, 48, 50, 50, 32, 24, [0.1, 0, 0, 0, 0], lens="fisheye")
        self.refused(ValueError, "k1 k2 k3 k4", sgs.Session, five)
        with self.assertRaisesRegex(ValueError, "'brown' or 'fisheye'"):
            sgs.Camera(64, 48, 50, 50, 32, 24, lens="telephoto")
        self.refused(ValueError, "nearest", sgs.evaluate, self.truth, self.truth, "near")

    def test_maps_are_saved_by_name(self):
        with self.session() as session:
            session.feed(self.frames[0])
        for name, begin in (("a.spz", b"NGSP"), ("a.glb", b"glTF"), ("a.ply", b"ply")):
            session.snapshot().save(str(self.folder / name))
            self.assertTrue((self.folder / name).read_bytes().startswith(begin), name)

    def splats(self):
        path = self.folder / "one.ply"
        with self.session() as session:
            session.feed(self.frames[0])
        session.snapshot().save(str(path))
        return path


class Threads(WithSequence):
    def test_a_second_feeder_is_refused_or_comes_after_the_first(self):
        session, errors, fed = self.session(), [], []

        def feeder():
            for f in self.frames:
                try:
                    fed.append(session.feed(f).index)
                except sgs.Error as error:
                    errors.append(error.code)

        threads = [threading.Thread(target=feeder) for _ in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        session.finish()
        self.assertEqual(sorted(set(fed)), sorted(fed))
        self.assertEqual(len(session.frames()), len(fed))
        self.assertLessEqual(set(errors), {"busy", "invalid argument"})

    def test_python_goes_on_while_a_frame_is_tracked(self):
        ticks, done = [], threading.Event()

        def tick():
            while not done.is_set():
                ticks.append(1)
                done.wait(0.001)

        ticker = threading.Thread(target=tick)
        ticker.start()
        with self.session(threads=1) as session:
            before = len(ticks)
            for f in self.frames:
                session.feed(f)
            self.assertGreater(len(ticks) - before, 2)
        done.set()
        ticker.join()


class Runs(WithSequence):
    def test_run_is_the_executables_run(self):
        told = []
        summary = sgs.run(
            self.room,
            quick_config(),
            output=self.folder / "whole",
            progress=told.append,
            frames="0:6",
        )
        self.assertEqual(told, list(range(1, 7)))
        self.assertEqual(summary.frames, 6)
        self.assertGreater(summary.metrics["psnr_db"], 10)
        self.assertTrue((self.folder / "whole" / "report.html").exists())

    def test_the_preset_quality_refines_here_too(self):
        config = sgs.Config("quality")
        config["mapper.iterations_per_frame"] = 1
        config["refine.least_steps"] = 10
        out = self.folder / "quality"
        steps = []
        for per_frame in (0, config["refine.steps_per_frame"]):
            config["refine.steps_per_frame"] = per_frame
            summary = sgs.run(self.room, config, output=out, frames="0:4", pictures=False)
            steps.append(summary.metrics["mapping_iterations"])
        self.assertGreater(steps[1], steps[0])
        self.assertIn("steps_per_frame = 15", (out / "config.toml").read_text())
        with self.assertRaises(ValueError):
            sgs.run(self.room, config, output=out, frames="0:4", realtime=True)

    def test_what_progress_raises_ends_the_run_and_comes_out(self):
        def stop_soon(frames):
            raise ZeroDivisionError("enough")

        with self.assertRaises(ZeroDivisionError):
            sgs.run("synth:room_desk", quick_config(), output=self.folder / "e", progress=stop_soon)

    def test_ctrl_c_ends_a_run_with_a_folder_that_is_complete(self):
        program = (
            f"import sys; sys.path.insert(0, {PACKAGE!r})\n"
            "import sgs\n"
            "c = sgs.Config(); c['mapper.iterations_per_frame'] = 1\n"
            "try:\n"
            f"    sgs.run('synth:room_desk', c, output={str(self.folder / 'stopped')!r},\n"
            "            progress=lambda n: print(n, flush=True))\n"
            "except KeyboardInterrupt:\n"
            "    print('interrupted', flush=True)\n"
        )
        with subprocess.Popen(
            [sys.executable, "-c", program], stdout=subprocess.PIPE, text=True
        ) as process:
            self.assertEqual(process.stdout.readline(), "1\n")
            process.send_signal(signal.SIGINT)
            rest, _ = process.communicate(timeout=240)
        self.assertEqual(process.returncode, 0)
        self.assertTrue(rest.endswith("interrupted\n"), rest)
        self.assertIn("interrupted", (self.folder / "stopped" / "state.toml").read_text())


class Config(unittest.TestCase):
    def test_it_is_a_mapping_of_all_parameters(self):
        config = sgs.Config("paper")
        self.assertEqual(config["slam.preset"], "paper")
        for key in config:
            if not isinstance(config[key], str) or config[key]:
                config[key] = config[key]
        self.assertIn("tracker.type", config)
        self.assertNotIn("tracker.typ", config)
        self.assertEqual(len(list(config)), len(config))
        config["slam.seed"] = np.int64(7)
        config["loops.enabled"] = np.bool_(False)
        self.assertEqual(config["slam.seed"], 7)
        self.assertIs(config["loops.enabled"], False)
        self.assertIn("gicp", config.info("tracker.type").choices)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "config.toml")
            pathlib.Path(path).write_text(config.to_toml())
            self.assertEqual(sgs.Config.load(path).to_toml(), config.to_toml())


class Stubs(unittest.TestCase):
    def mypy(self, *arguments, package=PACKAGE):
        with tempfile.TemporaryDirectory(prefix="sgs-mypy-") as cache:
            return subprocess.run(
                [sys.executable, "-m", *arguments],
                capture_output=True,
                text=True,
                env={**os.environ, "MYPYPATH": package, "PYTHONPATH": package},
                cwd=cache,
                timeout=300,
            )

    def setUp(self):
        try:
            import mypy  # noqa: F401
        except ImportError:
            self.skipTest("no mypy (Debian package mypy)")

    def stubtest(self, package=PACKAGE):
        with tempfile.NamedTemporaryFile("w", suffix=".txt") as allowed:
            # pybind11's classes have a metaclass and constructors that say nothing of themselves.
            allowed.write("sgs\\.(_sgs\\.)?[A-Z]\\w*(\\.__init__)?\n")
            allowed.flush()
            return self.mypy(
                *("mypy.stubtest", "sgs", "--ignore-positional-only"),
                *("--allowlist", allowed.name, "--ignore-unused-allowlist"),
                package=package,
            )

    def test_they_say_what_the_module_has(self):
        done = self.stubtest()
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_a_stub_that_is_wrong_is_found(self):
        with tempfile.TemporaryDirectory(prefix="sgs-stubs-") as folder:
            copy = pathlib.Path(folder) / "sgs"
            shutil.copytree(pathlib.Path(PACKAGE) / "sgs", copy)
            stub = copy / "_sgs.pyi"
            stub.write_text(stub.read_text().replace("def log_scales", "def log_sizes"))
            done = self.stubtest(package=folder)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("log_sizes", done.stdout)
        self.assertIn("log_scales", done.stdout)

    def test_the_examples_keep_to_them(self):
        examples = sorted(str(p) for p in (ROOT / "examples" / "python").glob("*.py"))
        done = self.mypy("mypy", "--strict", "--ignore-missing-imports", *examples)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_they_find_mistakes(self):
        with tempfile.TemporaryDirectory(prefix="sgs-mypy-") as folder:
            wrong = pathlib.Path(folder) / "wrong.py"
            wrong.write_text(
                "import sgs\n"
                "sgs.Camera(640, 480)\n"
                "sgs.Config()['slam.seed'] = [1]\n"
                "len(sgs.open('x').camera)\n"
            )
            done = self.mypy("mypy", "--strict", str(wrong))
        self.assertIn("Found 3 errors", done.stdout, done.stdout)


if __name__ == "__main__":
    unittest.main()
