#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Counts by how many hands a frame that is remembered goes, and a past that is revised.

Usage: count_past.py [--list] [FOLDER]: of the repository, where it is not the script's own.

Read from the sources of the modules that remember frames (MODULES), tests left out:

- pose copies: structs of which many are kept (a header declares a vector, deque or array of them) and
  that know their frame (its index or time) and keep its tracked pose, or points placed by it
  (PhotometricReference). In `mapper` and `slam`, T_world_camera is the refined pose and does not count.
- functions that follow: declarations in headers of functions without a result that are named for it
  (correct, note_applied, follow, ...) or are given a change of poses or of depth to carry out. Each
  override counts for itself.
- files a revision enters: header and source of one name are one file. Files that carry out, hand on or
  make a change of poses (PastCorrection, PoseCorrection, Update, note_applied, follow); who only looks a
  pose up in the newest revision is none of them.
- pixel formats: different types in which structs and classes of these modules keep pictures or depth.
- memory knobs: parameters that bound how many frames, or how much memory for them, one holder keeps.
"""
import argparse
import pathlib
import re
import sys

MODULES = ("alignment", "backend", "history", "loops", "mapper", "slam", "tracker")
ALSO = ("camera/past_correction.h", "registration/photometric.h")

TRACKED = r"\bSE3\s+T_(?:odom|local|world)_camera\b|\bPhotometricReference\s+\w+"
BESIDE_REFINED = r"\bSE3\s+T_odom_camera\b"
FRAME = r"\b(?:timestamp_s|frame|frame_index|index)_?\b\s*(?:=[^;]*)?;"
KEPT = r"\b(?:vector|deque|unique_ptr|array)<(?:\w+::)*(\w+)(?:\[\])?[>,]"
CHANGE = r"(?:PastCorrection|PoseCorrection|DepthChange)\b"
NAMES = r"(?:correct|correct_past|move_past|note_applied|apply_last|follow|move_keyframes?)"
FOLLOWS = rf"\bvoid\s+({NAMES}|\w+(?=\s*\([^()]*{CHANGE}))\s*\("
ENTERS = (
    r"\bPastCorrection\b|\bPoseCorrection\b|\bhistory::Update\b|\bstruct Update\b"
    r"|\bnote_applied\s*\(|\bvoid\s+follow\s*\("
)
FORMAT = (
    r"\b(KeyframePictures|TrainingView|StoredView|GrayPyramid|InverseDepthField"
    r"|PhotometricReference)\b[^;()]*\b\w+(?:\s*=[^;]*)?;"
)
KNOB = r'\badd\(\s*"(memory_mb|relocalise_keyframes|most)"'


def without_comments(text):
    return re.sub(r"//[^\n]*", "", text)


def line_of(text, at):
    return text.count("\n", 0, at) + 1


def structs(text):
    """Names and own bodies (without those of nested structs) of the structs and classes in a header."""
    for match in re.finditer(r"\b(?:struct|class)\s+((?:\w+::)*\w+)[^;{}()]*\{", text):
        depth, own = 1, []
        for at in range(match.end(), len(text)):
            depth += {"{": 1, "}": -1}.get(text[at], 0)
            if depth == 0:
                break
            if depth == 1:
                own.append(text[at])
        yield match.group(1), "".join(own), match.start()


class Past:
    def __init__(self, root):
        source = root / "src" / "sgs"
        files = [
            p for m in MODULES for p in sorted((source / m).rglob("*")) if p.suffix in (".h", ".cc")
        ]
        files += [source / name for name in ALSO if (source / name).exists()]
        is_test = lambda p: p.stem.endswith("_test") or p.stem.startswith("test_")
        self.texts = {
            str(p.relative_to(source)): without_comments(p.read_text())
            for p in files
            if not is_test(p)
        }

    def headers(self):
        return ((name, text) for name, text in self.texts.items() if name.endswith(".h"))

    def pose_copies(self):
        for name, text in self.headers():
            pose = BESIDE_REFINED if name.split("/")[0] in ("mapper", "slam") else TRACKED
            for struct, body, at in structs(text):
                holds = re.search(pose, body) and re.search(FRAME, body)
                if holds and self.is_kept(struct, name):
                    yield f"{name}:{line_of(text, at)}", struct

    def is_kept(self, struct, name):
        """Whether this header, or one that has no struct of that name, declares many of them."""
        others = (
            text
            for other, text in self.headers()
            if other == name or struct not in {found for found, _, _ in structs(text)}
        )
        return any(struct in re.findall(KEPT, text) for text in others)

    def functions(self):
        for name, text in self.headers():
            for match in re.finditer(FOLLOWS, text):
                yield f"{name}:{line_of(text, match.start())}", match.group(1)

    def files(self):
        entered = {
            name.rsplit(".", 1)[0] for name, text in self.texts.items() if re.search(ENTERS, text)
        }
        return ((name, "") for name in sorted(entered))

    def formats(self):
        found = {}
        for name, text in self.headers():
            for struct, body, at in structs(text):
                for format in re.findall(FORMAT, body):
                    found.setdefault(format, f"{name}:{line_of(text, at)} {struct}")
        # One picture and its depth, kept side by side, are one format.
        if "GrayPyramid" in found and "InverseDepthField" in found:
            found["GrayPyramid, InverseDepthField"] = found.pop("GrayPyramid")
            found.pop("InverseDepthField")
        return ((where, format) for format, where in found.items())

    def knobs(self):
        for name, text in self.headers():
            for match in re.finditer(KNOB, text):
                yield f"{name}:{line_of(text, match.start())}", match.group(1)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", nargs="?", default=pathlib.Path(__file__).resolve().parent.parent)
    parser.add_argument("--list", action="store_true", help="where each is")
    arguments = parser.parse_args()
    past = Past(pathlib.Path(arguments.folder))
    if not past.texts:
        print(f"{arguments.folder}: no src/sgs with modules that remember frames", file=sys.stderr)
        return 2
    rows = {
        "pose copies": past.pose_copies,
        "functions that follow": past.functions,
        "files a revision enters": past.files,
        "pixel formats": past.formats,
        "memory knobs": past.knobs,
    }
    for title, find in rows.items():
        found = list(find())
        print(f"{title:24} {len(found):3}")
        if arguments.list:
            for where, what in found:
                print(f"    {where}  {what}".rstrip())
    return 0


if __name__ == "__main__":
    sys.exit(main())
