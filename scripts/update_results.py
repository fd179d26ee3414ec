#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Runs the commands named in a Markdown page and puts what they print in their place.

update_results.py NAME... [--with WORD=VALUE]... [--page docs/results.md] [--programs FOLDER]
update_results.py all [--with WORD=VALUE]... | readme | --list

A block of the page says what makes it, and everything between its two lines is replaced:

    <!-- begin NAME: COMMAND -->
    ...
    <!-- end NAME -->

COMMAND is run by bash in the repository's root, with --programs (that of the release preset) first
in PATH, so that `sgs bench tum-synth --markdown` is one. `--with DIR=../data` runs the command with
../data where it says DIR; the page goes on to say DIR. A command that fails or prints nothing leaves
the page as it is. `all` renews every block, one after the other, and what README quotes of them;
`readme` only the latter: the cells that README_TABLES names.
"""
import argparse
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
BEGIN = re.compile(r"<!-- begin (?P<name>[\w.-]+): (?P<command>.+) -->")
END = re.compile(r"<!-- end (?P<name>[\w.-]+) -->")


# What README quotes. For each of its tables: heading, then label, and (block, row, column) of each
# cell; a list of several is shown with strokes between.
README_TABLES = [
    (
        "| real recording | ours | live at 30 Hz | geometry only (`--tracker gicp`) |"
        " features only (`--tracker orb`) | PSNR of the map, live / offline, dB |",
        [
            (
                label,
                [("real", name, "ATE, cm: spectral (as said)")],
                [("real", name, "live: ATE, cm")],
                [("real", name, "gicp")],
                [("real", name, "orb")],
                [("real", name, "live: PSNR full, dB"), ("real", name, "PSNR full / held out, dB")],
            )
            for name, label in [
                ("tum_fr1_xyz", "TUM `freiburg1_xyz`, 797 Kinect frames"),
                ("7scenes_redkitchen_600", "7-Scenes RedKitchen, 600 Kinect frames"),
            ]
        ],
    ),
    (
        "| rendered, with a sensor's faults | ours | geometry only | features only |",
        [
            (
                label,
                *(
                    [("accuracy-hard", f"hard {tracker}", scene)]
                    for tracker in ("spectral", "gicp", "orb")
                ),
            )
            for scene, label in [
                ("nostruct_far", "textured wall, no structure (`nostructure_texture_far`)"),
                ("nostruct_near", "the same nearer, with a loop (`nostructure_texture_near`)"),
                ("notex_near", "zig-zag panels, no texture (`structure_notexture_near`)"),
                ("room_desk", "desk in a room (`room_desk`)"),
                ("corridor", "corridor (`corridor`)"),
            ]
        ],
    ),
]


class Wrong(Exception):
    """What is wrong with the page, the names or a command."""


def blocks(lines):
    """(name, command, index of the begin line, index of the end line) of each block."""
    found, names, opened = [], set(), None
    for index, line in enumerate(lines):
        begin, end = BEGIN.fullmatch(line.strip()), END.fullmatch(line.strip())
        if begin and opened is None:
            opened = (begin["name"], begin["command"], index)
            if opened[0] in names:
                raise Wrong(f"line {index + 1}: there are two blocks '{opened[0]}'")
        elif end and opened and end["name"] == opened[0]:
            found.append((*opened, index))
            names.add(opened[0])
            opened = None
        elif begin or end:
            raise Wrong(
                f"line {index + 1}: '{(begin or end)['name']}' where "
                + (f"'{opened[0]}' has not ended" if opened else "no block has begun")
            )
    if opened:
        raise Wrong(f"line {opened[2] + 1}: '{opened[0]}' does not end")
    return found


def output(name, command, programs, values):
    for word, value in values.items():
        command = re.sub(rf"\b{re.escape(word)}\b", lambda _, value=value: value, command)
    print(f"{name}: {command}", file=sys.stderr, flush=True)
    environment = dict(os.environ, PATH=f"{programs}:{os.environ['PATH']}")
    done = subprocess.run(
        ["bash", "-o", "pipefail", "-c", command],
        cwd=ROOT,
        env=environment,
        stdout=subprocess.PIPE,
        text=True,
        check=False,
    )
    if done.returncode != 0:
        raise Wrong(f"'{name}' ended with exit code {done.returncode}")
    if not done.stdout.strip():
        raise Wrong(f"'{name}' printed nothing")
    text = done.stdout
    for word, value in values.items():
        text = text.replace(value, word)
    return text.strip("\n").split("\n")


def renew(page, names, programs, values):
    """Renews the named blocks one by one: what is done is kept when a later command fails."""
    known = [block[0] for block in blocks(page.read_text().split("\n"))]
    for name in names:
        if name not in known:
            raise Wrong(f"no block '{name}': there are {', '.join(known)}")
    for name in names:
        lines = page.read_text().split("\n")
        _, command, begin, end = next(b for b in blocks(lines) if b[0] == name)
        lines[begin + 1 : end] = output(name, command, programs, values)
        page.write_text("\n".join(lines))


def cells(lines, block):
    """{(row, column): cell} of the tables of a block; a row is called by its first words in bold."""
    _, _, begin, end = next((b for b in blocks(lines) if b[0] == block), (None, None, 0, 0))
    found, columns = {}, None
    for line in lines[begin + 1 : end]:
        if not line.startswith("|"):
            columns = None
            continue
        row = [cell.strip() for cell in line.strip().removeprefix("|").removesuffix("|").split("|")]
        if columns is None:
            columns = row
        elif not set(row[0]) <= set("-: "):
            bold = re.match(r"\*\*(.+?)\*\*", row[0])
            name = bold[1] if bold else row[0]
            found.update({(name, c): cell for c, cell in zip(columns[1:], row[1:])})
    return found


def quoted(lines, references):
    """The numbers that stand there, without bold type and what is in brackets; with the share of
    frames where it is below 100 %."""
    numbers = []
    for block, row, column in references:
        cell = cells(lines, block).get((row, column))
        if cell is None:
            raise Wrong(f"no '{row}' under '{column}' in block '{block}', which README quotes")
        number = re.split(r" \(| / ", cell.replace("*", ""))[0]
        share = re.search(r" (\d+)%$", cell)
        if share:  # of frames with a place that is right: an error without it says too much
            number = "lost" if share[1] == "0" else f"{number} ({share[1]} %)"
        numbers.append(number)
    return " / ".join(numbers)


def renew_readme(page, readme):
    """Puts the numbers of the page into README's tables."""
    lines = page.read_text().split("\n")
    text = readme.read_text().split("\n")
    for heading, rows in README_TABLES:
        if heading not in text:
            raise Wrong(f"{readme.name} has no table '{heading}'")
        first = text.index(heading) + 2
        last = next(i for i in range(first, len(text) + 1) if not text[i].startswith("|"))
        text[first:last] = [
            f"| {label} | "
            + " | ".join(
                f"**{quoted(lines, r)}**" if i == 0 else quoted(lines, r)
                for i, r in enumerate(references)
            )
            + " |"
            for label, *references in rows
        ]
    readme.write_text("\n".join(text))


