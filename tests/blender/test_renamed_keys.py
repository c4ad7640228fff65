# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes play on shape keys that were renamed since, and a name alone is no edit of theirs."""

import dataclasses
import hashlib
import itertools

import bpy
import numpy as np
import pytest
from last_result import result
from test_takes import edit, playing, rows, value

pytestmark = pytest.mark.oldest_and_newest

OLD, NEW, NEWER = "muscle_00.L", 'Nose "mine"', "Nose"


@pytest.fixture
def weak(sheet):
    return dataclasses.replace(sheet, activations=0.5 * sheet.activations)


@pytest.fixture
def face(bake, sheet, weak):
    """Its take `again`, which is weak, plays; `hero` waits."""
    face = bake(sheet)
    bake(weak, "again")
    return face


def rename(face, old: str, new: str) -> None:
    face.data.shape_keys.key_blocks[old].name = new


def check(scene, face, sheet, name: str, share: float = 1.0) -> None:
    for frame in (3, 20, 33):
        expected = share * sheet.activations[frame - 1, 0]
        assert value(scene, face, frame, name) == pytest.approx(expected, abs=1e-5)


def test_a_take_that_waited_plays_the_renamed_key(scene, face, sheet):
    rename(face, OLD, NEW)
    check(scene, face, sheet, NEW, 0.5)
    for name, share in (("hero", 1.0), ("again", 0.5)):
        assert bpy.ops.mimetic.play_take(take=name) == {"FINISHED"}
        assert result()["message"] == f"{name} plays on Face"
        check(scene, face, sheet, NEW, share)


def test_a_take_plays_a_key_that_was_renamed_again_and_again(scene, face, sheet):
    """Each take has the name of when it played last."""
    names = [OLD, "Nose 1", "Nose 2", "Nose 3", "Nose 4"]
    for (old, new), take in zip(itertools.pairwise(names), ("hero", "again") * 2, strict=True):
        rename(face, old, new)
        bpy.ops.mimetic.play_take(take=take)
        check(scene, face, sheet, new, 1.0 if take == "hero" else 0.5)


@pytest.mark.parametrize("is_reset", [False, True])
def test_a_take_plays_a_key_that_was_renamed_between_bakes(
    scene, bake, face, sheet, weak, is_reset
):
    rename(face, OLD, NEW)
    bake(weak, "third", reset_hand_changes=is_reset)
    name = OLD if is_reset else NEW
    assert name in face.data.shape_keys.key_blocks
    for newer in (name, NEWER):
        if newer != name:
            rename(face, name, newer)
        for take, share in (("hero", 1.0), ("again", 0.5), ("third", 0.5)):
            bpy.ops.mimetic.play_take(take=take)
            check(scene, face, sheet, newer, share)


def test_renamed_keys_are_blended_and_compared(scene, face, sheet):
    rename(face, OLD, NEW)
    bpy.ops.mimetic.compare_take(take="hero")
    twin = bpy.data.objects[result()["copy"]]
    check(scene, twin, sheet, NEW)
    check(scene, face, sheet, NEW, 0.5)
    bpy.data.objects.remove(twin)
    rename(face, NEW, NEWER)
    bpy.ops.mimetic.blend_takes(take="hero", influence=0.5)
    check(scene, face, sheet, NEWER, 0.75)


def test_contact_of_a_take_plays_though_its_key_was_renamed(scene, bake, performance):
    face = bake(performance, use_contact=True)
    name = next(entry.name for entry in face.mimetic.shapes if entry.group == "Contact")
    before = [value(scene, face, frame, name) for frame in range(1, 41)]
    assert np.ptp(before) > 0.01
    rename(face, name, "Lips")
    bpy.ops.mimetic.play_take(take="hero")
    after = [value(scene, face, frame, "Lips") for frame in range(1, 41)]
    np.testing.assert_allclose(after, before, atol=1e-6)


def test_arkits_shapes_of_a_head_are_followed(extension, scene, face):
    """They are remembered beside those of the muscles."""
    entry = face.mimetic.units.add()
    entry.name, entry.shape = "jawOpen", "jawOpen"
    key = face.shape_key_add(name="jawOpen", from_mix=False)
    key.points[100].co.z += 0.1
    by_hand = extension("scene_out.by_hand")
    by_hand.remember_places(face)
    key.name = "Kiefer"
    assert by_hand.all_keys_now(face)["jawOpen"] == "Kiefer"
    assert by_hand.shapes_by_name(face)["Kiefer"] == "jawOpen"
    by_hand.remember_names(face)
    key.name = "Mund"
    assert by_hand.shapes_by_name(face)["Kiefer"] == "jawOpen"


def test_a_key_that_is_gone_is_told(face):
    keys = face.data.shape_keys.key_blocks
    for name in ("muscle_01.L", "jaw_side"):
        face.shape_key_remove(keys[name])
    told = "Face has no shape key muscle_01.L, jaw_side any more, which hero moves"
    bpy.ops.mimetic.play_take(take="hero")
    assert told in result()["message"] and "bake the take again" in result()["message"]
    bpy.ops.mimetic.compare_take(take="hero")
    assert told.replace("Face", "Face hero", 1) in result()["message"]
    bpy.ops.mimetic.blend_takes(take="again", over="hero")
    assert told in result()["message"] and "which again moves" in result()["message"]


def test_a_name_alone_is_no_edit(extension, scene, bake, face, sheet):
    rename(face, OLD, NEW)
    takes = extension("scene_out").take_list
    for name in ("hero", "again"):
        assert not takes.is_edited(face.mimetic.takes[name])
    bake(sheet, "third", replace_take=True)
    assert rows(face) == ["hero", "third"]
    assert playing(extension, face) == "third" and "again is replaced" in result()["message"]
    check(scene, face, sheet, NEW)
    rename(face, NEW, NEWER)
    assert not any(takes.is_edited(row) for row in face.mimetic.takes)
    bpy.ops.mimetic.play_take(take="hero")
    assert not any(takes.is_edited(row) for row in face.mimetic.takes)
    edit(extension, face)
    assert takes.is_edited(face.mimetic.takes["hero"])


def test_a_take_of_before_has_the_same_mark(extension, face):
    """Files of earlier versions have marks by the paths of curves, which have the shapes' names."""
    compat, key_table = extension("compat"), extension("scene_out.key_table")
    row, digest = face.mimetic.takes["hero"], hashlib.sha256()
    for part in row.parts:
        curves = compat.curves_of(part.action, part.slot_now)
        for curve in sorted(curves, key=lambda curve: (curve.data_path, curve.array_index)):
            digest.update(f"{part.name} {curve.data_path} {curve.array_index}".encode())
            digest.update(key_table.mark(curve))
    assert digest.hexdigest() == row.mark
