# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""The mapping benchmark and the script that races it.

Usage: mapping_benchmark_test.py SGS_MAPPING_BENCHMARK [unittest arguments]
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

BENCHMARK = pathlib.Path(sys.argv.pop(1)).resolve()
RACE = pathlib.Path(__file__).resolve().parent.parent.parent / "benchmarks" / "race.sh"


def call(*arguments):
    return subprocess.run([str(a) for a in arguments], capture_output=True, text=True, timeout=240)


class MappingBenchmark(unittest.TestCase):
    SMALL = (BENCHMARK, "--gaussians", 2000, "--width", 96, "--iterations", 3)

    def test_prints_one_line_of_json(self):
        for scene, share in (("room", (0.2, 0.6)), ("dense", (0.9, 1.0))):
            done = call(*self.SMALL, "--scene", scene, "--threads", 2, "--json")
            self.assertEqual(done.returncode, 0, done.stderr)
            result = json.loads(done.stdout)
            self.assertGreater(result["ms_p50"], 0)
            visible = result["visible"] / result["gaussians"]
            self.assertTrue(share[0] <= visible <= share[1], visible)

    def test_refuses_unknown_instruction_sets(self):
        done = call(*self.SMALL, "--isa", "mmx")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("choose best or one of", done.stderr)


class Race(unittest.TestCase):
    def test_asks_for_what_it_needs(self):
        for arguments, message in (
            ((), "usage: race.sh"),
            ((BENCHMARK,), "name the source to race against"),
            ((BENCHMARK, "/none.cpp"), "there is no file /none.cpp"),
            (("/none", __file__), "/none is no program"),
        ):
            done = call(RACE, *arguments)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn(message, done.stderr)

    def test_prints_a_ratio_for_each_row(self):
        with tempfile.TemporaryDirectory() as name:
            # Stands for both: a program that takes 2 ms as the one and 4 ms as the other.
            product, prototype = pathlib.Path(name) / "product", pathlib.Path(name) / "p.cpp"
            product.write_text("#!/bin/sh\necho '{\"ms_p50\": 2}'\n")
            product.chmod(0o755)
            prototype.write_text(
                '#include <cstdio>\nint main() { std::puts("TOTAL 4.0 (min 3.9)"); }'
            )
            done = call(RACE, product, prototype, 1)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("| 100k room, AVX-512 | 2.00 | 4.00 | 0.50 |", done.stdout)
            self.assertIn("| 100k room, one / two threads | 2.00 | 2.00 | 1.00 |", done.stdout)


if __name__ == "__main__":
    unittest.main(verbosity=2)
