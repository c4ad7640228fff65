# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints what each part of the extension's zip takes in it, and the zip's size without the part."""

from __future__ import annotations

import io
import re
import sys
import zipfile
from collections import Counter
from pathlib import Path

import licences

# Debian's packages by the library that brings them, by the start of their names
BROUGHT_BY = {
    "OpenCV": ("libopencv", "libtbb", "libprotobuf", "libgl", "opencv-data"),
    "CHOLMOD, LAPACK and their Fortran": (
        *("libamd", "libcamd", "libccolamd", "libcholmod", "libcolamd", "libcxsparse"),
        *("libsuitesparse", "libmetis", "libatlas", "libgfortran", "libquadmath", "libgomp"),
    ),
    "OpenSubdiv": ("libosd",),
    "logging for Ceres": ("libgoogle-glog", "libgflags", "libunwind", "liblzma"),
}


def library_part(package: str) -> str:
    parts = (part for part, starts in BROUGHT_BY.items() if package.startswith(starts))
    return next(parts, "other libraries")  # another BLAS, for one


def packages(wheel: zipfile.ZipFile) -> dict[str, str]:
    """The Debian package of each bundled library, by the wheel's own table of licences."""
    table = wheel.read(f"mimetic/{licences.FOLDER}/{licences.TABLE}").decode()
    rows = [line.strip("| ").split(" | ") for line in table.splitlines() if ".so" in line]
    return {file: row[0] for row in rows for file in row[3].split(", ")}


def part_of(name: str, owners: dict[str, str]) -> str:
    """The part that a file of the wheel is of."""
    file = Path(name).name
    if file in owners:
        return library_part(owners[file])
    if module := re.search(r"_core\.cpython-(\d)(\d+)", name):
        return f"the core with Ceres, for Python {module[1]}.{module[2]}"
    if file.endswith(".onnx"):
        return "networks for eyes and lips"
    return "models and data" if "/data/" in name else "the Python package, licences"


def sizes(zip_file: Path) -> Counter[str]:
    """Bytes by part."""
    parts: Counter[str] = Counter()
    with zipfile.ZipFile(zip_file) as archive:
        for member in archive.infolist():
            if "imageio_ffmpeg" in member.filename:
                parts["ffmpeg"] += member.compress_size
            elif member.filename.startswith("wheels/"):
                with zipfile.ZipFile(io.BytesIO(archive.read(member))) as wheel:
                    owners = packages(wheel)
                    for inner in wheel.infolist():
                        parts[part_of(inner.filename, owners)] += inner.compress_size
            else:
                parts["the add-on"] += member.compress_size
    return parts


def main() -> None:
    zip_file = Path(sys.argv[1])
    whole = zip_file.stat().st_size
    print(f"{zip_file.name}: {whole / 1e6:.1f} MB")
    print(f"{'part':46} {'MB':>6} {'without it':>11}")
    for part, size in sizes(zip_file).most_common():
        print(f"{part:46} {size / 1e6:6.1f} {(whole - size) / 1e6:11.1f}")


if __name__ == "__main__":
    main()
