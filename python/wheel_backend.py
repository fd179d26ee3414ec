# SPDX-FileCopyrightText: The Spectral GS-SLAM authors
# SPDX-License-Identifier: Apache-2.0
"""What `pip install .` calls (PEP 517): builds with CMake, packs the package and libsgs into a wheel.

It needs nothing but CMake and a compiler, so it works without a network; Debian 12 has no backend
for CMake that does. Build folder: --config-settings build-dir=DIR, by default build/release, which is
used again where it is configured already.
"""
import base64
import hashlib
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
COMPONENTS = ("python3-sgs", "libsgs0")


def version():
    text = (ROOT / "CMakeLists.txt").read_text()
    return re.search(r"project\(\w+ VERSION ([0-9.]+)", text).group(1)


def tag():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"


def metadata():
    return (
        f"Metadata-Version: 2.1\nName: sgs\nVersion: {version()}\n"
        "Summary: RGB-D SLAM that builds a 3D Gaussian map on CPUs\n"
        "License: Apache-2.0\nRequires-Python: >=3.9\nRequires-Dist: numpy\n"
    )


def cmake(*arguments):
    command = ["cmake", *(str(a) for a in arguments)]
    try:
        subprocess.run(command, check=True, cwd=ROOT)
    except FileNotFoundError:
        sys.exit("cmake is missing: scripts/install_packages.sh installs what a build needs")
    except subprocess.CalledProcessError as error:
        sys.exit(f"{' '.join(command)}: exit {error.returncode}")


def is_made_for_this_python(folder):
    """Whether a build folder is configured, with the bindings for the Python that runs this."""
    suffix = sysconfig.get_config_var("EXT_SUFFIX")
    rules = folder / "build.ninja"
    return rules.exists() and f"_sgs{suffix}" in rules.read_text()


def built_files(folder, staging):
    """Path in the wheel -> file, after a build."""
    if not is_made_for_this_python(folder):
        python = f"-DPython_EXECUTABLE={sys.executable}"
        cmake("--preset", "release", "-B", folder, "-DSGS_BUILD_TESTS=OFF", python)
    cmake("--build", folder, "--target", "sgs_python")
    for component in COMPONENTS:
        cmake("--install", folder, "--prefix", staging, "--component", component)
    files = {f"sgs/{p.name}": p for p in staging.glob("lib/python3/dist-packages/sgs/*")}
    # Beside the module, where its run path looks first; a wheel knows no links.
    (library,) = (p for p in staging.rglob("libsgs.so.*.*.*"))
    files["sgs/libsgs.so.0"] = library
    return files


def record_line(name, data):
    digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
    return f"{name},sha256={digest},{len(data)}\n"


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    folder = pathlib.Path((config_settings or {}).get("build-dir", ROOT / "build" / "release"))
    name = f"sgs-{version()}-{tag()}.whl"
    info = f"sgs-{version()}.dist-info"
    staging = pathlib.Path(tempfile.mkdtemp(prefix="sgs-wheel-"))
    try:
        files = {n: p.read_bytes() for n, p in built_files(folder.resolve(), staging).items()}
    finally:
        shutil.rmtree(staging)
    files[f"{info}/METADATA"] = metadata().encode()
    wheel = f"Wheel-Version: 1.0\nGenerator: sgs\nRoot-Is-Purelib: false\nTag: {tag()}\n"
    files[f"{info}/WHEEL"] = wheel.encode()
    record = "".join(record_line(n, data) for n, data in files.items())
    files[f"{info}/RECORD"] = (record + f"{info}/RECORD,,\n").encode()
    with zipfile.ZipFile(pathlib.Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as out:
        for path, data in files.items():
            out.writestr(path, data)
    return name


def build_sdist(sdist_directory, config_settings=None):
    sys.exit("there is no source package: install from a checkout (pip install .)")