def can_be_renewed(page, values):
    """Names of the blocks whose commands have a value for each of their words in capitals."""
    names = []
    for name, command, *_ in blocks(page.read_text().split("\n")):
        missing = [w for w in set(re.findall(r"\b[A-Z]{3,}\b", command)) if w not in values]
        if missing:
            print(f"{name}: left as it is, without --with {missing[0]}=...", file=sys.stderr)
        else:
            names.append(name)
    return names


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--page", type=pathlib.Path, default=ROOT / "docs" / "results.md")
    parser.add_argument("--readme", type=pathlib.Path, default=ROOT / "README.md")
    parser.add_argument(
        "--programs", type=pathlib.Path, default=ROOT / "build" / "release" / "apps" / "sgs"
    )
    parser.add_argument("--list", action="store_true", help="only print names and commands")
    parser.add_argument("--with", action="append", default=[], metavar="WORD=VALUE", dest="values")
    arguments = parser.parse_args()
    if not arguments.names and not arguments.list:
        parser.error("name the blocks to renew; --list shows them")
    if not all(re.fullmatch(r"\w+=.+", value) for value in arguments.values):
        parser.error("write --with WORD=VALUE")
    try:
        if arguments.list:
            for name, command, *_ in blocks(arguments.page.read_text().split("\n")):
                print(f"{name}: {command}")
        else:
            values = dict(value.split("=", 1) for value in arguments.values)
            names = [name for name in arguments.names if name != "readme"]
            if names == ["all"]:
                names = can_be_renewed(arguments.page, values)
            renew(arguments.page, names, arguments.programs.resolve(), values)
            if {"all", "readme"} & set(arguments.names):
                renew_readme(arguments.page, arguments.readme)
    except (Wrong, OSError) as error:
        print(f"{arguments.page}: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
