# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes whose strips are open in the NLA (Tab): what buttons do then, and edits made meanwhile."""

import bpy
import numpy as np
import pytest
from last_result import result
from panel_texts import drawn
from test_bake_bound import hero, loaded  # noqa: F401
from test_takes import KINDS, LEFT, edit, other, playing, rows, value  # noqa: F401

pytestmark = pytest.mark.oldest_and_newest

BUTTONS = {
    "play_take": {"take": "hero"},
    "blend_takes": {"take": "hero", "over": "again"},
    "remove_take": {"take": "again"},
    "compare_take": {"take": "hero"},
    "bake": {"use_texture": False, "use_contact": False},
}


def blocks_of(extension, obj) -> list:
    blocks = extension("scene_out").take_list.owners(obj).values()
    return [b for b in blocks if b.animation_data and b.animation_data.nla_tracks]


def open_strips(extension, obj) -> None:
    """As Tab does it in the NLA."""
    for block in blocks_of(extension, obj):
        animation = block.animation_data
        track = animation.nla_tracks[-1]
        animation.nla_tracks.active = track
        track.select = track.strips[0].select = True
        animation.use_tweak_mode = True
        assert animation.use_tweak_mode


def close_strips(obj) -> None:
    """By Tab again, which is where Blender crashed."""
    for block in filter(None, (obj, obj.data.shape_keys, obj.mimetic.control_object)):
        if block.animation_data is not None:
            block.animation_data.use_tweak_mode = False


@pytest.mark.parametrize("to", KINDS)
@pytest.mark.parametrize("name", BUTTONS)
def test_buttons_close_open_strips_and_keep_what_was_edited(
    extension,
    scene,
    bake,
    sheet,
    other,  # noqa: F811
    name,
    to,
):
    face = bake(sheet, to=to)
    bake(other, "again", to=to, use_strips=True)
    bpy.context.view_layer.objects.active = face
    open_strips(extension, face)
    edit(extension, face)
    names = {block.name for block in blocks_of(extension, face)}
    assert names
    assert getattr(bpy.ops.mimetic, name)(**BUTTONS[name]) == {"FINISHED"}
    close_strips(face)
    unedited = 0.5 * sheet.activations[10, 0]
    if name == "compare_take":
        twin = bpy.data.objects[result()["copy"]]
        assert (playing(extension, face), playing(extension, twin)) == ("again", "hero")
        close_strips(twin)
        assert value(scene, twin, 11) == pytest.approx(sheet.activations[10, 0], abs=1e-5)
    if name == "remove_take":
        assert rows(face) == ["hero"]
        assert not blocks_of(extension, face)
        return
    if name == "bake":
        assert playing(extension, face) == "again.002"
        assert value(scene, face, 11) == pytest.approx(unedited, abs=1e-5)
    if name == "blend_takes":
        assert {len(b.animation_data.nla_tracks) for b in blocks_of(extension, face)} == {2}
    if name == "play_take":
        assert value(scene, face, 11) == pytest.approx(sheet.activations[10, 0], abs=1e-5)
    assert extension("scene_out").take_list.is_edited(face.mimetic.takes["again"])
    bpy.context.view_layer.objects.active = face
    assert bpy.ops.mimetic.play_take(take="again") == {"FINISHED"}
    unit = next(r.unit for r in extension("scene_out").face_curves.of(face) if r.shape == LEFT)
    assert value(scene, face, 11) == pytest.approx(unedited + 0.05 / unit, abs=1e-5)


def test_an_action_of_the_users_above_the_strip_is_no_part_of_the_next_take(
    extension,
    scene,
    hero,  # noqa: F811
    loaded,  # noqa: F811
):
    assert bpy.ops.mimetic.bake(use_strips=True) == {"FINISHED"}
    hero.keyframe_insert("scale", frame=1)
    mine = hero.animation_data.action
    open_strips(extension, hero)
    assert bpy.ops.mimetic.bake(use_head_motion=False) == {"FINISHED"}
    assert {part.name for part in hero.mimetic.takes[-1].parts} == {"KEYS"}
    assert hero.animation_data.action == mine


def test_a_head_is_baked_on_while_its_strip_is_open(extension, scene, hero, loaded):  # noqa: F811
    assert bpy.ops.mimetic.bake(use_strips=True) == {"FINISHED"}
    open_strips(extension, hero)
    assert bpy.ops.mimetic.bake_head(target=hero.name) == {"FINISHED"}
    close_strips(hero)
    assert hero.animation_data.action.name.startswith("hero head")
    scene.frame_set(20)
    assert np.isfinite(np.array(hero.matrix_world)).all()


def test_an_expression_is_put_on_a_face_whose_strip_is_open(
    extension,
    scene,
    hero,  # noqa: F811
    loaded,  # noqa: F811
):
    scene.frame_set(1)
    assert bpy.ops.mimetic.bake(use_strips=True, use_head_motion=False) == {"FINISHED"}
    scene.frame_set(12)
    assert bpy.ops.mimetic.keep_expression(name="kept") == {"FINISHED"}
    open_strips(extension, hero)
    assert bpy.ops.mimetic.sequence_expression(action="kept") == {"FINISHED"}
    close_strips(hero)
    animation = hero.data.shape_keys.animation_data
    played = [strip.action for track in animation.nla_tracks for strip in track.strips]
    assert [action.name for action in played] == ["hero muscles", "kept on Hero"]
    assert animation.action is None


@pytest.mark.parametrize("to", KINDS)
def test_why_curves_in_strips_cannot_be_edited_is_said(bake, sheet, to):
    face = bake(sheet, to=to, use_strips=True)
    with pytest.raises(RuntimeError, match=r"curves lie in strips: open one in the NLA first"):
        bpy.ops.mimetic.smooth_curves()
    assert "Curves lie in NLA strips" in drawn("MIMETIC_PT_curves")
    bpy.ops.mimetic.play_take(take="hero")
    assert bpy.ops.mimetic.smooth_curves() == {"FINISHED"}
    assert "strips" not in drawn("MIMETIC_PT_curves")
    bpy.ops.mimetic.remove_take(take="hero")
    assert not face.mimetic.takes
    with pytest.raises(RuntimeError, match="has no curves yet"):
        bpy.ops.mimetic.smooth_curves()
