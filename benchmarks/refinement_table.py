#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""What refinement gains beside ten times as many mapping steps, on held-out frames and off the path.

refinement_table.py SGS_BINARY FOLDER [--inputs synth:office:kinect,...] [--frames 0:300]
                    [--steps 1500] [--seed 1] [--threads 1] [--set refine.KEY=VALUE ...]

For each input: `sgs run` as it is, `sgs run` with mapper.iterations_per_frame=15 (ten times the
default), and `sgs refine` of the first. Runs are kept in FOLDER and made once; remove a folder there to
make it again. Prints a table of PSNR on held-out frames (no exposure corrected), of views off the path
(synthetic inputs), and of the CPU seconds of mapping or refining, scoring left out.
"""
import argparse
import json
import pathlib
import resource
import subprocess

SCENES = ("room_desk", "corridor", "office", "structure_notexture_near")
LEVELS = ("clean", "kinect", "hard")
TEN_TIMES = ["--set", "mapper.iterations_per_frame=15"]


def made(command, folder, score):
    """Runs `command` unless `folder` is there; then scores it. Returns its metrics and CPU seconds."""
    note = folder.with_suffix(".cpu")
    if not note.exists():
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(
            [*command, "-o", folder, "--no-eval", "--quiet"], check=True, stdout=subprocess.DEVNULL
        )
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([*score, folder], check=True, stdout=subprocess.DEVNULL)
        note.write_text(str(after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime))
    return json.loads((folder / "metrics.json").read_text()), float(note.read_text())


def cell(metrics):
    values = (metrics.get(key) for key in ("psnr_db_heldout", "psnr_db_novel"))
    return " / ".join("-" if v is None else f"{v:.2f}" for v in values)


def gain(after, before):
    differences = []
    for key in ("psnr_db_heldout", "psnr_db_novel"):
        a, b = after.get(key), before.get(key)
        differences.append("-" if a is None or b is None else f"{a - b:+.2f}")
    return " / ".join(differences)


def row(options, source):
    folder = pathlib.Path(options.folder)
    name = pathlib.Path(source).name.replace(":", "-")
    threads = ["--threads", str(options.threads)]
    run = [options.sgs, "run", source, *threads]
    if options.frames:
        run += ["--frames", options.frames]
    if source.startswith("synth:"):
        run += ["--synth-seed", str(options.seed)]
    score = [options.sgs, "eval", "--quiet", *threads]
    start, start_s = made(run, folder / name, score)
    many, many_s = made([*run, *TEN_TIMES], folder / f"{name}-ten", score)
    refine = [options.sgs, "refine", folder / name, "--steps", str(options.steps), *threads]
    for assignment in options.set or []:
        refine += ["--set", assignment]
    refined, refine_s = made(refine, folder / f"{name}-{options.label}", score)
    return (
        f"| {name} | {cell(start)} | {cell(many)} | {cell(refined)} | {gain(refined, many)} "
        f"| {start.get('gaussians', 0) / 1e3:.0f}k, {refined.get('gaussians', 0) / 1e3:.0f}k "
        f"| {start_s:.0f}, {many_s:.0f}, {start_s + refine_s:.0f} |"
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sgs")
    parser.add_argument("folder")
    parser.add_argument("--inputs", help="comma-separated; default: four scenes at three levels")
    parser.add_argument("--frames", default="0:300")
    parser.add_argument("--steps", type=int, default=1500)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--set", action="append", help="refine.KEY=VALUE for the refinement")
    parser.add_argument("--label", default="refined", help="name of the refined runs in FOLDER")
    options = parser.parse_args()
    inputs = (
        options.inputs.split(",")
        if options.inputs
        else [f"synth:{scene}:{level}" for scene in SCENES for level in LEVELS]
    )
    pathlib.Path(options.folder).mkdir(parents=True, exist_ok=True)
    print(f"PSNR in dB, held out / off the path; {options.steps} steps of refinement")
    print(
        "| input | start | ten times the steps | refined | gain over ten times | Gaussians | CPU s |"
    )
    print("|---|---|---|---|---|---|---|")
    for source in inputs:
        print(row(options, source), flush=True)


if __name__ == "__main__":
    main()
