# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""The scripts that keep the house in order: that they find what they are there to find.

Usage: scripts_test.py [unittest arguments]
"""
import importlib.util
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPTS = pathlib.Path(__file__).resolve().parent.parent.parent / "scripts"


class Case(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def write(self, name, *lines):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("\n".join(lines) + "\n")
        return path

    def script(self, name, *arguments, code=0):
        done = subprocess.run(
            [sys.executable, str(SCRIPTS / name), *map(str, arguments)],
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done


class CheckLayers(Case):
    """On a small project without a fault, to which each test adds one."""

    def setUp(self):
        super().setUp()
        self.write(
            "src/sgs/CMakeLists.txt",
            "sgs_add_module(core)",
            "sgs_add_module(map DEPS core LIBS fmt::fmt)",
            "sgs_add_module(other)",
        )
        self.write(
            "src/sgs/map/map.cc",
            '#include "sgs/map/map.h"',
            '#include "sgs/core/error.h"',
            "#include <opencv2/core.hpp>",
        )
        self.write(
            "apps/one/CMakeLists.txt",
            "add_executable(one main.cc)",
            "target_link_libraries(one PRIVATE sgs_map)  # sgs_scenes",
        )
        self.write("apps/one/main.cc", '#include "commands.h"', '#include "sgs/core/error.h"')
        self.write("apps/one/commands.h")
        self.write(
            "benchmarks/CMakeLists.txt",
            "add_library(sgs_scenes STATIC scene.cc)",
            "target_link_libraries(sgs_scenes PUBLIC sgs_other)",
        )
        self.write("benchmarks/scene.cc", '#include "scene.h"', '#include "sgs/other/other.h"')
        self.write("benchmarks/scene.h")

    def faults(self):
        return self.script("check_layers.py", self.folder, code=1).stdout

    def test_without_fault(self):
        self.assertIn("3 modules, 0 problems", self.script("check_layers.py", self.folder).stdout)

    def test_a_module_that_includes_what_its_row_does_not_reach(self):
        self.write("src/sgs/core/core.h", "", '#include "sgs/map/map.h"')
        self.assertIn("src/sgs/core/core.h:2: 'core' may not include 'map'", self.faults())

    def test_a_circle_of_modules(self):
        self.write(
            "src/sgs/CMakeLists.txt",
            "sgs_add_module(core DEPS map)",
            "sgs_add_module(map DEPS core)",
            "sgs_add_module(other)",
        )
        self.assertIn("module 'core' depends on itself", self.faults())

    def test_rows_and_layers_out_of_order(self):
        self.write(
            "src/sgs/CMakeLists.txt",
            "sgs_add_module(map DEPS core)",
            "sgs_add_module(core)",
            "sgs_add_module(other)",
        )
        self.assertIn("'map' depends on the later row 'core'", self.faults())

    def test_a_layer_table_that_is_not_the_rows(self):
        self.write("docs/architecture.md", "| 2 | core | x |", "| 1 | map | x |", "| 3 | air | x |")
        faults = self.faults()
        self.assertIn("the layer table lacks the module 'other'", faults)
        self.assertIn("there is no module 'air'", faults)
        self.assertIn("'map' depends on 'core' of a higher layer", faults)

    def test_a_module_that_reaches_out_of_src(self):
        for include in ("commands.h", "../../../apps/one/commands.h", "scene.h"):
            self.write("src/sgs/core/core.cc", f'#include "{include}"')
            self.assertIn(f"core.cc:1: '{include}' is not below src", self.faults())

    def test_opencv_in_a_header(self):
        self.write("src/sgs/map/map.h", "#include <opencv2/core.hpp>")
        self.assertIn("map.h:1: OpenCV in a public header", self.faults())

    def test_a_program_that_includes_a_module_it_does_not_link(self):
        self.write("apps/one/main.cc", '#include "sgs/other/other.h"')
        self.assertIn("apps/one/main.cc:1: 'apps' may not include 'other'", self.faults())
        self.write("apps/one/main.cc")
        self.write("benchmarks/scene.cc", '#include "sgs/map/map.h"')
        self.assertIn("benchmarks/scene.cc:1: 'benchmarks' may not include 'map'", self.faults())

    def test_a_program_that_uses_benchmark_code(self):
        self.write("apps/one/main.cc", '#include "scene.h"')
        self.assertIn("main.cc:1: 'scene.h' belongs to benchmarks/", self.faults())
        self.write("apps/one/main.cc", '#include "../../benchmarks/scene.h"')
        self.assertIn("belongs to benchmarks/", self.faults())
        self.write("apps/one/main.cc")
        self.write("apps/one/CMakeLists.txt", "target_link_libraries(one PRIVATE sgs_scenes)")
        self.assertIn("links 'sgs_scenes' of benchmarks/", self.faults())

    def test_a_benchmark_that_uses_the_program(self):
        self.write("benchmarks/scene.cc", '#include "commands.h"')
        self.assertIn("scene.cc:1: 'commands.h' belongs to apps/", self.faults())


class UpdateResults(Case):
    def setUp(self):
        super().setUp()
        self.page = self.write(
            "page.md",
            "# Page",
            "<!-- begin one: tool 1 -->",
            "old",
            "<!-- end one -->",
            "between",
            "<!-- begin two: tool 2 -->",
            "<!-- end two -->",
            "after",
        )
        self.tool("echo; echo new $1; echo")

    def tool(self, script):
        self.write("bin/tool", "#!/bin/sh", script).chmod(0o755)

    def update(self, *names, code=0):
        done = self.script(
            "update_results.py",
            "--page",
            self.page,
            "--programs",
            self.folder / "bin",
            *names,
            code=code,
        )
        return done.stderr + done.stdout

    def test_replaces_the_named_blocks(self):
        self.update("two")
        self.assertEqual(
            self.page.read_text().splitlines(),
            [
                "# Page",
                "<!-- begin one: tool 1 -->",
                "old",
                "<!-- end one -->",
                "between",
                "<!-- begin two: tool 2 -->",
                "new 2",
                "<!-- end two -->",
                "after",
            ],
        )
        self.update("one", "two")
        self.assertIn("tool 1 -->\nnew 1\n<!-- end one", self.page.read_text())
        before = self.page.read_text()
        self.update("one", "two")
        self.assertEqual(self.page.read_text(), before)
        self.assertIn("one: tool 1\ntwo: tool 2\n", self.update("--list"))
        self.assertIn("name the blocks", self.update(code=2))

    def test_all_blocks_and_what_the_readme_quotes(self):
        tables = self.readme_tables()
        page = []
        for block in sorted({reference[0] for reference in tables}):
            rows = list(dict.fromkeys(r[1] for r in tables if r[0] == block))
            columns = list(dict.fromkeys(r[2] for r in tables if r[0] == block))
            text = ["|".join(["", "", *columns, ""]), "|---" * (len(columns) + 1) + "|"]
            text += [
                "|".join(["", f" {row} ", *(f" **{r}.{c}** (9) " for c in range(len(columns))), ""])
                for r, row in enumerate(rows)
            ]
            self.write(f"{block}.md", *text)
            page += [
                f"<!-- begin {block}: cat {self.folder}/{block}.md -->",
                f"<!-- end {block} -->",
            ]
        self.write("page.md", *page)
        headings = [heading for heading, _ in self.results().README_TABLES]
        readme = self.write(
            "README.md", *(line for h in headings for line in (h, "|---|", "| old |", ""))
        )
        self.update("all", "--readme", readme)
        text = readme.read_text()
        self.assertNotIn("old", text)
        self.assertIn("| **0.0** | ", text)
        for heading in headings:
            self.assertIn(heading, text)
        self.write("page.md", *(line.replace("real", "unreal") for line in page))
        self.assertIn("which README quotes", self.update("readme", "--readme", readme, code=1))

    def test_quotes_the_share_of_frames_that_have_a_place(self):
        self.write(
            "page.md",
            "<!-- begin one: x -->",
            "|  | whole | most | none |",
            "|---|---|---|---|",
            "| row | **1.5** (1.6) | 2.5 (2.6) 97% | 99.1 (99.2) 0% |",
            "<!-- end one -->",
        )
        quoted = [
            self.results().quoted(self.page.read_text().split("\n"), [("one", "row", column)])
            for column in ("whole", "most", "none")
        ]
        self.assertEqual(quoted, ["1.5", "2.5 (97 %)", "lost"])

    def results(self):
        spec = importlib.util.spec_from_file_location("results", SCRIPTS / "update_results.py")
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module

    def readme_tables(self):
        """(block, row, column) of every number that README quotes."""
        return [
            reference
            for _, rows in self.results().README_TABLES
            for _, *cells in rows
            for cell in cells
            for reference in cell
        ]

    def test_fills_in_words_and_keeps_them_on_the_page(self):
        self.write("page.md", "<!-- begin one: tool DIR NODIR -->", "<!-- end one -->")
        self.tool('echo "from $1 and $2"')
        self.assertIn("tool ../data NODIR", self.update("one", "--with", "DIR=../data"))
        self.assertIn("\nfrom DIR and NODIR\n", self.page.read_text())
        self.update("one", "--with", "DIR", code=2)

    def test_leaves_the_page_where_a_command_fails(self):
        before = self.page.read_text()
        for script, message in (
            ("echo half; exit 3", "'one' ended with exit code 3"),
            ("true", "'one' printed nothing"),
        ):
            self.tool(script)
            self.assertIn(message, self.update("one", code=1))
            self.assertEqual(self.page.read_text(), before)

    def test_says_what_is_wrong_with_the_page(self):
        self.assertIn("no block 'three': there are one, two", self.update("three", code=1))
        for lines, message in (
            (["<!-- begin a: x -->"], "line 1: 'a' does not end"),
            (["<!-- end a -->"], "line 1: 'a' where no block has begun"),
            (["<!-- begin a: x -->", "<!-- begin b: x -->"], "'a' has not ended"),
            (["<!-- begin a: x -->", "<!-- end a -->"] * 2, "line 3: there are two blocks 'a'"),
        ):
            self.write("page.md", *lines)
            self.assertIn(message, self.update("a", code=1))
        self.page.unlink()
        self.assertIn("page.md", self.update("a", code=1))


class CountPast(Case):
    """On modules that remember frames in each way there is."""

    def counts(self):
        lines = self.script("count_past.py", self.folder).stdout.splitlines()
        return {line[:24].strip(): int(line[24:]) for line in lines}

    def test_counts_nothing_where_nothing_is_remembered(self):
        self.write("src/sgs/slam/session.h", "struct Session {", "  int frames = 0;", "};")
        self.assertEqual(set(self.counts().values()), {0})

    def test_a_pose_of_its_own(self):
        place = ["struct Place {", "  double timestamp_s = 0;", "  SE3 T_world_camera;", "};"]
        self.write("src/sgs/loops/place.h", *place)
        self.assertEqual(self.counts()["pose copies"], 0, "of which nobody keeps many")
        self.write("src/sgs/loops/places.h", "struct Places {", "  std::deque<Place> all;", "};")
        self.assertEqual(self.counts()["pose copies"], 1)
        self.write("src/sgs/slam/place.h", *place, "std::vector<Place> refined;")
        self.assertEqual(self.counts()["pose copies"], 1, "refined ones are another matter")
        self.write("src/sgs/loops/test_place.h", *place, "std::vector<Place> all;")
        self.assertEqual(self.counts()["pose copies"], 1, "nor do tests count")

    def test_who_follows_and_where_a_revision_enters(self):
        self.write(
            "src/sgs/tracker/points.h",
            "void follow(const LocalPast& past);",
            "void bend(const Keyframe& keyframe,",
            "          const DepthChange& change);",
            "// void correct(int);",
            "void look(const LocalPast& past);",
        )
        self.write("src/sgs/tracker/points.cc", "void Points::follow(const LocalPast& past) {}")
        self.write("src/sgs/slam/log.cc", "const SE3 T = revision.path.at(frame);")
        self.assertEqual(self.counts()["functions that follow"], 2)
        self.assertEqual(self.counts()["files a revision enters"], 1)

    def test_pictures_and_bounds_of_memory(self):
        self.write(
            "src/sgs/backend/keyframe.h",
            "struct Keyframe {",
            "  GrayPyramid gray;",
            "  registration::InverseDepthField inverse_depth;",
            "};",
            "struct Other {",
            "  StoredView view;",
            "  StoredView made() const;",
            "};",
            'p.add("most", most, "Keyframes kept.");',
            'p.add("most_loops", most_loops, "Edges.");',
        )
        self.assertEqual(self.counts()["pixel formats"], 2)
        self.assertEqual(self.counts()["memory knobs"], 1)

    def test_a_folder_without_sources(self):
        done = self.script("count_past.py", self.folder, code=2)
        self.assertIn(str(self.folder), done.stderr)
        self.assertNotIn("Traceback", done.stderr)


class RunTable(Case):
    """benchmarks/run_table.py with a stand-in for the program, whose runs all end alike."""

    METRICS = (
        '{"ate_rmse_m": 0.012, "ate_online_rmse_m": 0.02, "frames_lost": 0, "frames_dropped": 1,'
        ' "scale_error_percent": null, "psnr_db_full": 24.04, "cpu": "a CPU", "frames": 10,'
        ' "mapping_iterations": 25}'
    )

    def table(self, *arguments, code=0):
        sgs = self.folder / "sgs"
        if not sgs.exists():
            self.write(
                "sgs",
                "#!/bin/sh",
                'echo "$@" >> ' + str(self.folder / "calls"),
                'test "$2" != broken || exit 1',
                "mkdir -p $4",
                f"echo '{self.METRICS}' > $4/metrics.json",
            ).chmod(0o755)
        return self.script("../benchmarks/run_table.py", *arguments, "--sgs", sgs, code=code).stdout

    def test_a_row_for_each_real_recording(self):
        out = self.table("real", "a/one", "two=b/2", "--runs", self.folder / "runs")
        self.assertIn("| one | **1.20** (2.00) | 0 | n/a |", out)
        self.assertIn("| two |", out)
        self.assertIn("a CPU", out)
        calls = (self.folder / "calls").read_text().splitlines()
        self.assertEqual(len(calls), 10)
        self.table("real", "a/one", "two=b/2", "--runs", self.folder / "runs")
        self.assertEqual(len((self.folder / "calls").read_text().splitlines()), 10, "made once")

    def test_a_column_for_each_live_or_offline_run(self):
        self.assertIn("| mapping steps per frame | 2.5 | 2.5 |", self.table("live", "one", "two"))
        self.assertIn("| frames/s | n/a |", self.table("offline", "one"))

    def test_a_run_that_fails_leaves_no_table(self):
        self.assertEqual(self.table("live", "one", "broken", code=1), "")


if __name__ == "__main__":
    unittest.main(verbosity=2)
