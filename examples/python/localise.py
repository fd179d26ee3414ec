# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Where the camera of a recording was, in the map of an earlier run (docs/maps.md).

    localise.py MAP INPUT OUTPUT_FOLDER

Prints time and position, in the world of the map, of every frame that has found itself there.
"""
import sys

import sgs


def main(earlier: str, source: str, output: str) -> int:
    summary = sgs.run(source, output=output, pictures=False, map=earlier)
    if summary.lost:
        print("the camera has not found itself, or was lost at last", file=sys.stderr)
    found = sgs.Trajectory.load(f"{summary.folder}/trajectory.txt")
    for time, pose in zip(found.times, found.poses):
        print(f"{time:.3f}", *(f"{x:.3f}" for x in pose[:3, 3]), sep="\t")
    return 1 if summary.lost else 0


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
