# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Drives the sgs executable as a user would: contract of the run folder, exit codes, bad input.

Usage: cli_test.py SGS_EXECUTABLE [unittest arguments]
"""
import json
import os
import pathlib
import pty
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import zlib

SGS = pathlib.Path(sys.argv.pop(1)).resolve()
FRAMES = 16
RUN_FILES = (
    "config.toml camera.txt trajectory.txt keyframes.txt groundtruth.txt map.ply metrics.json "
    "frames.csv timings.json report.html log.txt state.toml"
).split()


def write_png(path, width, height, value, bits=16, channels=1):
    """Writes an evenly coloured PNG of exactly this depth (libraries narrow small values)."""
    row = b"\0" + value.to_bytes(bits // 8, "big") * (width * channels)
    header = struct.pack(">IIBBBBB", width, height, bits, 0 if channels == 1 else 2, 0, 0, 0)
    chunks = (b"IHDR", header), (b"IDAT", zlib.compress(row * height)), (b"IEND", b"")
    path.write_bytes(
        b"\x89PNG\r\n\x1a\n"
        + b"".join(
            struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
            for kind, data in chunks
        )
    )


class Case(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.shared_folder = pathlib.Path(tempfile.mkdtemp(prefix="sgs-cli-"))
        cls.master = cls.shared_folder / "master"
        subprocess.run(
            [SGS, "synth", "room_desk", cls.master, "--frames", str(FRAMES), "--quiet"],
            check=True,
            capture_output=True,
        )

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.shared_folder, ignore_errors=True)

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="case-", dir=self.shared_folder))

    def sgs(self, *arguments, code=0, **options):
        done = subprocess.run(
            [str(SGS), *map(str, arguments)],
            capture_output=True,
            text=True,
            cwd=self.folder,
            timeout=240,
            **options,
        )
        self.assertEqual(done.returncode, code, f"{arguments}\n{done.stdout}\n{done.stderr}")
        return done

    def long_sequence(self):
        """90 noisy frames, rendered once for all tests that need so many; not to be changed."""
        folder = self.shared_folder / "long"
        if not folder.exists():
            self.sgs("synth", "room_desk:hard", folder, "--jpeg", "--frames", "90", "--quiet")
        return folder

    def sequence(self, name="sequence"):
        copy = self.folder / name
        shutil.copytree(self.master, copy)
        return copy

    def run_folder(self, *arguments, code=0):
        out = self.folder / "out"
        done = self.sgs("run", *arguments, "-o", out, "--quiet", code=code)
        return out, done

    @staticmethod
    def run_command(out, frames=8):
        """A shell's command line for a short run."""
        options = f"--frames 0:{frames} --no-eval -o '{out}'"
        return f"'{SGS}' run synth:room_desk {options}"

    def lists_so_far(self, sequence, name):
        return self.lists(sequence, name) if (sequence / name).exists() else []

    def lists(self, sequence, name):
        return [
            line
            for line in (sequence / name).read_text().splitlines()
            if line and not line.startswith("#")
        ]


