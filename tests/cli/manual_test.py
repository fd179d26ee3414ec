# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Man pages and bash completion know every command and option that the program has.

Usage: manual_test.py SGS_EXECUTABLE [unittest arguments]
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

SGS = sys.argv.pop(1)


def run(*command, text=None):
    done = subprocess.run(command, capture_output=True, text=True, input=text, timeout=60)
    if done.returncode != 0:
        raise AssertionError(f"{command}: exit {done.returncode}\n{done.stderr}")
    return done.stdout


def commands():
    listed = run(SGS, "--help").split("Subcommands:")[1]
    return re.findall(r"^  (\w[\w-]*)", listed, flags=re.M)


class Manual(unittest.TestCase):
    def test_every_command_has_a_page_with_every_option(self):
        overview = run(SGS, "man").replace("\\-", "-")
        self.assertGreater(len(commands()), 8)
        for command in commands():
            self.assertIn(f"sgs-{command} (1)", overview)
            page = run(SGS, "man", command).replace("\\-", "-")
            for option in re.findall(
                r"^  (?:-\w,)?(--[a-z0-9-]+)", run(SGS, command, "--help"), re.M
            ):
                self.assertRegex(page, rf"{option}\b", f"{command} {option}")

    def test_man_prints_the_pages_without_complaint(self):
        if shutil.which("man") is None:
            self.skipTest("no man (Debian package man-db)")
        with tempfile.TemporaryDirectory() as folder:
            run(SGS, "man", "--write", folder)
            pages = list((pathlib.Path(folder) / "man/man1").glob("*.1"))
            self.assertEqual(len(pages), len(commands()) + 1)
            for page in pages:
                done = subprocess.run(
                    ["man", "--warnings", "-E", "UTF-8", "-l", "-Tutf8", str(page)],
                    capture_output=True,
                    text=True,
                    timeout=60,
                )
                self.assertEqual((done.returncode, done.stderr), (0, ""), page.name)
                self.assertIn("EXIT STATUS", re.sub(".\x08", "", done.stdout))

    def test_a_command_that_does_not_exist_is_said(self):
        done = subprocess.run([SGS, "man", "walk"], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 2)
        self.assertIn("walk", done.stderr)


class Completion(unittest.TestCase):
    def complete(self, *words):
        script = (
            run(SGS, "completion") + f"COMP_WORDS=(sgs {' '.join(repr(w) for w in words)})\n"
            f"COMP_CWORD={len(words)}\n_sgs 2>/dev/null\nprintf '%s\\n' \"${{COMPREPLY[@]}}\"\n"
        )
        return set(run("bash", "--norc", text=script).split())

    def test_commands_options_words_and_keys(self):
        self.assertEqual(self.complete("re"), {"refine", "render"})
        self.assertEqual(set(commands()) - self.complete(""), set())
        self.assertIn("--tracker", self.complete("run", "--tra"))
        self.assertNotIn("--voxel", self.complete("run", "--"))
        self.assertIn("--voxel", self.complete("export", "RUN", "--"))
        self.assertEqual(self.complete("export", "RUN", "me"), {"mesh"})
        self.assertIn("mapper.iterations_per_frame=", self.complete("run", "--set", "mapper.it"))
        self.assertEqual(self.complete("run", "--set", "--tra"), set())
        self.assertEqual(self.complete("run", "no-such-file"), set())

    def test_bash_knows_it(self):
        self.assertIn(
            "_sgs", run("bash", "--norc", text=run(SGS, "completion") + "complete -p sgs\n")
        )


if __name__ == "__main__":
    unittest.main()
