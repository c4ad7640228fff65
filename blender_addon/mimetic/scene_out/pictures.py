# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of materials as files of distinct names, for exporters that copy files by their names
alone: pictures that were made or packed here have none."""

from __future__ import annotations

import shutil
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

import bpy
import numpy as np

TILE = "<UDIM>"  # stands in a tiled picture's name for the number of each tile


@contextmanager
def as_files(objects: Iterable[bpy.types.Object], folder: Path) -> Iterator[None]:
    """While it lasts, the objects' materials have copies of their pictures that are files of a
    folder, which is made if there are any; a picture whose file is gone stays as it is."""
    copies: dict[bpy.types.Image, bpy.types.Image] = {}
    replaced, names = [], set()
    try:
        for node in _nodes(objects):
            image = node.image
            if image not in copies:
                path = folder / _name(image, names)
                if not _write(image, path):
                    continue
                names.add(path.name.lower())
                copies[image] = _of_file(image, path)
            replaced.append((node, image))
            node.image = copies[image]
        yield
    finally:
        for node, image in replaced:
            node.image = image
        bpy.data.batch_remove(list(copies.values()))


def _nodes(objects: Iterable[bpy.types.Object]) -> list[bpy.types.Node]:
    """Of the objects' materials, those with a picture."""
    trees = [
        slot.material.node_tree
        for obj in objects
        for slot in obj.material_slots
        if slot.material is not None and slot.material.node_tree is not None
    ]
    found, seen = [], set()
    for tree in trees:  # which grows by those of groups
        if tree in seen:
            continue
        seen.add(tree)
        trees += [node.node_tree for node in tree.nodes if node.type == "GROUP" and node.node_tree]
        found += [node for node in tree.nodes if node.type == "TEX_IMAGE" and node.image]
    return found


def _of_file(image: bpy.types.Image, path: Path) -> bpy.types.Image:
    """A copy of an image, with its colour space, of a file: exporters write one that is packed or
    painted where they like."""
    of_file = image.copy()
    if of_file.packed_file is not None:
        of_file.unpack(method="REMOVE")
    if of_file.source == "GENERATED":
        of_file.source = "FILE"
    of_file.filepath_raw = str(path)
    of_file.reload()
    return of_file


def _name(image: bpy.types.Image, taken: set[str]) -> str:
    """That of its file, else its own, with a number where another picture has it."""
    file = bpy.path.basename(image.filepath)
    if not file:
        file = bpy.path.clean_name(image.name) + (".exr" if image.is_float else ".png")
    name, number = file, 1
    while name.lower() in taken:
        number += 1
        name = f"{Path(file).stem}-{number}{Path(file).suffix}"
    return name


def _write(image: bpy.types.Image, path: Path) -> bool:
    """Writes what an image shows; whether there was anything."""
    files = [] if image.is_dirty and image.source != "TILED" else _files(image)
    if not files and not any(image.size):
        return False
    path.parent.mkdir(exist_ok=True)
    for tile, file in files:
        target = Path(str(path).replace(TILE, tile))
        if isinstance(file, bytes):
            target.write_bytes(file)
        else:
            shutil.copyfile(file, target)
    if not files:
        _draw(image, path)
    return True


def _files(image: bpy.types.Image) -> list[tuple[str, bytes | Path]]:
    """What is packed in an image, or its files, by the number of a tile where it has tiles."""
    if image.packed_file is not None:
        return [(str(file.tile_number), file.packed_file.data) for file in image.packed_files]
    numbers = [str(tile.number) for tile in image.tiles] if image.source == "TILED" else [""]
    path = bpy.path.abspath(image.filepath, library=image.library)
    paths = [(number, Path(path.replace(TILE, number))) for number in numbers]
    return [(number, file) for number, file in paths if file.is_file()]


def _draw(image: bpy.types.Image, path: Path) -> None:
    """Writes an image's pixels by an image of their own: saving would give this one the path."""
    values = np.empty(len(image.pixels), dtype=np.float32)
    image.pixels.foreach_get(values)
    drawn = bpy.data.images.new(image.name, *image.size, alpha=True, float_buffer=image.is_float)
    try:
        drawn.pixels.foreach_set(values)
        drawn.file_format = "OPEN_EXR" if image.is_float else "PNG"
        drawn.filepath_raw = str(path)
        drawn.save()
    finally:
        bpy.data.images.remove(drawn)
