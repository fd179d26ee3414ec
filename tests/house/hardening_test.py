# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Looks for what the linker was asked to do against faults in the finished program.

Usage: hardening_test.py SGS_EXECUTABLE BUILD_TYPE SANITIZERS
"""
import re
import subprocess
import sys

SGS, BUILD_TYPE, SANITIZERS = sys.argv[1:4]
if SANITIZERS or BUILD_TYPE not in ("Release", "RelWithDebInfo"):
    print("sanitized and unoptimised builds are made otherwise")
    sys.exit(77)


def readelf(*arguments):
    return subprocess.run(
        ["readelf", "--wide", *arguments, SGS], check=True, capture_output=True, text=True
    ).stdout


header, segments = readelf("--file-header"), readelf("--program-headers")
dynamic = readelf("--dynamic")
stack = re.search(r"GNU_STACK.*", segments)
promises = {
    "position independent": "DYN" in header and "PIE" in dynamic,
    "relocations are read-only": "GNU_RELRO" in segments,
    "all of them, from the start": re.search(r"FLAGS.*\bNOW\b", dynamic),
    "a stack that is not executed": stack and "RWE" not in stack[0],
}
missing = [name for name, kept in promises.items() if not kept]
print("missing: " + ", ".join(missing) if missing else "everything is there")
sys.exit(1 if missing else 0)
