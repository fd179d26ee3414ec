#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Checks which file may include which.

- A module of src/sgs may include itself and what its DEPS row in src/sgs/CMakeLists.txt reaches. The
  rows are read from CMake, so that the link list and the include rule cannot drift apart.
- The rows stand from the bottom up: one depends on earlier rows only. The layer table of
  docs/architecture.md has the same modules, and none depends on a module of a higher layer.
- A folder of apps/ or benchmarks/ may include the modules that the targets of its CMakeLists.txt
  link, and what those reach.
- src includes nothing outside src; apps/ neither includes nor links what benchmarks/ defines, nor
  the other way round.
- OpenCV stays out of public headers, but for those of `features`.
- What libsgs shows (src/sgs/api, without internal/) includes nothing but itself and the standard
  library; python/ includes nothing of ours but that.

check_layers.py [FOLDER]: of the repository, where it is not the script's own.
"""
import pathlib
import re
import sys

SUFFIXES = (".h", ".cc", ".cu", ".cuh", ".inl")


def commands(path, name):
    """The words of every call of a CMake command in a file."""
    text = re.sub(r"#.*", "", path.read_text())
    return [body.split() for body in re.findall(rf"\b{name}\s*\(([^()]*)\)", text)]


def read_rows(cmake):
    rows = {}
    for name, *words in commands(cmake, "sgs_add_module"):
        deps, section = [], None
        for word in words:
            if word in ("DEPS", "LIBS", "PRIVATE_LIBS"):
                section = word
            elif section == "DEPS":
                deps.append(word)
        rows[name] = deps
    return rows


def reachable(rows, name, seen=None):
    seen = set() if seen is None else seen
    for dep in rows.get(name, []):
        if dep not in seen:
            seen.add(dep)
            reachable(rows, dep, seen)
    return seen


def includes(path):
    for number, line in enumerate(path.read_text().splitlines(), 1):
        match = re.match(r'\s*#\s*include\s*(["<])([^">]+)[">]', line)
        if match:
            yield number, match.group(1) == '"', match.group(2)


def sources(folder):
    return sorted(p for p in folder.rglob("*") if p.suffix in SUFFIXES)


def read_table(page):
    """The modules of a layer table, lines `| 3 | name | what |`, and the layers they stand in."""
    if not page.exists():
        return None
    rows = re.findall(r"^\|\s*(\d+)\s*\|\s*(\w+)\s*\|", page.read_text(), flags=re.M)
    return {name: int(layer) for layer, name in rows}


class Checker:
    def __init__(self, root):
        self.root = root
        self.rows = read_rows(root / "src" / "sgs" / "CMakeLists.txt")
        self.problems = []

    def complain(self, path, number, text):
        self.problems.append(f"{path.relative_to(self.root)}:{number}: {text}")

    def check_module_include(self, path, number, name, allowed, who):
        """A line `#include "sgs/MODULE/..."` of `who`."""
        module = name.split("/")[1]
        if module not in allowed:
            self.complain(path, number, f"'{who}' may not include '{module}'")

    def check_order(self):
        """Rows and layers, from the bottom up."""
        cmake, page = "src/sgs/CMakeLists.txt", "docs/architecture.md"
        table = read_table(self.root / page)
        if table is not None:
            for name in sorted(self.rows.keys() - table.keys()):
                self.problems.append(f"{page}: the layer table lacks the module '{name}'")
            for name in sorted(table.keys() - self.rows.keys() - {"apps"}):
                self.problems.append(f"{page}: there is no module '{name}'")
        names = list(self.rows)
        for place, name in enumerate(names):
            for dep in self.rows[name]:
                if dep in names[place + 1 :]:
                    self.problems.append(f"{cmake}: '{name}' depends on the later row '{dep}'")
                if table and table.get(dep, 0) > table.get(name, 0):
                    self.problems.append(f"{page}: '{name}' depends on '{dep}' of a higher layer")

    def check_modules(self):
        source = self.root / "src" / "sgs"
        for name in self.rows:
            if name in reachable(self.rows, name):
                self.problems.append(f"module '{name}' depends on itself through its DEPS")
        for path in sources(source):
            module = path.relative_to(source).parts[0]
            allowed = reachable(self.rows, module) | {module}
            for number, quoted, name in includes(path):
                if name.startswith("sgs/"):
                    self.check_module_include(path, number, name, allowed, module)
                elif quoted and not name.startswith("hwy/"):
                    self.complain(path, number, f"'{name}' is not below src")
                elif "opencv2" in name and path.suffix == ".h" and module != "features":
                    self.complain(path, number, "OpenCV in a public header")

    def targets(self, area):
        """The targets that the CMake files below a folder define."""
        return {
            words[0]
            for cmake in area.rglob("CMakeLists.txt")
            for kind in ("add_library", "add_executable")
            for words in commands(cmake, kind)
        }

    def linked(self, cmake):
        """The targets of ours that a CMake file links."""
        return {
            word
            for words in commands(cmake, "target_link_libraries")
            for word in words[1:]
            if word.startswith("sgs_")
        }

    def check_programs(self, area, other):
        """A folder of programs, and one whose code is none of its business."""
        foreign = self.targets(other)
        modules = set()
        for cmake in sorted(area.rglob("CMakeLists.txt")):
            for target in sorted(self.linked(cmake)):
                if target in foreign:
                    self.complain(cmake, 1, f"links '{target}' of {other.name}/")
                modules.add(target.removeprefix("sgs_"))
        allowed = set().union(modules, *(reachable(self.rows, m) for m in modules))
        for path in sources(area):
            for number, quoted, name in includes(path):
                if name.startswith("sgs/"):
                    self.check_module_include(path, number, name, allowed, area.name)
                elif quoted and self.only_in(other, area, path, name):
                    self.complain(path, number, f"'{name}' belongs to {other.name}/")

    def only_in(self, other, area, path, name):
        """Whether an include of `path` names a file of `other` and none of `area`."""
        beside = (path.parent / name).resolve()
        if beside.exists():
            return beside.is_relative_to(other)
        ends = lambda folder: any(p.as_posix().endswith("/" + name) for p in sources(folder))
        return not ends(area) and ends(other)

    def check_shown(self):
        """What libsgs shows, and who uses only that."""
        api = self.root / "src" / "sgs" / "api"
        shown = {f"sgs/api/{path.name}" for path in api.glob("*.h")}
        for path in sorted(api.glob("*.h")):
            for number, _, name in includes(path):
                if name not in shown and ("/" in name or "." in name):
                    self.complain(path, number, f"'{name}' in a header that libsgs shows")
        for path in sources(self.root / "python"):
            for number, _, name in includes(path):
                if name.startswith("sgs/") and name not in shown:
                    self.complain(path, number, f"'{name}' is not shown by libsgs")

    def check(self):
        self.check_order()
        self.check_modules()
        self.check_shown()
        apps, benchmarks = self.root / "apps", self.root / "benchmarks"
        self.check_programs(apps, benchmarks)
        self.check_programs(benchmarks, apps)
        return self.problems


def main():
    here = pathlib.Path(__file__).resolve().parent.parent
    root = pathlib.Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else here
    checker = Checker(root)
    problems = checker.check()
    for problem in problems:
        print(problem)
    print(f"{len(checker.rows)} modules, {len(problems)} problems")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
