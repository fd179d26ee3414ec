#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Runs recordings and prints the Markdown table of what came out, for docs/results.md.

run_table.py real|live|offline [NAME=]INPUT... [--sgs sgs] [--runs FOLDER]

`real`: each recording by tracking alone (trackers spectral, gicp, orb), by default, and live. `live` and
`offline`: one run each, at the sensor's rate and as fast as it goes. Runs are kept in --runs,
those of a commit made once (remove one to make it again); without it they go away. A run that fails ends it with nothing
printed.
"""
import argparse
import datetime
import json
import pathlib
import subprocess
import sys
import tempfile

ALONE = ["--threads", "1", "--no-eval", "--set", "mapper.iterations_per_frame=0"]
LIVE = ["--realtime", "--preload", "--threads", "2"]


def named(inputs):
    """(name, input) of each."""
    pairs = [text.partition("=") for text in inputs]
    found = [
        (name if eq else pathlib.Path(name).name, source or name) for name, eq, source in pairs
    ]
    if len(dict(found)) < len(found):
        raise ValueError("two inputs have one name: write NAME=INPUT")
    return found


def measured(options, source, name, arguments):
    """metrics.json of `sgs run source arguments`, made once in each folder of runs."""
    folder = pathlib.Path(options.runs) / commit() / name
    if not (folder / "metrics.json").exists():
        command = [options.sgs, "run", source, "-o", folder, "--quiet", *arguments]
        print(" ".join(map(str, command)), file=sys.stderr, flush=True)
        subprocess.run(command, check=True, stdout=sys.stderr)
    return json.loads((folder / "metrics.json").read_text())


def number(metrics, key, factor=1.0, digits=2):
    """A cell: n/a for what was not measured."""
    value = metrics.get(key)
    return "n/a" if value is None else f"{factor * value:.{digits}f}"


def ate_cm(metrics):
    return number(metrics, "ate_rmse_m", 100)


def commit():
    said = subprocess.run(
        ["git", "describe", "--always", "--dirty"],
        cwd=pathlib.Path(__file__).parent,
        capture_output=True,
        text=True,
        check=False,
    )
    return said.stdout.strip() or "no commit"


def heading(command, metrics):
    return f"`{command}`, {commit()}, {metrics['cpu']}, {datetime.date.today()}"


def table(columns, rows):
    """A Markdown table; each row is a list of cells."""
    lines = [["", *columns], ["---"] * (len(columns) + 1), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def real(options):
    columns = [
        "ATE, cm: spectral (as said)",
        "lost",
        "scale, %",
        "RPE of 1 s, cm / degrees",
        "gicp",
        "orb",
    ]
    columns += [
        "PSNR full / held out, dB",
        "live: ATE, cm",
        "live: PSNR full, dB",
        "live: p95, ms",
        "live: dropped, lost",
    ]
    rows = []
    for name, source in named(options.inputs):
        alone, gicp, orb = (
            measured(options, source, f"{name}-{tracker}", [*ALONE, "--tracker", tracker])
            for tracker in ("spectral", "gicp", "orb")
        )
        whole = measured(options, source, f"{name}-default", ["--threads", "1"])
        live = measured(options, source, f"{name}-live", LIVE)
        rows.append(
            [
                name,
                f"**{ate_cm(alone)}** ({number(alone, 'ate_online_rmse_m', 100)})",
                str(alone["frames_lost"]),
                number(alone, "scale_error_percent"),
                f"{number(alone, 'rpe_trans_1s_m', 100)} / {number(alone, 'rpe_rot_1s_deg')}",
                ate_cm(gicp),
                ate_cm(orb),
                f"**{number(whole, 'psnr_db_full', digits=1)}** / {number(whole, 'psnr_db_heldout', digits=1)}",
                ate_cm(live),
                number(live, "psnr_db_full", digits=1),
                number(live, "track_ms_p95", digits=1),
                f"{live['frames_dropped']}, {live['frames_lost']}",
            ]
        )
    return heading("benchmarks/run_table.py real INPUT...", whole) + "\n\n" + table(columns, rows)


def live(options):
    runs = {n: measured(options, s, f"{n}-live", LIVE) for n, s in named(options.inputs)}
    rows = [
        ["frames dropped", *(str(m["frames_dropped"]) for m in runs.values())],
        [
            "mapping steps per frame",
            *(f"{m['mapping_iterations'] / m['frames']:.1f}" for m in runs.values()),
        ],
        ["PSNR gsicp, dB", *(number(m, "psnr_db", digits=1) for m in runs.values())],
        ["PSNR full, dB", *(number(m, "psnr_db_full", digits=1) for m in runs.values())],
        ["tracking, median ms", *(number(m, "track_ms_p50", digits=1) for m in runs.values())],
        ["tracking, p95 ms", *(number(m, "track_ms_p95", digits=1) for m in runs.values())],
        ["ATE, cm", *(ate_cm(m) for m in runs.values())],
    ]
    last = list(runs.values())[-1]
    return heading(f"sgs run SEQUENCE {' '.join(LIVE)}", last) + "\n\n" + table(list(runs), rows)


def offline(options):
    arguments = ["--preload", "--no-eval"]
    runs = {n: measured(options, s, f"{n}-offline", arguments) for n, s in named(options.inputs)}
    rows = [
        ["frames/s", *(number(m, "fps_system", digits=0) for m in runs.values())],
        ["tracking, p95 ms", *(number(m, "track_ms_p95", digits=1) for m in runs.values())],
    ]
    last = list(runs.values())[-1]
    return (
        heading(f"sgs run SEQUENCE {' '.join(arguments)}", last) + "\n\n" + table(list(runs), rows)
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("table", choices=("real", "live", "offline"))
    parser.add_argument("inputs", nargs="+", metavar="INPUT")
    parser.add_argument("--sgs", default="sgs")
    parser.add_argument("--runs", metavar="FOLDER")
    options = parser.parse_args()
    make = {"real": real, "live": live, "offline": offline}[options.table]
    with tempfile.TemporaryDirectory(prefix="sgs-table-") as folder:
        options.runs = options.runs or folder
        try:
            print(make(options))
        except (OSError, ValueError, subprocess.CalledProcessError) as error:
            print(f"run_table.py: {error}", file=sys.stderr)
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
