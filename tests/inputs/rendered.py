# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""The rendered recording that tests of inputs write in other forms."""
import dataclasses
import subprocess

import numpy as np

import foreign_writers as foreign


def render(sgs, folder, frames):
    """So many frames of a room, 320x240, depth in millimetres. `folder` gets the full pictures."""
    command = [sgs, "synth", "room_desk", folder, "--frames", str(frames), "--quiet"]
    subprocess.run(command, check=True, capture_output=True)
    full = foreign.read_tum(folder)
    return dataclasses.replace(
        full,
        color=[np.ascontiguousarray(c[::2, ::2]) for c in full.color],
        depth=[((d[::2, ::2] + 2) // 5).astype(np.uint16) for d in full.depth],
        depth_scale=1000,
        **{k: getattr(full, k) / 2 for k in ("fx", "fy", "cx", "cy")},
    )
