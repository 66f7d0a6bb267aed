#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""make_wheel.py PACKAGE VERSION FOLDER: packs the built package into a wheel in FOLDER, with the shared libraries that
its module needs and that a Python on the same system need not have. Prints the wheel's path."""

import argparse
import base64
import hashlib
import importlib.metadata
import pathlib
import platform
import re
import subprocess
import sysconfig
import zipfile

# Of every system with this C library and compiler's runtime.
OF_THE_SYSTEM = ("libc.so", "libm.so", "libstdc++.so", "libgcc_s.so", "ld-linux", "linux-vdso")


def libraries(module: pathlib.Path) -> dict[str, pathlib.Path]:
    """Name and file of each shared library that the module needs, by whatever way."""
    lines = subprocess.run(["ldd", module], capture_output=True, text=True, check=True).stdout.splitlines()
    words = [line.split() for line in lines]
    return {w[0]: pathlib.Path(w[2]) for w in words if w[1:2] == ["=>"] and not w[0].startswith(OF_THE_SYSTEM)}


def oldest_libc(files: list[pathlib.Path]) -> str:
    """Version of the C library that the files were linked against: the tag of a platform that runs them."""
    versions = set()
    for file in files:
        symbols = subprocess.run(["objdump", "-T", file], capture_output=True, text=True, check=True).stdout
        versions |= {(int(a), int(b)) for a, b in re.findall(r"GLIBC_(\d+)\.(\d+)", symbols)}
    return "_".join(map(str, max(versions)))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("package", metavar="PACKAGE", type=pathlib.Path)
    parser.add_argument("version", metavar="VERSION")
    parser.add_argument("folder", metavar="FOLDER", type=pathlib.Path)
    options = parser.parse_args()
    package, version, folder = options.package, options.version, options.folder
    (module,) = package.glob("_native.*.so")
    contents = {f"sandrunner/{file.name}": file.read_bytes() for file in sorted(package.iterdir()) if file.is_file()}
    needed = libraries(module)
    contents |= {f"sandrunner/lib/{name}": file.read_bytes() for name, file in needed.items()}
    python = f"cp{sysconfig.get_config_var('py_version_nodot')}"
    tag = f"{python}-{python}-manylinux_{oldest_libc([module, *needed.values()])}_{platform.machine()}"
    info = f"sandrunner-{version}.dist-info"
    numpy_major = int(importlib.metadata.version("numpy").split(".")[0])
    contents[f"{info}/METADATA"] = (
        f"Metadata-Version: 2.1\nName: sandrunner\nVersion: {version}\nSummary: Legged robots on sand as numpy arrays\n"
        f"License: BSD-3-Clause\nRequires-Python: >=3.11\nRequires-Dist: numpy<{numpy_major + 1}\n"
    ).encode()
    contents[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: sandrunner\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
    record = ""
    for name, content in contents.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        record += f"{name},sha256={digest},{len(content)}\n"
    contents[f"{info}/RECORD"] = f"{record}{info}/RECORD,,\n".encode()
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"sandrunner-{version}-{tag}.whl"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as wheel:
        for name, content in contents.items():
            entry = zipfile.ZipInfo(name)  # of 1980: the same contents give the same wheel
            entry.external_attr = (0o755 if name.endswith(".so") else 0o644) << 16
            wheel.writestr(entry, content, zipfile.ZIP_DEFLATED)
    print(path)


if __name__ == "__main__":
    main()