class Contract(Case):
    def test_run_folder_is_complete(self):
        out, done = self.run_folder(self.master)
        for name in RUN_FILES:
            self.assertTrue((out / name).exists(), name)
        self.assertTrue((out / "renders").is_dir())
        self.assertIn(str(out), done.stdout)
        self.assertEqual((self.folder / "runs" / "latest").resolve(), out.resolve())
        metrics = json.loads((out / "metrics.json").read_text())
        table = self.sgs("info", "--metrics").stdout
        self.assertEqual(set(re.findall(r"(?m)^\| `(\w+)`", table)), set(metrics))
        self.assertEqual(metrics["frames"], FRAMES)
        self.assertEqual(metrics["frames_tracked"], FRAMES)
        self.assertLess(metrics["ate_rmse_m"], 0.02)
        self.assertIsNone(metrics["lpips"])
        self.assertEqual(len(self.lists(out, "trajectory.txt")), FRAMES)
        self.assertRegex(self.lists(out, "trajectory.txt")[0], r"^\S+\.\d{9}( -?\d+\.\d{9}){7}$")
        self.assertEqual(len((out / "frames.csv").read_text().splitlines()), FRAMES + 1)
        self.assertNotRegex((out / "report.html").read_text(), r"https?://(?!www\.w3\.org)")

    def test_json_goes_to_stdout_alone(self):
        done = self.sgs("run", self.master, "-o", self.folder / "out", "--quiet", "--json")
        self.assertEqual(json.loads(done.stdout)["frames"], FRAMES)

    def test_eval_recomputes_the_scores(self):
        out, _ = self.run_folder(self.master)
        before = json.loads((out / "metrics.json").read_text())
        (out / "metrics.json").unlink()
        self.sgs("eval", out, "--quiet")
        after = json.loads((out / "metrics.json").read_text())
        for key in ("ate_rmse_m", "psnr_db", "psnr_db_full", "ssim", "depth_l1_m"):
            self.assertAlmostEqual(before[key], after[key], places=6, msg=key)

    def test_config_can_be_run_again(self):
        out, _ = self.run_folder(self.master, "--set", "slam.keyframe_interval=7")
        self.sgs(
            "run",
            "--config",
            out / "config.toml",
            "-o",
            self.folder / "again",
            "--quiet",
            "--no-eval",
        )
        self.assertEqual(
            (out / "trajectory.txt").read_bytes(),
            (self.folder / "again" / "trajectory.txt").read_bytes(),
        )

    def test_same_bits_for_any_number_of_threads(self):
        for name, threads in (("a", 1), ("b", 2), ("c", 2)):
            self.sgs(
                "run",
                self.master,
                "-o",
                self.folder / name,
                "--threads",
                threads,
                "--seed",
                5,
                "--quiet",
                "--no-eval",
            )
        for name in ("b", "c"):
            for file in ("trajectory.txt", "map.ply"):
                self.assertEqual(
                    (self.folder / "a" / file).read_bytes(),
                    (self.folder / name / file).read_bytes(),
                    f"{name}/{file}",
                )

    def test_realtime_run_completes(self):
        out, _ = self.run_folder(self.master, "--realtime", "--no-eval")
        self.assertIsNotNone(json.loads((out / "metrics.json").read_text())["frames_dropped"])

    def test_export_and_render(self):
        out, _ = self.run_folder(self.master, "--no-eval")
        for form in ("ply", "glb", "spz", "points", "tum", "kitti"):
            self.sgs("export", out, form, self.folder / f"x.{form}")
            self.assertGreater((self.folder / f"x.{form}").stat().st_size, 100)
        self.sgs("render", out, "--every", 8, "-o", self.folder / "pictures", "--depth", "--quiet")
        self.assertEqual(len(list((self.folder / "pictures").glob("render_*.png"))), 2)
        self.assertEqual(len(list((self.folder / "pictures").glob("depth_*.png"))), 2)

    def test_videos(self):
        out, _ = self.run_folder(self.sequence())
        video = self.folder / "walk.avi"
        for turn in ([], ["--turntable"]):
            self.sgs(
                "render", out, "--video", video, "--seconds", 0.5, "--fps", 8, "--quiet", *turn
            )
            self.assertEqual(video.read_bytes()[8:11], b"AVI")
            total_frames = struct.unpack_from("<I", video.read_bytes(), 48)[0]  # of AVIMAINHEADER
            self.assertEqual(total_frames, 4)
            video.unlink()
        # Whoever feeds the program is gone after one of three pictures: nothing is left.
        program = pathlib.Path(SGS).parent / "sgs-video"
        words = [program, video, "64", "48", "8", "3"]
        torn = subprocess.run(words, input=bytes(64 * 48 * 3), stdout=subprocess.PIPE)
        self.assertEqual((torn.returncode, torn.stdout), (1, b"the pictures ended early\n\n"))
        self.assertFalse(video.exists())
        refused = self.sgs("render", out, "--video", self.folder / "walk.txt", "--quiet", code=2)
        self.assertIn(".mp4", refused.stderr)
        self.assertFalse(list(self.folder.glob("*unfinished*")))

    def test_the_program_loads_no_video_libraries(self):
        libraries = subprocess.run(["ldd", SGS], capture_output=True, text=True).stdout
        self.assertIn("libopencv_core", libraries)
        self.assertNotIn("libopencv_videoio", libraries)
        self.assertNotIn("libavcodec", libraries)

    def test_a_run_needs_no_recording(self):
        sequence = self.sequence()
        out, _ = self.run_folder(sequence)
        page = (out / "report.html").read_text()
        shutil.rmtree(sequence)
        self.sgs("render", out, "--every", 8, "-o", self.folder / "pictures", "--quiet")
        self.assertEqual(len(list((self.folder / "pictures").glob("render_*.png"))), 2)
        for form in (
            "ply",
            "splat",
            "spz",
            "glb",
            "points",
            "html",
            "mesh",
            "colmap",
            "tum",
            "kitti",
        ):
            target = self.folder / f"x.{form}"
            self.sgs("export", out, form, target)
            self.assertTrue(target.exists(), form)
        cameras = (self.folder / "x.colmap/sparse/0/cameras.txt").read_text()
        self.assertIn("640 480", cameras)
        self.assertTrue(list((self.folder / "x.colmap/images").glob("*.png")))
        (out / "report.html").unlink()
        self.sgs("eval", out, "--report")
        again = (out / "report.html").read_text()
        for section in ("Trajectory", "Degeneracy", "Rendering against truth", "Scores"):
            self.assertEqual(section in again, section in page, section)
        done = self.sgs("eval", out, "--quiet")
        self.assertIn(str(sequence), done.stderr)

    def test_eval_without_the_recording_scores_the_path_and_keeps_the_rest(self):
        sequence = self.sequence()
        out, _ = self.run_folder(sequence)
        before = json.loads((out / "metrics.json").read_text())
        self.assertEqual(before["pictures"], "measured")
        pictures = sorted(p.name for p in (out / "renders").iterdir())
        shutil.rmtree(sequence)
        # Another path than before, so that its score shows that it is made anew.
        truth = out / "groundtruth.txt"
        lines = [line.split() for line in truth.read_text().splitlines() if line[0] != "#"]
        for i, row in enumerate(lines):
            row[1] = str(float(row[1]) + 0.05 * (i % 2))
        truth.write_text("".join(" ".join(row) + "\n" for row in lines))
        done = self.sgs("eval", out, "--quiet", "--json")
        why = [line for line in done.stderr.splitlines() if str(sequence) in line]
        self.assertEqual(len(why), 1, done.stderr)
        self.assertIn("cannot be opened", why[0])
        after = json.loads((out / "metrics.json").read_text())
        self.assertEqual(json.loads(done.stdout), after)
        self.assertGreater(after["ate_rmse_m"], before["ate_rmse_m"])
        self.assertEqual(after["pictures"], "kept")
        for key in ("psnr_db", "psnr_db_full", "ssim", "depth_l1_m"):
            self.assertEqual(before[key], after[key], key)
        self.assertEqual(pictures, sorted(p.name for p in (out / "renders").iterdir()))
        page = (out / "report.html").read_text()
        self.assertIn("Rendering against truth", page)
        self.assertIn("cannot be opened", page)

    def test_view_needs_no_recording(self):
        sequence = self.sequence()
        out, _ = self.run_folder(sequence, "--no-eval")
        shutil.rmtree(sequence)
        view = subprocess.Popen(
            [SGS, "view", out, "--port", "0"], stderr=subprocess.PIPE, text=True, cwd=self.folder
        )
        lines = []
        while not lines or "Ctrl-C" not in lines[-1]:
            line = view.stderr.readline()
            self.assertTrue(line, lines)
            lines.append(line)
        self.assertIn("no camera pictures", "".join(lines))
        view.send_signal(signal.SIGINT)
        view.communicate(timeout=60)
        self.assertEqual(view.returncode, 0)

    def test_damaged_run_folders_are_named(self):
        out, _ = self.run_folder(self.master, "--no-eval")
        (out / "map.ply").write_text("nonsense")
        failed = self.sgs("eval", out, code=1)
        self.assertIn("map.ply", failed.stderr)
        self.assertIn("sgs export RUN tum", failed.stderr)
        self.sgs("export", out, "tum", self.folder / "x.txt")
        (out / "frames.csv").unlink()
        self.assertIn("frames.csv", self.sgs("view", out, code=1).stderr)
        config = (out / "config.toml").read_text()
        (out / "config.toml").write_text(config.replace("format = 3", "format = 4"))
        self.assertIn("later version", self.sgs("eval", out, code=1).stderr)
        old = config.replace('fusion = "remove"', 'fusion = "prior"')
        self.assertNotEqual(old, config)
        (out / "config.toml").write_text(old)
        self.assertIn("tracker.type", self.sgs("eval", out, code=2).stderr)

    def test_compare_and_plots_draw_from_what_is_there(self):
        out, _ = self.run_folder(self.master)
        self.sgs(
            "run",
            self.master,
            "-o",
            self.folder / "gicp",
            "--tracker",
            "gicp",
            "--quiet",
            "--no-eval",
        )
        before = {path: path.stat().st_mtime_ns for path in out.rglob("*")}
        self.sgs(
            "eval",
            out,
            self.folder / "gicp",
            "--compare",
            "-o",
            self.folder / "both.html",
            "--plots",
            self.folder / "plots",
        )
        page = (self.folder / "both.html").read_text()
        self.assertIn("★", page)
        self.assertIn("tracker.type", page)
        self.assertNotRegex(page, r"https?://(?!www\.w3\.org)")
        self.assertTrue((self.folder / "plots" / "error.svg").exists())
        self.sgs("eval", out, "--plots", self.folder / "one")
        for name in ("trajectory_top", "degeneracy", "weights", "timing", "map_growth"):
            self.assertTrue((self.folder / "one" / f"{name}.svg").exists(), name)
        self.assertEqual(before, {path: path.stat().st_mtime_ns for path in out.rglob("*")})
        self.sgs("eval", out, "-o", self.folder / "x.html", code=2)

    def test_progress_on_a_terminal_and_plain_lines_elsewhere(self):
        command = [str(SGS), "run", str(self.master), "--no-eval", "-o"]
        try:
            ours, theirs = pty.openpty()
        except OSError as error:  # a bare chroot has none
            self.skipTest(f"no pseudo-terminals here: {error}")
        process = subprocess.Popen(
            [*command, "terminal"], cwd=self.folder, stderr=theirs, stdout=subprocess.DEVNULL
        )
        os.close(theirs)
        shown = b""
        try:
            while chunk := os.read(ours, 4096):
                shown += chunk
        except OSError:  # Linux ends a terminal nobody holds open any more with EIO
            pass
        os.close(ours)
        self.assertEqual(process.wait(timeout=240), 0)
        self.assertRegex(
            shown.decode(),
            r"\r\x1b\[K\[#+\.*\] \d+/16 frames +[\d.]+/s +ETA \d+ s +" r"ok +\d+ Gaussians",
        )
        self.assertIn("16/16 frames", shown.decode())
        plain = self.sgs(*command[1:], "plain").stderr
        self.assertIn("16/16 frames", plain)
        self.assertNotRegex(plain, r"[\r\x1b]")

    def test_a_terminal_that_is_gone_costs_no_run(self):
        out = self.folder / "out"
        command = [SGS, "run", "synth:room_desk", "--frames", "0:8", "--no-eval", "-o", out]
        with open("/dev/full", "w") as full:
            done = subprocess.run(command, stderr=full, stdout=subprocess.DEVNULL, timeout=240)
        self.assertEqual(done.returncode, 0)
        self.assertEqual(len(self.lists(out, "trajectory.txt")), 8)

    def test_streams_that_are_closed_cost_no_run(self):
        for closed in (">&- 2>&-", "<&- >&- 2>&-", "2>&-", "2>&1 | head -n 1"):
            with self.subTest(closed):
                out = self.folder / "out"
                done = subprocess.run(
                    ["bash", "-o", "pipefail", "-c", f"{self.run_command(out)} {closed}"],
                    stdout=subprocess.DEVNULL,
                    timeout=240,
                )
                self.assertEqual(done.returncode, 0)
                self.assertEqual(len(self.lists(out, "trajectory.txt")), 8)
                self.assertRegex((out / "lock.txt").read_text(), r"\A[^\n]*\d+")

    def test_a_hang_up_keeps_what_was_done(self):
        out = self.folder / "out"
        command = self.run_command(out, frames=2000)
        run = subprocess.Popen(
            ["bash", "-c", f"exec {command}"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        while run.poll() is None and len(self.lists_so_far(out, "trajectory.txt")) < 2:
            time.sleep(0.05)
        run.send_signal(signal.SIGHUP)
        self.assertEqual(run.wait(timeout=240), 130)
        self.assertGreater(len(self.lists(out, "trajectory.txt")), 1)
        self.assertIn("interrupted", (out / "state.toml").read_text())

    def test_a_trace_that_cannot_be_written_costs_no_run(self):
        out = self.folder / "out"
        command = f"{self.run_command(out)} --trace '{self.folder}/none.txt/trace.json'"
        (self.folder / "none.txt").write_text("a file, no folder")
        done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, timeout=240)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("none.txt", done.stderr)
        self.assertEqual(len(self.lists(out, "trajectory.txt")), 8)
        self.assertTrue((out / "map.ply").exists())

    def test_a_scoring_that_is_stopped_is_no_score(self):
        out = self.folder / "out"
        self.sgs("run", self.long_sequence(), "--no-eval", "--quiet", "-o", out)
        run = subprocess.Popen([SGS, "eval", out], stderr=subprocess.PIPE, text=True)
        for line in run.stderr:  # it has begun
            if "scor" in line or "eval" in line or "frame" in line:
                break
        run.send_signal(signal.SIGINT)
        run.stderr.read()
        run.stderr.close()
        if run.wait(timeout=240) != 0:  # not over before
            self.assertEqual(run.returncode, 130)
            self.assertIsNone(json.loads((out / "metrics.json").read_text()).get("psnr_db"))

    def test_results_that_cannot_be_printed_are_a_failure(self):
        with open("/dev/full", "w") as full:
            done = subprocess.run(
                [SGS, "info", "--config"], stdout=full, stderr=subprocess.PIPE, text=True
            )
        self.assertEqual(done.returncode, 1)
        self.assertIn("standard output", done.stderr)

    def test_suite_makes_a_table_and_resumes(self):
        command = [
            "bench",
            "tum-synth",
            "--filter",
            "^(fold|nostruct_far)-",
            "--levels",
            "clean",
            "--variants",
            "gicp",
            "spectral",
            "--seeds",
            1,
            "--frames",
            6,
            "-o",
            "suite",
        ]
        first = self.sgs(*command, "--jobs", 2)
        self.assertRegex(first.stdout, r"(?m)^clean gicp( +\d+\.\d\d \(\d+\.\d\d\)){2}$")
        self.assertRegex(first.stdout, r"(?m)^clean spectral( +\d+\.\d\d \(\d+\.\d\d\)){2}$")
        self.assertRegex(first.stdout, r"(?m)^GS-ICP SLAM \[1\] +116\.16")
        metrics = self.folder / "suite" / "fold-clean-gicp-1" / "metrics.json"
        self.assertEqual(json.loads(metrics.read_text())["frames"], 6)
        metrics.unlink()
        again = self.sgs(*command)
        self.assertIn("3 of 4 runs were done before", again.stderr)
        self.assertTrue(metrics.exists())
        self.assertEqual(again.stdout, first.stdout)
        markdown = self.sgs(*command, "--markdown").stdout.splitlines()
        self.assertRegex(
            markdown[0],
            r"^`sgs bench tum-synth --filter '\^\(fold\|nostruct_far\)-' "
            r".*-o suite --markdown`, sgs \d+\.\d+\.\d+.*, \d+ cores, "
            r"\d{4}-\d\d-\d\d$",
        )
        self.assertIn("|  | nostruct_far | fold |", markdown)

    def test_suite_of_ones_own(self):
        (self.folder / "mine.toml").write_text(
            f"[[sequence]]\nname = 'desk'\ninput = '{self.master}'\n"
            "[[variant]]\nname = 'plain'\narguments = ['--tracker', 'gicp']\n"
        )
        self.assertIn(
            "joint | paper", self.sgs("bench", "mine.toml", "--variants", "x", code=2).stderr
        )
        done = self.sgs("bench", "mine.toml", "--variants", "plain", "--seeds", 1, "--frames", 4)
        self.assertRegex(done.stdout, r"(?m)^recorded plain +\d+\.\d\d")
        self.assertTrue((self.folder / "runs/bench-mine/desk-recorded-plain-1/map.ply").exists())
        (self.folder / "mine.toml").write_text("[[sequence]]\nname = 'desk'\nfolder = 'x'\n")
        self.assertIn(
            "mine.toml:3: unknown key 'folder'", self.sgs("bench", "mine.toml", code=1).stderr
        )
        self.assertIn("Allowed: replica | tum-synth | tum", self.sgs("bench", "tom", code=2).stderr)

    def test_benchmark_runs_what_lies_in_a_folder(self):
        self.assertIn("say with --data DIR", self.sgs("bench", "tum", code=2).stderr)
        self.assertIn("nothing of", self.sgs("bench", "tum", "--data", ".", code=1).stderr)
        (self.folder / "data" / "deeper").mkdir(parents=True)
        (self.folder / "data" / "deeper" / "FR1_xyz").symlink_to(self.master)
        (self.folder / "data" / "rgbd_dataset_freiburg1_desk.tgz").write_bytes(b"")
        command = ["bench", "tum", "--data", "data", "--frames", 4, "-o", "out"]
        listed = self.sgs(*command, "--list").stdout.splitlines()
        self.assertEqual(len(listed), 1)
        self.assertRegex(listed[0], "--data data .*--shard 0/1  # fr1_xyz-recorded-spectral-1$")
        done = self.sgs(*command)
        self.assertIn("found fr1_xyz: data/deeper/FR1_xyz\n", done.stderr)
        self.assertRegex(done.stdout, r"(?m)^ +fr1_desk +fr1_xyz +fr2_xyz +fr3_office ")
        self.assertRegex(done.stdout, r"(?m)^recorded spectral +- +\d+\.\d\d \(\d+\.\d\d\) +-")
        self.assertRegex(done.stdout, r"(?m)^Spectral GS-SLAM \(paper\) \[2\] +3\.05 +1\.75")
        self.assertRegex(done.stdout, r"(?m)^SplaTAM \[\d+\] +22\.00 +24\.50 +21\.90")
        self.assertIn(
            "fr1_desk: it is packed: tar -xf data/rgbd_dataset_freiburg1_desk.tgz -C data\n",
            done.stdout,
        )
        self.assertIn("\nFrames: fr1_xyz 4\n", done.stdout)
        self.assertRegex(done.stdout, "fr2_xyz: not there; .* as rgbd_dataset_freiburg2_xyz\n")
        metrics = self.folder / "out" / "fr1_xyz-recorded-spectral-1" / "metrics.json"
        self.assertGreater(json.loads(metrics.read_text())["psnr_db"], 0)

    def test_interrupted_suite_goes_on(self):
        command = [
            str(SGS),
            "bench",
            "tum-synth",
            "--filter",
            "^fold-",
            "--levels",
            "clean",
            "--seeds",
            "1",
            "--frames",
            "40",
            "-o",
            "suite",
        ]
        process = subprocess.Popen(
            command,
            cwd=self.folder,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )
        folder = self.folder / "suite" / "fold-clean-spectral-1"
        begun = folder.parent / "running" / "fold-clean-spectral-1.0" / "log.txt"
        while not begun.exists() and process.poll() is None:
            time.sleep(0.02)
        os.killpg(process.pid, signal.SIGINT)
        shown, _ = process.communicate(timeout=240)
        self.assertEqual(process.returncode, 130)
        self.assertRegex(shown, r"(?m)^clean spectral +-$")
        self.assertIn("interrupted", (folder / "state.toml").read_text())
        self.assertRegex(self.sgs(*command[1:]).stdout, r"(?m)^clean spectral +\d+\.\d\d")
        self.assertEqual(json.loads((folder / "metrics.json").read_text())["frames"], 40)

    def test_sweep_draws_a_plot(self):
        done = self.sgs(
            "sweep",
            "geometry_weight=0.2:0.4",
            "--filter",
            "^fold-",
            "--levels",
            "clean",
            "--seeds",
            1,
            "--frames",
            4,
            "--variant",
            "spectral",
            "-o",
            "sweep",
        )
        self.assertRegex(done.stdout, r"(?m)^0\.2 +\d+\.\d\d")
        self.assertRegex(done.stdout, r"(?m)^0\.4 +\d+\.\d\d")
        self.assertIn("<svg", (self.folder / "sweep" / "sweep.svg").read_text())

    def test_suite_reports_failed_runs_and_bad_options(self):
        command = [
            "bench",
            "tum-synth",
            "--filter",
            "^fold-",
            "--levels",
            "clean",
            "--seeds",
            1,
            "--frames",
            2,
            "-o",
            "suite",
        ]
        done = self.sgs(*command, "--set", "tracker.nonsense=1", code=1)
        self.assertRegex(done.stderr, r"fold-clean-spectral-1 exit 2: .*nonsense")
        self.assertRegex(done.stdout, r"(?m)^clean spectral +-$")
        self.assertNotIn("published", done.stdout)
        self.assertIn("--filter '('", self.sgs("bench", "--filter", "(", "-o", "x", code=2).stderr)
        for option, value in (
            ("--levels", "rough"),
            ("--seeds", "-1"),
            ("--frames", "-1"),
            ("--variants", "magic"),
            ("--jobs", "0"),
        ):
            self.assertIn(value, self.sgs(*command, option, value, code=2).stderr)
        self.sgs("sweep", "geometry_weight=a:b", code=2)

    def test_every_subcommand_has_help(self):
        self.sgs("--help")
        for name in ("run", "eval", "render", "synth", "export", "info", "bench", "sweep"):
            self.assertIn("--help", self.sgs(name, "--help").stdout)
        self.assertRegex(self.sgs("--version").stdout, r"\d+\.\d+\.\d+")

    def test_info(self):
        self.assertIn("room_desk", self.sgs("info", "--scenes").stdout)
        self.assertIn("keyframe_interval", self.sgs("info", "--config").stdout)
        self.assertEqual(
            json.loads(self.sgs("info", self.master, "--json").stdout)["frames"], FRAMES
        )

    def test_calibrated_depth_is_used_and_kept(self):
        file = self.folder / "depth.toml"
        calibrated = self.sgs("calibrate", self.long_sequence(), "-o", file)
        self.assertIn("mean offset", calibrated.stdout)
        self.assertIn("offset_per_m", file.read_text())
        run = ["run", self.long_sequence(), "--frames", "0:6", "--quiet"]
        self.sgs(*run, "--calibration", file, "-o", self.folder / "with")
        self.sgs(*run, "-o", self.folder / "without")
        depth_l1 = [
            json.loads((self.folder / name / "metrics.json").read_text())["depth_l1_m"]
            for name in ("with", "without")
        ]
        self.assertNotEqual(depth_l1[0], depth_l1[1])
        report = (self.folder / "with" / "report.html").read_text()
        self.assertIn("id='depth_offset'", report)
        self.assertIn("id='depth_offset_sigma'", report)
        self.assertNotIn("depth_offset", (self.folder / "without" / "report.html").read_text())
        # The folder holds its own copy: scoring does not need the file.
        file.unlink()
        self.sgs("eval", self.folder / "with", "--quiet")
        again = json.loads((self.folder / "with" / "metrics.json").read_text())["depth_l1_m"]
        self.assertEqual(again, depth_l1[0])

    def test_a_run_calibrates_itself_when_asked_to(self):
        run = ["run", self.long_sequence(), "--quiet", "--no-eval"]
        self.sgs(*run, "--calibration", "auto", "-o", self.folder / "out")
        self.assertIn("offset_per_m", (self.folder / "out" / "calibration.toml").read_text())
        self.assertIn("out/calibration.toml", (self.folder / "out" / "config.toml").read_text())
        # Too little to tell: the run goes on with the depths as they are.
        done = self.sgs(
            "run", self.master, "--calibration", "auto", "-o", self.folder / "short", "--no-eval"
        )
        self.assertIn("depth is used as it is", done.stderr)
        self.assertFalse((self.folder / "short" / "calibration.toml").exists())

    def test_a_finished_map_is_refined(self):
        sequence = self.sequence()
        out, _ = self.run_folder(sequence)
        before = {p: p.read_bytes() for p in sorted(out.rglob("*")) if p.is_file()}
        refined = self.folder / "refined"
        done = self.sgs("refine", out, "--steps", "30", "-o", refined, "--quiet", "--json")
        self.assertIsNotNone(json.loads(done.stdout)["psnr_db_train"])
        for name in (*RUN_FILES, "refine.toml"):
            self.assertTrue((refined / name).exists(), name)
        self.assertTrue(list((refined / "renders").glob("*_before.png")))
        self.assertEqual(before, {p: p.read_bytes() for p in before})
        self.sgs("eval", refined)
        picture = sorted((sequence / "rgb").iterdir())[4]
        shutil.copy(sorted((sequence / "rgb").iterdir())[9], picture)
        done = self.sgs("refine", out, "--steps", "30", "-o", self.folder / "again", code=2)
        self.assertIn("frame 4 of", done.stderr)
        self.assertFalse((self.folder / "again" / "map.ply").exists())

    def test_the_preset_quality_refines_and_is_for_recordings(self):
        few = ("--frames", "0:6", "--set", "refine.least_steps=40")
        out, _ = self.run_folder(self.master, "--preset", "quality", *few)
        config = (out / "config.toml").read_text()
        self.assertIn("quality", config)
        self.assertIn("steps_per_frame = 15", config)
        for live in (["--realtime", self.master], ["live:tcp://127.0.0.1:1"]):
            done = self.sgs("run", *live, "--preset", "quality", "-o", self.folder / "no", code=2)
            self.assertIn("--preset quality", done.stderr)

    def test_record_can_be_run_again(self):
        self.sgs(
            "run",
            "synth:room_desk",
            "--frames",
            "0:6",
            "--record",
            self.folder / "kept",
            "-o",
            self.folder / "out",
            "--quiet",
            "--no-eval",
        )
        self.sgs("run", self.folder / "kept", "-o", self.folder / "again", "--quiet", "--no-eval")
        self.assertEqual(
            (self.folder / "out" / "trajectory.txt").read_text().split()[1:8],
            (self.folder / "again" / "trajectory.txt").read_text().split()[1:8],
        )


class BadInput(Case):
    def fails(self, *arguments, code, saying):
        done = self.sgs(
            "run", *arguments, "-o", self.folder / "out", "--quiet", "--no-eval", code=code
        )
        for words in saying:
            self.assertIn(words.lower(), done.stderr.lower())
        return done

    def survives(self, sequence, *arguments, code=0):
        self.sgs("run", sequence, "-o", self.folder / "out", "--quiet", *arguments, code=code)
        return json.loads((self.folder / "out" / "metrics.json").read_text())

    def test_missing_folder(self):
        self.fails("no/such/folder", code=1, saying=["no/such/folder"])

    def test_unknown_layout(self):
        (self.folder / "empty").mkdir()
        self.fails(self.folder / "empty", code=1, saying=["rgb.txt", "results"])

    def test_no_calibration(self):
        sequence = self.sequence()
        (sequence / "camera.txt").unlink()
        (sequence / "sgs.toml").unlink(missing_ok=True)
        self.fails(sequence, code=1, saying=["calibration", "--camera", "sgs.toml"])
        self.sgs(
            "run",
            sequence,
            "--camera",
            "535.4,539.2,320.1,247.6",
            "--depth-scale",
            "5000",
            "-o",
            self.folder / "given",
            "--quiet",
            "--no-eval",
        )

    def test_damaged_calibration(self):
        sequence = self.sequence()
        (sequence / "sgs.toml").unlink(missing_ok=True)
        for line in (
            "nan 539 320 247 640 480 5000",
            "535 539 320 247 640 480",
            "0 0 0 0 0 0 0",
            "",
        ):
            (sequence / "camera.txt").write_text(line + "\n")
            self.fails(sequence, code=1, saying=["camera.txt", "fx"])
        self.fails(sequence, "--camera", "535,nan,320,247", code=2, saying=["--camera"])
        self.fails(
            sequence,
            "--camera",
            "535,535,320,247",
            "--depth-scale",
            "-1",
            code=2,
            saying=["depth-scale"],
        )

    def test_missing_image(self):
        sequence = self.sequence()
        (sequence / self.lists(sequence, "rgb.txt")[3].split()[1]).unlink()
        metrics = self.survives(sequence)
        self.assertEqual(metrics["frames"], FRAMES)
        self.assertEqual(metrics["frames_tracked"], FRAMES - 1)

    def test_truncated_and_empty_images(self):
        sequence = self.sequence()
        color = sequence / self.lists(sequence, "rgb.txt")[4].split()[1]
        color.write_bytes(color.read_bytes()[:2000])
        (sequence / self.lists(sequence, "depth.txt")[7].split()[1]).write_bytes(b"")
        metrics = self.survives(sequence)
        self.assertEqual(metrics["frames_tracked"], FRAMES - 2)
        log = (self.folder / "out" / "log.txt").read_text()
        self.assertIn(color.name, log)
        csv = (self.folder / "out" / "frames.csv").read_text()
        self.assertEqual(csv.count(",bad"), 2)

    def test_all_zero_depth(self):
        sequence = self.sequence()
        for line in self.lists(sequence, "depth.txt"):
            write_png(sequence / line.split()[1], 640, 480, 0)
        metrics = self.survives(sequence, code=3)
        self.assertEqual(metrics["frames_tracked"], 0)
        self.assertIsNone(metrics["psnr_db"])

    def test_zero_depth_in_the_middle_recovers(self):
        sequence = self.sequence()
        for line in self.lists(sequence, "depth.txt")[6:9]:
            write_png(sequence / line.split()[1], 640, 480, 0)
        metrics = self.survives(sequence)  # vision alone carries the camera over the gap
        self.assertEqual(metrics["frames"], FRAMES)
        self.assertLess(metrics["ate_rmse_m"], 0.02)
        metrics = self.survives(sequence, "--tracker", "gicp")  # nothing left to track with
        self.assertEqual(metrics["frames_lost"], 3)

    def test_eight_bit_depth(self):
        sequence = self.sequence()
        for line in self.lists(sequence, "depth.txt"):
            write_png(sequence / line.split()[1], 640, 480, 9, bits=8)
        self.fails(sequence, code=1, saying=["8-bit"])

    def test_sizes_differ(self):
        sequence = self.sequence()
        for line in self.lists(sequence, "depth.txt"):
            write_png(sequence / line.split()[1], 320, 200, 5000)  # of another shape
        self.fails(sequence, code=1, saying=["640", "320"])

    def test_size_changes_on_the_way(self):
        sequence = self.sequence()
        small = [
            sequence / self.lists(sequence, name)[row].split()[1]
            for name, row in (("depth.txt", 5), ("rgb.txt", 9), ("depth.txt", 9))
        ]
        write_png(small[0], 320, 200, 5000)  # another shape: not the same view
        write_png(small[1], 320, 240, 90, bits=8, channels=3)
        write_png(small[2], 320, 200, 5000)
        self.assertEqual(self.survives(sequence)["frames_tracked"], FRAMES - 2)
        log = (self.folder / "out" / "log.txt").read_text()
        self.assertIn(small[0].name, log)  # colour and depth differ
        self.assertIn(small[1].name, log)  # both differ from the calibration
        self.assertIn("320x240", log)

    def test_truncated_jpeg(self):
        sequence = self.folder / "sequence"
        self.sgs("synth", "room_desk", sequence, "--frames", 6, "--jpeg", "--quiet")
        cut = sequence / self.lists(sequence, "rgb.txt")[3].split()[1]
        self.assertEqual(cut.suffix, ".jpg")
        cut.write_bytes(cut.read_bytes()[:-2000])
        (sequence / self.lists(sequence, "rgb.txt")[4].split()[1]).write_bytes(b"")
        self.assertEqual(self.survives(sequence)["frames_tracked"], 4)
        self.assertIn(cut.name, (self.folder / "out" / "log.txt").read_text())

    def test_nan_and_non_unit_truth(self):
        sequence = self.sequence()
        rows = self.lists(sequence, "groundtruth.txt")
        rows[2] = " ".join(rows[2].split()[:1] + ["nan"] * 3 + rows[2].split()[4:])
        rows[5] = " ".join(rows[5].split()[:4] + ["3", "0", "0", "4"])
        (sequence / "groundtruth.txt").write_text("\n".join(rows) + "\n")
        metrics = self.survives(sequence)
        self.assertLess(metrics["ate_rmse_m"], 0.02)

    def test_no_truth(self):
        sequence = self.sequence()
        (sequence / "groundtruth.txt").unlink()
        metrics = self.survives(sequence)
        self.assertIsNone(metrics["ate_rmse_m"])
        self.assertIsNotNone(metrics["psnr_db"])

    def test_unsorted_and_duplicate_times(self):
        sequence = self.sequence()
        rows = self.lists(sequence, "rgb.txt")
        rows = rows[8:] + rows[:8] + [rows[3]]
        (sequence / "rgb.txt").write_text("\n".join(rows) + "\n")
        metrics = self.survives(sequence)
        self.assertEqual(metrics["frames_tracked"], FRAMES)

    def test_no_overlap_in_time(self):
        sequence = self.sequence()
        rows = [
            f"{float(r.split()[0]) + 500:.6f} {r.split()[1]}"
            for r in self.lists(sequence, "depth.txt")
        ]
        (sequence / "depth.txt").write_text("\n".join(rows) + "\n")
        self.fails(sequence, code=1, saying=["clock", "depth.txt"])

    def test_no_overlap_with_truth(self):
        sequence = self.sequence()
        rows = [
            f"{float(r.split()[0]) + 500:.6f} {r.split(maxsplit=1)[1]}"
            for r in self.lists(sequence, "groundtruth.txt")
        ]
        (sequence / "groundtruth.txt").write_text("\n".join(rows) + "\n")
        metrics = self.survives(sequence, "--no-eval")
        self.assertIsNone(metrics["ate_rmse_m"])
        self.assertIn("ground truth", (self.folder / "out" / "log.txt").read_text())

    def test_one_frame_only(self):
        metrics = self.survives(self.master, "--frames", "0:1")
        self.assertEqual(metrics["frames"], 1)

    def test_depth_calibration_that_does_not_fit(self):
        file = self.folder / "depth.toml"
        self.fails(self.master, "--calibration", file, code=1, saying=["depth.toml"])
        file.write_text(
            "format = 1\n[camera]\nfx = 9\nfy = 9\ncx = 1\ncy = 1\nwidth = 4\nheight = 4\n"
            "[depth]\ncolumns = 1\nrows = 1\noffset_per_m = [0.1]\nsigma_per_m = [0.1]\n"
        )
        self.fails(
            self.master, "--calibration", file, code=2, saying=["another camera", "sgs calibrate"]
        )
        file.write_text("[camera]\n")
        self.fails(self.master, "--calibration", file, code=1, saying=["no depth calibration"])

    def test_a_recording_too_short_to_calibrate(self):
        done = self.sgs("calibrate", self.master, "-o", self.folder / "depth.toml", code=1)
        self.assertIn("keyframes", done.stderr)
        self.assertIn("is used as it is", done.stderr)
        self.assertFalse((self.folder / "depth.toml").exists())

    def test_unknown_key_and_bad_values(self):
        self.fails(
            self.master, "--set", "slam.keyframe_intervall=3", code=2, saying=["keyframe_interval"]
        )
        self.fails(self.master, "--set", "slam.keyframe_interval=0", code=2, saying=["1 .. 1000"])
        self.fails(
            self.master,
            "--set",
            "slam.keyframe_interval=nan",
            code=2,
            saying=["slam.keyframe_interval"],
        )
        self.fails(self.master, "--set", "nonsense", code=2, saying=["key=value"])
        self.fails(
            self.master,
            "--set",
            "mapper.schedule.freeze_after_steps=9",
            code=2,
            saying=["mapper.schedule.freeze_after_steps", "removed"],
        )
        self.fails(
            self.master,
            "--set",
            "mapper.insertion.method=quatdree",
            code=2,
            saying=["mean 'quadtree'", "quadtree | grid"],
        )
        self.fails(
            self.master, "--set", 9999 * "nonsense" + "=1", code=2, saying=["unknown config key"]
        )
        self.fails(self.master, "--frames", "9:3", code=2, saying=["a:b"])
        self.fails("synth:no_such_scene", code=2, saying=["room_desk"])
        self.fails("synth:room_desk:kinetc", code=2, saying=["kinect"])
        self.fails(self.master, "--preset", "defualt", code=2, saying=["default"])
        self.fails(self.master, "--tracker", "gicpp", code=2, saying=["gicp"])
        self.fails(self.master, "--config", self.folder / "none.toml", code=1, saying=["none.toml"])
        self.sgs("run", code=2)
        self.sgs("run", self.master, "--no-such-flag", code=2)
        (self.folder / "c.toml").write_text("[slam]\nkeyframe_interval = 3\nkeyframe_inteval = 4\n")
        self.fails(
            self.master,
            "--config",
            self.folder / "c.toml",
            code=2,
            saying=["c.toml", "3", "keyframe_interval"],
        )

    def test_unwritable_output(self):
        (self.folder / "file").write_text("x")
        done = self.sgs("run", self.master, "-o", self.folder / "file" / "sub", "--quiet", code=1)
        self.assertIn("file", done.stderr)

    def test_disk_full_on_the_way(self):
        # A file size limit fails large writes as a full disk does; map.ply is the largest file.
        environment = dict(os.environ, TMPDIR=str(self.folder))
        done = subprocess.run(
            [
                "bash",
                "-c",
                f"ulimit -f 64; exec '{SGS}' run '{self.master}' -o out --quiet --no-eval",
            ],
            capture_output=True,
            text=True,
            cwd=self.folder,
            env=environment,
            timeout=240,
        )
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("map.ply", done.stderr)
        self.assertEqual(len(self.lists(self.folder / "out", "trajectory.txt")), FRAMES)

    def test_no_room_in_the_run_folder(self):
        # A private file system with room for the small files; the others go to TMPDIR.
        (self.folder / "out").mkdir()
        (self.folder / "elsewhere").mkdir()
        script = (
            f"mount -t tmpfs -o size=128k none out || exit 77; '{SGS}' run '{self.master}' -o "
            "out --quiet --no-eval; code=$?; cp -r out seen; exit $code"
        )
        as_root = [] if os.geteuid() == 0 else ["--map-root-user"]
        done = subprocess.run(
            ["unshare", *as_root, "--mount", "bash", "-c", script],
            capture_output=True,
            text=True,
            cwd=self.folder,
            timeout=240,
            env=dict(os.environ, TMPDIR=str(self.folder / "elsewhere")),
        )
        if done.returncode == 77 or "unshare" in done.stderr:
            self.skipTest("mounting in a private name space is not allowed here")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertRegex(done.stderr, "map.ply.*No space left")
        rescued = list((self.folder / "elsewhere").glob("sgs-rescue-*/map.ply"))
        self.assertEqual(len(rescued), 1)
        self.assertIn(str(rescued[0].parent), done.stderr)
        self.assertEqual(len(self.lists(self.folder / "seen", "trajectory.txt")), FRAMES)

    def test_folder_removed_during_the_run(self):
        out = self.folder / "out"
        with subprocess.Popen(
            [SGS, "run", "synth:room_desk", "--frames", "0:60", "-o", out],
            cwd=self.folder,
            stderr=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            text=True,
        ) as process:
            # Frames are on the disk, the results are not. At once, as a disk that is unplugged.
            frames = out / "frames.csv"
            while not frames.exists() or frames.read_text().count("\n") < 4:
                self.assertIsNone(process.poll())
                time.sleep(0.01)
            out.rename(self.folder / "gone")
            process.communicate(timeout=240)
        self.assertEqual(process.returncode, 0)
        for name in RUN_FILES:
            self.assertTrue((out / name).exists(), name)
        self.assertEqual(len(self.lists(out, "trajectory.txt")), 60)
        self.assertIn("removed during the run", (out / "log.txt").read_text())
        self.sgs("eval", out, "--quiet")

    def test_output_folder_of_something_else(self):
        sequence = self.sequence()
        before = sorted(path.name for path in sequence.iterdir())
        done = self.sgs("run", self.master, "-o", sequence, "--quiet", code=2)
        self.assertIn("no run folder", done.stderr)
        self.assertEqual(sorted(path.name for path in sequence.iterdir()), before)

    def test_a_run_that_goes_on_can_be_read(self):
        out = self.folder / "out"
        with subprocess.Popen(
            [SGS, "run", "synth:room_desk", "-o", out],
            cwd=self.folder,
            stderr=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            text=True,
        ) as process:
            self.assertTrue(process.stderr.readline())
            while not (out / "checkpoint.txt").exists():
                time.sleep(0.01)
            process.send_signal(signal.SIGSTOP)
            done = self.sgs("eval", out, "--quiet", "--json")
            self.assertEqual(json.loads(done.stdout)["state"], "running")
            self.assertIn("still being written", done.stderr)
            self.assertFalse((out / "metrics.json").exists())
            process.kill()

    def test_second_interrupt_ends_at_once(self):
        process = subprocess.Popen(
            [SGS, "run", "synth:room_desk", "-o", self.folder / "out"],
            cwd=self.folder,
            stderr=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            text=True,
        )
        self.assertTrue(process.stderr.readline())
        # Both requests are pending when the program wakes up, so neither can win a race.
        for request in (signal.SIGSTOP, signal.SIGINT, signal.SIGTERM, signal.SIGCONT):
            process.send_signal(request)
        process.communicate(timeout=120)
        self.assertIn(process.returncode, (-signal.SIGINT, -signal.SIGTERM))

    def test_interrupt_keeps_what_was_done(self):
        out = self.folder / "out"
        process = subprocess.Popen(
            [SGS, "run", "synth:room_desk", "-o", out],
            cwd=self.folder,
            stderr=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.assertTrue(process.stderr.readline())  # the first progress line: frames are coming
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=120)
        self.assertEqual(process.returncode, 130)
        for name in RUN_FILES:
            self.assertTrue((out / name).exists(), name)
        done = len(self.lists(out, "trajectory.txt"))
        self.assertGreater(done, 0)
        self.assertLess(done, 600)
        metrics = json.loads((out / "metrics.json").read_text())
        self.assertEqual((metrics["frames"], metrics["state"]), (done, "interrupted"))
        self.assertIn("interrupted", self.sgs("eval", out, "--quiet").stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
