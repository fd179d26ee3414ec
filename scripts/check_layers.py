#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Checks that every #include "sgs/..." obeys the layer table of src/sgs/CMakeLists.txt.

A module may include itself and what its DEPS row reaches. The rows are read from CMake, so that
the link list and the include rule cannot drift apart.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
SOURCE = ROOT / "src" / "sgs"


def read_rows():
    text = (SOURCE / "CMakeLists.txt").read_text()
    rows = {}
    for body in re.findall(r"sgs_add_module\(([^)]*)\)", text):
        words = body.split()
        name, deps, section = words[0], [], None
        for word in words[1:]:
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


def main():
    rows = read_rows()
    problems = []
    for name in rows:
        if name in reachable(rows, name):
            problems.append(f"module '{name}' depends on itself through its DEPS")
    for path in sorted(SOURCE.rglob("*")):
        if path.suffix not in (".h", ".cc", ".cu", ".cuh"):
            continue
        module = path.relative_to(SOURCE).parts[0]
        allowed = reachable(rows, module) | {module}
        for number, line in enumerate(path.read_text().splitlines(), 1):
            match = re.match(r'\s*#\s*include\s+"sgs/([^/"]+)/', line)
            if match and match.group(1) not in allowed:
                problems.append(
                    f"{path.relative_to(ROOT)}:{number}: '{module}' may not include '{match.group(1)}'"
                )
            if "opencv2" in line and path.suffix == ".h" and module != "features":
                problems.append(f"{path.relative_to(ROOT)}:{number}: OpenCV in a public header")
    for problem in problems:
        print(problem)
    print(f"{len(rows)} modules, {len(problems)} problems")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
