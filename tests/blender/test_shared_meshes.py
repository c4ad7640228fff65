# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of heads that share a mesh (Alt D), and contact once they are written."""

import bpy
import numpy as np
import pytest
from test_exports import SUFFIXES

pytestmark = pytest.mark.oldest_and_newest

EVERY = (".glb", *SUFFIXES)


@pytest.fixture
def shared(scene, bake, acted):
    """A head whose lips and lids are kept apart, and a child that shares its mesh."""
    face = bake(acted[0], use_contact=True)
    other = face.copy()
    scene.collection.objects.link(other)
    other.parent = face
    bpy.context.view_layer.update()
    return face


def state(extension, face) -> tuple:
    keys = face.data.shape_keys
    named = [(k.name, k.slider_min, k.slider_max, k.mute) for k in keys.key_blocks]
    return named, sorted(c.data_path for c in extension("compat").curves(keys).fcurves)


@pytest.mark.parametrize("suffix", EVERY)
def test_they_are_written_and_stay_as_they_were(extension, scene, shared, tmp_path, suffix):
    before, path = state(extension, shared), tmp_path / f"hero{suffix}"
    extension("scene_out.exports").write(scene, path, shared)
    assert path.stat().st_size > 1000
    assert state(extension, shared) == before
    assert extension("scene_out.contact").still_faces == set()


def test_none_of_them_follows_for_the_while(extension, scene, shared):
    contact = extension("scene_out.contact")
    with extension("scene_out.contact_curves").with_keys(scene, shared) as has_keys:
        assert has_keys
        points = contact.points_of(contact.key_of(shared))
        for frame in range(1, 41, 3):
            scene.frame_set(frame)
            np.testing.assert_array_equal(contact.points_of(contact.key_of(shared)), points)


def test_contact_follows_again_where_no_keys_can_be_made(extension, scene, shared):
    keys = shared.data.shape_keys
    before = state(extension, shared)
    path = keys.key_blocks["contact"].path_from_id("value")
    compat = extension("compat")
    curve = compat.new_curve(compat.curves(keys), path, 0, "Mine")
    made = extension("scene_out.contact_curves").with_keys(scene, shared)
    with pytest.raises(RuntimeError, match="already exists"):
        made.__enter__()
    compat.curves(keys).fcurves.remove(curve)
    assert state(extension, shared) == before
    assert extension("scene_out.contact").still_faces == set()


def test_a_new_file_knows_none_of_them(extension):
    contact = extension("scene_out.contact")
    contact.still_faces.add("Face")
    contact.resting_faces.add("Face")
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    assert contact.still_faces == contact.resting_faces == set()
