# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Looks for what compiler and linker were asked to do against faults in the finished program.

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
symbols = readelf("--dyn-syms")
stack = re.search(r"GNU_STACK.*", segments)
promises = {
    "position independent": "DYN" in header and "PIE" in dynamic,
    "relocations are read-only": "GNU_RELRO" in segments,
    "all of them, from the start": re.search(r"FLAGS.*\bNOW\b", dynamic),
    "a stack that is not executed": stack and "RWE" not in stack[0],
    "canaries on the stack": "__stack_chk_fail" in symbols,
    "calls of libc that know the size of their buffer": re.search(
        r"__(mem|read)\w*_chk\b", symbols
    ),
}
missing = [name for name, kept in promises.items() if not kept]
print("missing: " + ", ".join(missing) if missing else "everything is there")
sys.exit(1 if missing else 0)
