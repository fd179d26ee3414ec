# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""What the sgs executable measures about itself: --trace, --preload, timings.json.

Usage: measure_test.py SGS_EXECUTABLE [unittest arguments]
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

SGS = pathlib.Path(sys.argv.pop(1)).resolve()


def sgs(*arguments):
    return subprocess.run(
        [str(SGS), *map(str, arguments)], capture_output=True, text=True, timeout=240
    )


class TimeLine(unittest.TestCase):
    def test_both_threads_are_on_the_trace_and_preloading_changes_nothing(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            maps = []
            for extra in ((), ("--preload", "--trace", folder / "trace.json")):
                out = folder / f"run{len(maps)}"
                done = sgs(
                    "run",
                    "synth:room_desk",
                    "--frames",
                    "0:10",
                    "--no-eval",
                    "--quiet",
                    "-o",
                    out,
                    *extra,
                )
                self.assertEqual(done.returncode, 0, done.stderr)
                maps.append((out / "map.ply").read_bytes())
            self.assertEqual(maps[0], maps[1])
            events = json.loads((folder / "trace.json").read_text())["traceEvents"]
            threads = {e["args"]["name"]: e["tid"] for e in events if e["ph"] == "M"}
            self.assertEqual(set(threads), {"tracking", "mapping"})
            spans = [e for e in events if e["ph"] == "X"]
            self.assertEqual(sum(e["name"] == "track" for e in spans), 10)
            self.assertTrue(all(e["dur"] >= 0 and e["ts"] >= 0 for e in spans))
            iterations = [e for e in spans if e["name"] == "map/iteration"]
            self.assertTrue(iterations)
            self.assertTrue(all(e["tid"] == threads["mapping"] for e in iterations))
            timings = json.loads((out / "timings.json").read_text())
            self.assertEqual(timings["track"]["calls"], 10)
            self.assertEqual(timings["map"]["children"]["iteration"]["calls"], len(iterations))


if __name__ == "__main__":
    unittest.main(verbosity=2)
