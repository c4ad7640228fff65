# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the footage's picture is in a clip editor."""

from __future__ import annotations

import gpu

from .. import native, scene_in

SPAN = 16.0  # pictures


def has_place(context) -> bool:
    """Whether a clip is on show whose picture's place Blender tells."""
    clip = getattr(context, "edit_movieclip", None)
    if native.problem() or clip is None:
        return False
    space = context.space_data
    if space.show_stable and clip.tracking.stabilization.use_2d_stabilization:
        return False
    return not scene_in.is_undistorted(space)


def lay_over(view) -> None:
    """From 0 to 1 over the picture to the region's pixels."""
    # Far apart: Blender gives whole pixels
    low, high = (view.view_to_region(at, at, clip=False) for at in (-SPAN, SPAN))
    size = [(high[i] - low[i]) / (2 * SPAN) for i in (0, 1)]
    gpu.matrix.translate([0.5 * (low[i] + high[i]) for i in (0, 1)])
    gpu.matrix.scale(size)
