#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Picture quality over mapping time: the default recipe against the paper's.

quality_curve.py SGS_BINARY INPUT OUT.svg [--steps 0.5,1,2,4] [--paper-steps 0.1,0.25,0.5]

Runs INPUT once per recipe and budget (mapping steps per frame) with the same tracker, prints a table
of seconds spent mapping against PSNR and SSIM (rule gsicp), and draws PSNR over seconds.
"""
import argparse
import json
import pathlib
import subprocess
import tempfile


def run(sgs, sequence, steps, recipe):
    """One run's (mapping seconds, psnr, ssim, gaussians)."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "run"
        command = [
            sgs,
            "run",
            sequence,
            "-o",
            str(out),
            "--quiet",
            "--json",
            "--tracker",
            "spectral",
            "--set",
            f"mapper.iterations_per_frame={steps}",
        ] + recipe
        metrics = json.loads(
            subprocess.run(command, check=True, capture_output=True, text=True).stdout
        )
        stages = json.loads((out / "timings.json").read_text())["map"]["children"]
        seconds = sum(stage["total_ms"] for stage in stages.values()) / 1e3
        return seconds, metrics["psnr_db"], metrics["ssim"], metrics["gaussians"]


def draw(curves, path):
    """A plain line chart: seconds on a logarithmic axis, PSNR on a linear one."""
    import math

    width, height, left, bottom = 560, 340, 56, 44
    points = [p for curve in curves.values() for p in curve]
    x0, x1 = (math.log10(f(p[0] for p in points)) for f in (min, max))
    y0, y1 = math.floor(min(p[1] for p in points)), math.ceil(max(p[1] for p in points))
    place_x = lambda s: left + (width - left - 20) * (math.log10(s) - x0) / max(x1 - x0, 1e-9)
    place_y = lambda v: height - bottom - (height - bottom - 20) * (v - y0) / max(y1 - y0, 1)
    svg = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
        'font-family="sans-serif" font-size="12">',
        f'<rect width="{width}" height="{height}" fill="white"/>',
    ]
    for v in range(y0, y1 + 1):
        svg.append(
            f'<path d="M{left} {place_y(v):.1f}H{width - 20}" stroke="#ddd"/>'
            f'<text x="{left - 8}" y="{place_y(v) + 4:.1f}" text-anchor="end">{v}</text>'
        )
    for curve, colour in zip(curves.items(), ("#1b6ca8", "#c2571a")):
        name, line = curve
        path_d = " ".join(
            f"{'ML'[i > 0]}{place_x(p[0]):.1f} {place_y(p[1]):.1f}" for i, p in enumerate(line)
        )
        svg.append(f'<path d="{path_d}" fill="none" stroke="{colour}" stroke-width="2"/>')
        for p in line:
            x, y = place_x(p[0]), place_y(p[1])
            svg.append(
                f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{colour}"/>'
                f'<text x="{x:.1f}" y="{height - bottom + 16}" text-anchor="middle" '
                f'fill="{colour}">{p[0]:.0f}</text>'
            )
        svg.append(
            f'<text x="{place_x(line[-1][0]) - 6:.1f}" y="{place_y(line[-1][1]) - 8:.1f}" '
            f'text-anchor="end" fill="{colour}">{name}</text>'
        )
    svg.append(
        f'<text x="{width / 2}" y="{height - 8}" text-anchor="middle">'
        "seconds spent mapping</text>"
    )
    svg.append(
        f'<text x="14" y="{height / 2}" transform="rotate(-90 14 {height / 2})" '
        'text-anchor="middle">PSNR, dB</text></svg>'
    )
    pathlib.Path(path).write_text("\n".join(svg) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sgs")
    parser.add_argument("input")
    parser.add_argument("svg")
    parser.add_argument("--steps", default="0.5,1,2,4")
    parser.add_argument("--paper-steps", default="0.1,0.25,0.5")
    arguments = parser.parse_args()
    # The paper's recipe with our tracker's poses, so that only the mapper differs.
    paper = ["--preset", "paper"]
    curves = {}
    print("| recipe | steps per frame | mapping s | PSNR gsicp | SSIM | Gaussians |")
    print("|---|---|---|---|---|---|")
    for name, recipe, budgets in (
        ("default", [], arguments.steps),
        ("paper", paper, arguments.paper_steps),
    ):
        for steps in budgets.split(","):
            row = run(arguments.sgs, arguments.input, steps, recipe)
            curves.setdefault(name, []).append(row)
            print(
                f"| {name} | {steps} | {row[0]:.1f} | {row[1]:.2f} | {row[2]:.3f} | {row[3]} |",
                flush=True,
            )
    draw(curves, arguments.svg)


if __name__ == "__main__":
    main()
