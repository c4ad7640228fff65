# SPDX-License-Identifier: GPL-3.0-or-later
"""The camera's picture and plots of what the face does, in a corner of the 3D view while a live
session runs."""

from __future__ import annotations

import blf
import bpy
import gpu
from gpu_extras.batch import batch_for_shader

from .. import native
from . import text

MARGIN = 12  # pixels at a UI scale of 1, as all below
ROW_HEIGHT = 26  # of a plot
TEXT_SIZE = 10
GROUND = (0.05, 0.06, 0.07, 0.72)  # behind the plots
BESIDE = {"TOOLS": 0, "UI": 1, "HEADER": 2, "TOOL_HEADER": 2, "ASSET_SHELF": 3}


class SessionView:
    """Drawn over all 3D views from its making until it is closed; nothing is left of it then."""

    def __init__(self, thread) -> None:
        self._thread = thread
        self._shown = self._texture = None  # a picture of the thread's, and what is drawn of it
        space = bpy.types.SpaceView3D
        self._handle = space.draw_handler_add(self._draw, (), "WINDOW", "POST_PIXEL")

    def close(self) -> None:
        if self._handle is not None:
            bpy.types.SpaceView3D.draw_handler_remove(self._handle, "WINDOW")
        self._handle = self._shown = self._texture = None

    def has_news(self, settings) -> bool:
        """Whether a picture has come that is to be drawn and is not yet."""
        if not (settings.show_picture or settings.show_plots):
            return False
        picture = self._thread.picture
        return picture is not None and picture is not self._shown

    def _draw(self) -> None:
        context = bpy.context
        settings = context.scene.mimetic.live
        picture, trace = self._thread.picture, self._thread.trace
        if not (settings.show_picture or settings.show_plots):
            return
        scale = context.preferences.system.ui_scale
        width = settings.view_size * scale
        parts = []
        if settings.show_plots and trace is not None:
            height = trace.num_rows * ROW_HEIGHT * scale
            parts.append((height, lambda *box: _draw_plots(trace, scale, *box)))
        if settings.show_picture and picture is not None:
            texture = self._texture_of(picture, round(width))
            height = width * texture.height / texture.width
            parts.append((height, lambda *box: _draw_picture(texture, *box)))
        self._shown = picture
        left, bottom = corner(context, settings.view_corner, width, sum(p[0] for p in parts), scale)
        gpu.state.blend_set("ALPHA")
        try:
            for height, draw in parts:
                draw(left, bottom, width, height)
                bottom += height
        finally:
            gpu.state.line_width_set(1.0)
            gpu.state.blend_set("NONE")

    def _texture_of(self, picture, width: int):
        if picture is not self._shown or self._texture is None:
            texels = native.picture().texels(picture.image, width)
            rows, columns, _ = texels.shape
            content = gpu.types.Buffer("FLOAT", texels.size, texels.reshape(-1))
            self._texture = gpu.types.GPUTexture((columns, rows), format="RGBA16F", data=content)
        return self._texture


def redraw() -> None:
    """The 3D views' own pictures alone: headers and sidebars take as long to draw."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                for region in area.regions:
                    if region.type == "WINDOW":
                        region.tag_redraw()


def corner(context, name: str, width: float, height: float, scale: float) -> tuple[float, float]:
    """Left and bottom of a box in a corner of what headers, tools and sidebar leave free."""
    region = context.region
    free = [MARGIN * scale] * 4  # at the left, right, top and bottom
    for other in context.area.regions:
        side = BESIDE.get(other.type)
        is_over = other.x < region.x + region.width and other.x + other.width > region.x
        is_over &= other.y < region.y + region.height and other.y + other.height > region.y
        if side is None or not is_over or min(other.width, other.height) <= 1:
            continue
        if other.alignment == "BOTTOM":
            side = 3
        free[side] += other.width if side < 2 else other.height
    left, right, top, bottom = free
    return (
        left if name.endswith("LEFT") else max(left, region.width - right - width),
        bottom if name.startswith("BOTTOM") else max(bottom, region.height - top - height),
    )


def _box(left: float, bottom: float, width: float, height: float) -> list[tuple[float, float]]:
    return [
        (left, bottom),
        (left + width, bottom),
        (left + width, bottom + height),
        (left, bottom + height),
    ]


def _draw_picture(texture, *box: float) -> None:
    shader = gpu.shader.from_builtin("IMAGE")
    content = {"pos": _box(*box), "texCoord": _box(0, 0, 1, 1)}
    batch = batch_for_shader(shader, "TRI_FAN", content)
    shader.uniform_sampler("image", texture)
    batch.draw(shader)


def _draw_plots(trace, scale: float, left: float, bottom: float, width: float, height: float):
    ground = gpu.shader.from_builtin("UNIFORM_COLOR")
    ground.uniform_float("color", GROUND)
    batch_for_shader(ground, "TRI_FAN", {"pos": _box(left, bottom, width, height)}).draw(ground)
    inset = 0.5 * MARGIN * scale
    plots = trace.draw(left + inset, bottom + inset, width - 2 * inset, height - inset)
    if len(plots.points):
        shader = gpu.shader.from_builtin("SMOOTH_COLOR")
        gpu.state.line_width_set(max(1.0, scale))
        content = {"pos": plots.points, "color": plots.colours}
        batch_for_shader(shader, "LINES", content).draw(shader)
    with text.style(scale):
        blf.size(0, TEXT_SIZE * scale)
        for label in plots.labels:
            blf.color(0, *label.colour)
            text.write(label.text, *label.place)
