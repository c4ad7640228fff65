# SPDX-License-Identifier: GPL-3.0-or-later
"""Gives the symbols of a wheel's bundled libraries names of our own.

A host such as Debian's Blender has other versions of the same libraries loaded for all to see, and
the dynamic linker would bind our calls to them: its CHOLMOD is two versions newer and crashes on
our data, and two copies of gflags that meet end the process. A static link is no way out: Debian's
static libraries are not position-independent, or bring an unwinder that breaks exceptions.
"""

from __future__ import annotations

import subprocess
from pathlib import Path

PREFIX = "mimetic_"
# Libraries without versioned symbols: of changing layout, or with tables that must not be shared.
LIBRARIES = (
    *("amd", "camd", "ccolamd", "cholmod", "colamd", "cxsparse", "suitesparseconfig"),
    *("gflags", "glog", "protobuf"),
)


def defined_symbols(library: Path) -> set[str]:
    command = ["nm", "--dynamic", "--defined-only", "--format=posix", str(library)]
    symbols = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    return {line.split()[0] for line in symbols.splitlines()}


def is_isolated(library: Path) -> bool:
    """Whether auditwheel's name for a bundled library, libNAME-HASH.so.VERSION, is of LIBRARIES."""
    return library.name.removeprefix("lib").rpartition("-")[0] in LIBRARIES


def isolate(folder: Path, scratch: Path) -> None:
    """Rename in the libraries of an unpacked wheel and in all of it that calls them."""
    objects = [path for path in folder.rglob("*.so*") if path.is_file()]
    names = {
        name for library in objects if is_isolated(library) for name in defined_symbols(library)
    }
    if not names:
        raise SystemExit(f"extension: {folder.name} bundles none of {', '.join(LIBRARIES)}")
    table = scratch / "renamed"
    table.write_text("".join(f"{name} {PREFIX}{name}\n" for name in sorted(names)))
    for path in objects:
        subprocess.run(["patchelf", "--rename-dynamic-symbols", table, path], check=True)
