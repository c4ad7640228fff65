# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames of a clip, and of what plays it, side by side."""

from __future__ import annotations

from pathlib import Path

import numpy as np

PICTURE = 320  # pixels, the height of a frame


def spread(frames: np.ndarray, count: int) -> list[int]:
    """Some of a performance's frames, evenly."""
    return [int(f) for f in frames[np.linspace(0, len(frames) - 1, count + 2)[1:-1].astype(int)]]


def clip_row(footage: Path, frames: list[int]) -> np.ndarray:
    """PICTURE x (PICTURE times frames) x 3."""
    from mimetic.media.footage import Footage

    clip = Footage(footage)
    return np.hstack([_square(clip.read(frame)) for frame in frames])


def character_row(scene, frames: list[int], folder: Path) -> np.ndarray:
    """The same of the scene's camera, by Workbench. folder: for files of the while."""
    import bpy

    scene.render.engine = "BLENDER_WORKBENCH"
    scene.render.resolution_x = scene.render.resolution_y = PICTURE
    scene.display.shading.light = "STUDIO"
    scene.display.shading.color_type = "TEXTURE"
    scene.display.shading.show_cavity = True
    scene.display.render_aa = "8"
    columns = []
    for frame in frames:
        scene.frame_set(frame)
        scene.render.filepath = str(folder / "frame.png")
        bpy.ops.render.render(write_still=True)
        picture = bpy.data.images.load(scene.render.filepath)
        pixels = np.array(picture.pixels).reshape(PICTURE, PICTURE, -1)[::-1, :, :3]
        bpy.data.images.remove(picture)
        columns.append(np.round(255 * pixels).astype(np.uint8))
    return np.hstack(columns)


def _square(picture: np.ndarray) -> np.ndarray:
    """The middle of a picture, PICTURE pixels wide and high."""
    height, width = picture.shape[:2]
    side = min(height, width)
    steps = np.arange(PICTURE) * side // PICTURE
    return picture[(height - side) // 2 + steps][:, (width - side) // 2 + steps]
