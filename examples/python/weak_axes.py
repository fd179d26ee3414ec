# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Draws which directions geometry did not see, frame by frame, as an SVG picture.

    weak_axes.py INPUT OUT.svg [FRAMES]

Each frame is a column of six cells: x y z of rotation (top) and of translation (bottom) in the camera's
axes; the darker, the more the weak directions of that frame have of it.
"""
import sys

import numpy as np

import sgs

CELL = 6
NAMES = ["turn x", "turn y", "turn z", "move x", "move y", "move z"]


def weakness(result: sgs.FrameResult) -> "np.ndarray[tuple[int], np.dtype[np.float64]]":
    """How much each axis of the camera takes part in the weak directions: 0 .. 1."""
    total = np.zeros(6)
    for weak in result.weak_directions(threshold=0.0):
        total += weak.weight * weak.twist**2
    return np.minimum(total, 1.0)


def main(source: str, picture: str, frames: str = "") -> None:
    recording = sgs.open(source, frames=frames or None)
    columns = []
    with sgs.Session(recording.camera) as session:
        for frame in recording:
            result = session.feed(frame)
            columns.append(weakness(result))
            print(f"{result.time:.3f} {result.status}", *(f"{w:.2f}" for w in columns[-1]))
    cells = [
        f'<rect x="{60 + CELL * i}" y="{CELL * 3 * k}" width="{CELL}" height="{CELL * 3}"'
        f' fill="rgb(200,30,30)" fill-opacity="{weight:.3f}"/>'
        for i, column in enumerate(columns)
        for k, weight in enumerate(column)
    ]
    names = [
        f'<text x="2" y="{CELL * 3 * k + 13}" font-size="11" font-family="sans-serif">{name}</text>'
        for k, name in enumerate(NAMES)
    ]
    with open(picture, "w", encoding="utf-8") as file:
        file.write(
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{60 + CELL * len(columns)}"'
            f' height="{CELL * 18}">\n' + "\n".join(names + cells) + "\n</svg>\n"
        )


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    main(*sys.argv[1:])
