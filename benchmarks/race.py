#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Alternating runs of the product's mapping iteration and a prototype's; called by race.sh.

Each round runs every contestant of a row once, so that whatever else the machine does hits all of
them; a cell is the median over rounds of a run's median iteration, a ratio the median over rounds
of the ratio within a round.
"""
import json
import re
import statistics
import subprocess
import sys

PRODUCT, WORK, ROUNDS = sys.argv[1], sys.argv[2], int(sys.argv[3])


def product(gaussians, width, scene, threads, isa):
    out = subprocess.run(
        [
            PRODUCT,
            "--json",
            "--gaussians",
            gaussians,
            "--width",
            width,
            "--scene",
            scene,
            "--threads",
            threads,
            "--isa",
            isa,
        ],
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    return json.loads(out)["ms_p50"]


def prototype(gaussians, width, scene, threads, isa):
    binary = "raster-avx2" if isa == "avx2" else "raster"
    mode = "1" if scene == "dense" else "0"
    out = subprocess.run(
        [f"{WORK}/{binary}", "bench", gaussians, width, mode, "0.6", threads, "0", "1", "2", "40"],
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    return float(re.search(r"TOTAL ([0-9.]+) \(min", out).group(1))


def race(title, first, second):
    """Times two contestants, (name, function, arguments) each, and prints one row."""
    times = ([], [])
    for _ in range(ROUNDS):
        for mine, (run, arguments) in zip(times, (first, second)):
            mine.append(run(*arguments))
    ratio = statistics.median(a / b for a, b in zip(*times))
    print(
        f"| {title} | {statistics.median(times[0]):.2f} | {statistics.median(times[1]):.2f} "
        f"| {ratio:.2f} |",
        flush=True,
    )


def main():
    n50, n100, n200 = "50000", "100000", "200000"
    views = [
        ("50k room", n50, "640", "room"),
        ("100k room", n100, "640", "room"),
        ("200k room", n200, "640", "room"),
        ("100k dense", n100, "640", "dense"),
        ("100k room, 320x240", n100, "320", "room"),
    ]
    print("| product / prototype | product ms | prototype ms | ratio |\n|---|---|---|---|")
    for name, *view in views:
        race(
            f"{name}, AVX-512",
            (product, (*view, "1", "avx512")),
            (prototype, (*view, "1", "avx512")),
        )
    for name, *view in views:
        race(
            f"{name}, AVX2 / AVX-512 prototype",
            (product, (*view, "1", "avx2")),
            (prototype, (*view, "1", "avx512")),
        )
    for name, *view in views[1:2]:
        race(
            f"{name}, AVX2 both", (product, (*view, "1", "avx2")), (prototype, (*view, "1", "avx2"))
        )
        race(
            f"{name}, two threads, wall",
            (product, (*view, "2", "avx512")),
            (prototype, (*view, "2", "avx512")),
        )
    print("\n| product / product | first ms | second ms | ratio |\n|---|---|---|---|")
    for name, *view in views[:4]:
        race(
            f"{name}, one / two threads",
            (product, (*view, "1", "avx512")),
            (product, (*view, "2", "avx512")),
        )
    race(
        "100k room, 320x240 / 640x480",
        (product, (*views[4][1:], "1", "avx512")),
        (product, (*views[1][1:], "1", "avx512")),
    )


if __name__ == "__main__":
    main()
