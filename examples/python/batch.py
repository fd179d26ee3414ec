# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Runs several inputs one after the other and prints a table of their scores.

    batch.py OUTPUT_FOLDER INPUT...

What fails is said and left out; Ctrl-C ends the batch with the folders so far complete.
"""
import pathlib
import sys

import sgs

COLUMNS = ["ate_rmse_m", "psnr_db", "gaussians", "fps_system"]


def main(output: str, inputs: list[str]) -> int:
    failed = 0
    print("input", *COLUMNS, sep="\t")
    for number, source in enumerate(inputs):
        name = f"{number:03}-{pathlib.Path(source).name.replace(':', '-')}"
        try:
            summary = sgs.run(source, output=pathlib.Path(output) / name)
        except sgs.Error as error:
            print(f"{source}: {error}", file=sys.stderr)
            failed += 1
            continue
        values = [summary.metrics[key] for key in COLUMNS]
        cells = [f"{v:.4g}" if isinstance(v, float) else str(v) for v in values]
        print(source, *cells, sep="\t", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1], sys.argv[2:]))
