# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene's camera sees what the footage's camera saw."""

import numpy as np
import pytest
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Vector

PIXELS = 0.1


@pytest.mark.parametrize(
    ("resolution", "aspect"),
    [((400, 300), 1.0), ((1920, 1080), 1.0), ((600, 800), 1.0), ((720, 576), 16 / 15)],
    ids=["as the footage", "wider", "taller", "pixels not square"],
)
def test_projection_is_the_footages(extension, scene, performance, resolution, aspect):
    scene.render.resolution_x, scene.render.resolution_y = resolution
    scene.render.pixel_aspect_x = aspect
    scene.render.fps = 25
    extension("scene_out").bake(scene, performance, "take")
    face, camera = scene.mimetic.face, scene.camera
    width, height = performance.image_size
    # The footage fitted whole into the picture: the part of the picture that it covers
    wide = resolution[0] * aspect / resolution[1]
    covered = np.array([min(1, width / height / wide), min(1, wide / (width / height))])
    for i in (0, 13, 30):
        scene.frame_set(int(performance.frame[i]))
        pixels = performance.project(performance.surface_in_camera(i))
        surface = performance.surface(i)
        for vertex in range(0, len(pixels), 500):
            x, y, z = surface[vertex]
            at = face.matrix_world @ Vector((x, -z, y))
            u, v, depth = world_to_camera_view(scene, camera, at)
            part = (np.array([u, 1 - v]) - 0.5) / covered + 0.5
            pixel = part * (width, height) - 0.5
            assert depth > 0
            assert np.abs(pixel - pixels[vertex]).max() < PIXELS


def test_a_near_face_is_not_cut_by_the_camera(extension, scene, performance):
    extension("scene_out").bake(scene, performance, "take")
    assert scene.camera.data.clip_start <= 0.01
