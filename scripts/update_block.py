#!/usr/bin/env python3
# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Replaces what a tool wrote in a page: COMMAND | scripts/update_block.py PAGE NAME

The text on the standard input becomes the content of the block between "<!-- begin NAME ... -->" and
"<!-- end NAME -->" of PAGE; the markers stay.
"""
import pathlib
import re
import sys


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    page, name = pathlib.Path(sys.argv[1]), sys.argv[2]
    content = sys.stdin.read().strip("\n")
    if not content:
        sys.exit(f"nothing to write into block {name}")
    text = page.read_text()
    begin, end = rf"<!-- begin {re.escape(name)}\b[^\n]*-->\n", f"<!-- end {re.escape(name)} -->"
    block = re.compile(f"({begin}).*?({end})", re.S)
    if len(block.findall(text)) != 1:
        sys.exit(f"{page} has no block {name}")
    page.write_text(block.sub(lambda m: f"{m.group(1)}{content}\n{m.group(2)}", text))


if __name__ == "__main__":
    main()
