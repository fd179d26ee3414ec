# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""`pip install .` without a network, from a build that is there; the package works where it lies.

Usage: pip_test.py BUILD_FOLDER [unittest arguments]
"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

BUILD = sys.argv.pop(1)
ROOT = pathlib.Path(__file__).resolve().parent.parent.parent


class Pip(unittest.TestCase):
    def test_a_wheel_is_built_offline_and_works(self):
        try:
            import pip  # noqa: F401
        except ImportError:
            self.skipTest("no pip (Debian package python3-pip)")
        with tempfile.TemporaryDirectory(prefix="sgs-pip-") as folder:
            target = pathlib.Path(folder) / "site"
            pip = [sys.executable, "-m", "pip", "install", "--no-index", "--no-deps", "--quiet"]
            done = subprocess.run(
                [*pip, f"--config-settings=build-dir={BUILD}", f"--target={target}", str(ROOT)],
                capture_output=True,
                text=True,
                timeout=600,
            )
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            program = (
                f"import sys; sys.path.insert(0, {str(target)!r})\n"
                "import sgs\n"
                "camera = sgs.open('synth:room_desk', frames='0:1').camera\n"
                "print(camera.width, sgs.__file__)\n"
                "print([line for line in open('/proc/self/maps') if 'libsgs' in line][0].split()[-1])"
            )
            done = subprocess.run(
                [sys.executable, "-c", program], capture_output=True, text=True, timeout=60
            )
            self.assertEqual(done.returncode, 0, done.stderr)
            where, library = done.stdout.splitlines()
            self.assertIn(str(target), where)
            self.assertEqual(library, str(target / "sgs" / "libsgs.so.0"))


if __name__ == "__main__":
    unittest.main()
