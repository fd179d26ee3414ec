# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""`sgs refine` where something is not as it should be: nothing that was there is lost.

Usage: refine_test.py SGS_EXECUTABLE [unittest arguments]
"""
import array
import json
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

SGS = pathlib.Path(sys.argv.pop(1)).resolve()
FRAMES = 10
INTERRUPTED = 130


def with_harmonics(source, target, degree=3):
    """Rewrites a map as other programs do: with colour beyond degree 0."""
    head, body = source.read_bytes().split(b"end_header\n", 1)
    more = 3 * ((degree + 1) ** 2 - 1)
    lines = head.decode().splitlines()
    at = lines.index("property float f_dc_2") + 1
    floats = array.array("f", body)
    width = sum(line.startswith("property") for line in lines)
    before = at - next(i for i, line in enumerate(lines) if line.startswith("property"))
    rows = array.array("f")
    for i in range(0, len(floats), width):
        rows += floats[i : i + before]
        rows += array.array("f", [0.01] * more)
        rows += floats[i + before : i + width]
    lines[at:at] = [f"property float f_rest_{k}" for k in range(more)]
    target.write_bytes("\n".join(lines).encode() + b"\nend_header\n" + rows.tobytes())


class Refine(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.shared = pathlib.Path(tempfile.mkdtemp(prefix="sgs-refine-"))
        cls.recording = cls.shared / "recording"
        cls.source = cls.shared / "run"
        for arguments in (
            ["synth", "room_desk", cls.recording, "--frames", str(FRAMES)],
            ["run", cls.recording, "-o", cls.source, "--no-eval"],
        ):
            subprocess.run([SGS, *arguments, "--quiet"], check=True, capture_output=True)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.shared, ignore_errors=True)

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="case-", dir=self.shared))
        self.out = self.folder / "refined"

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

    def refine(self, run, *arguments, code=0):
        return self.sgs("refine", run, "-o", self.out, "--no-eval", *arguments, code=code)

    def test_no_time_at_all_gives_the_map_as_it_was(self):
        done = self.refine(self.source, "--minutes", 0)
        self.assertIn("nothing became better", done.stderr)
        for name in ("trajectory.txt", "keyframes.txt"):
            self.assertEqual(
                (self.out / name).read_bytes(), (self.source / name).read_bytes(), name
            )
        before, after = ((folder / "map.ply").stat().st_size for folder in (self.source, self.out))
        self.assertEqual(before, after)
        self.assertIn("finished", (self.out / "state.toml").read_text())

    def test_an_interrupt_keeps_the_best_so_far(self):
        process = subprocess.Popen(
            [SGS, "refine", self.source, "--steps", "100000", "-o", self.out]
            + ["--set", "refine.checks=1000", "--set", "refine.patience=0"],
            cwd=self.folder,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )
        line = process.stderr.readline()
        while not re.search(r" [1-9]\d* steps", line):
            self.assertTrue(line, "ended by itself")
            line = process.stderr.readline()
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=240)
        self.assertEqual(process.returncode, INTERRUPTED, said)
        self.assertIn("interrupted", (self.out / "state.toml").read_text())
        self.sgs("export", self.out, "ply", self.folder / "best.ply")
        # An interrupted refinement is a run as good as any.
        again = self.folder / "again"
        self.sgs("refine", self.out, "--steps", 20, "-o", again, "--no-eval", "--quiet")

    def test_a_recording_that_is_gone_or_cut_is_named(self):
        recording = self.folder / "recording"
        shutil.copytree(self.recording, recording)
        run = self.folder / "run"
        self.sgs("run", recording, "-o", run, "--no-eval", "--quiet")
        for name in ("rgb.txt", "depth.txt"):
            lines = (recording / name).read_text().splitlines()
            (recording / name).write_text("\n".join(lines[:-3]) + "\n")
        done = self.refine(run, "--steps", 10, code=2)
        self.assertIn(f"frame {FRAMES - 3} of", done.stderr)
        shutil.rmtree(recording)
        done = self.refine(run, "--steps", 10, code=1)
        self.assertIn(str(recording), done.stderr)
        self.assertIn("bring it back", done.stderr)
        self.assertFalse((self.out / "map.ply").exists())

    def test_one_keyframe_and_one_frame(self):
        run = self.folder / "run"
        self.sgs("run", self.recording, "--frames", "0:1", "-o", run, "--no-eval", "--quiet")
        done = self.refine(run, "--steps", 30)
        self.assertIn("nothing is held out", done.stderr)
        self.assertEqual(len((self.out / "keyframes.txt").read_text().splitlines()), 1)

    def test_maps_of_other_programs_with_and_without_harmonics(self):
        theirs = self.folder / "theirs.ply"
        for prepare in (shutil.copy, with_harmonics):
            prepare(self.source / "map.ply", theirs)
            poses = ["--map", theirs, "--poses", self.source / "trajectory.txt"]
            done = self.refine(self.recording, *poses, "--steps", 30, "--json")
            self.assertIn("PSNR held out", done.stderr)
            self.assertEqual(json.loads(done.stdout)["frames"], FRAMES)
            head = (self.out / "map.ply").read_bytes().split(b"end_header\n")[0]
            self.assertEqual(head.count(b"f_rest_"), 45 if prepare is with_harmonics else 0)
            shutil.rmtree(self.out)
        theirs.write_bytes(theirs.read_bytes()[:-100])
        done = self.refine(self.recording, *poses, "--steps", 30, code=1)
        self.assertIn("theirs.ply", done.stderr)
        self.refine(self.recording, "--map", theirs, "--steps", 30, code=2)

    def test_harmonics_go_where_the_map_goes(self):
        done = self.refine(self.source, "--steps", 40, "--set", "refine.harmonics=2", "--quiet")
        self.assertEqual(done.returncode, 0)
        head = (self.out / "map.ply").read_bytes().split(b"end_header\n")[0]
        self.assertEqual(head.count(b"f_rest_"), 24)
        for kind in ("ply", "spz", "html", "splat"):
            self.sgs("export", self.out, kind, self.folder / f"map.{kind}")
        self.assertIn("data-degree='2'", (self.folder / "map.html").read_text())
        # Colours may differ in the last bit: they are kept as other numbers than those of the file.
        sizes = [(folder / "map.ply").stat().st_size for folder in (self.folder, self.out)]
        self.assertEqual(*sizes)
        self.sgs("render", self.out, "--every", 5, "--quiet", "-o", self.folder / "pictures")
        again = self.folder / "again"
        self.sgs("refine", self.out, "--steps", 10, "-o", again, "--no-eval", "--quiet")
        self.assertIn(b"f_rest_23", (again / "map.ply").read_bytes()[:2000])

    def test_what_is_refined_is_never_written_over(self):
        before = (self.source / "map.ply").read_bytes()
        self.sgs("refine", self.source, "--steps", 10, "-o", self.source, code=2)
        self.assertEqual(before, (self.source / "map.ply").read_bytes())


if __name__ == "__main__":
    unittest.main()
