# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh from a file, .obj, .ply, .glb or .gltf, and landmarks from a JSON file. Files are not
trusted."""

from __future__ import annotations

from pathlib import Path

from mimetic import InvalidInput
from mimetic.shared.json_file import read_json
from mimetic.shared.shown_text import shortened

MAX_LANDMARK_BYTES = 1_000_000
LONGEST_LINE = 65_536  # characters, of an .obj


def read_landmarks(path: Path) -> dict[str, int | list[float]]:
    """JSON object: name -> index of a vertex (from 0) or [x, y, z] in the mesh's unit."""
    document = read_json(path, "a file of landmarks", MAX_LANDMARK_BYTES)
    if not isinstance(document, dict):
        raise InvalidInput(f'{path}: needed is {{"nose_tip": 123, "chin": [x, y, z], ...}}')
    for name, value in document.items():
        is_point = isinstance(value, list) and len(value) == 3 and all(map(_is_number, value))
        if not is_point and not (isinstance(value, int) and not isinstance(value, bool)):
            what = shortened(f"landmark {name} is {value!r}")
            raise InvalidInput(f"{path}: {what}, needed is a vertex's index or [x, y, z]")
    return document


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e9
