# SPDX-License-Identifier: GPL-3.0-or-later
"""Glasses go with the head and not with its skin, unless they are asked for; lashes follow it."""

import bpy
import numpy as np
import pytest
from last_result import result
from test_attach_muscles import evaluated
from test_head_parts import NAMES, _piece, rows, split  # noqa: F401

pytestmark = pytest.mark.newest

RIM, TUBE, BEFORE = 2.4, 0.15, 2.4  # cm: of a lens, of its frame, before the eyeball's middle


def ring(centre, radius: float, tube: float) -> tuple[np.ndarray, list]:
    """A torus in the plane of x and z."""
    around, across = np.meshgrid(np.arange(24) / 24, np.arange(8) / 8, indexing="ij")
    around, across = 2 * np.pi * around.ravel(), 2 * np.pi * across.ravel()
    reach = radius + tube * np.cos(across)
    points = np.c_[reach * np.cos(around), tube * np.sin(across), reach * np.sin(around)]
    faces = [
        [8 * i + j, 8 * ((i + 1) % 24) + j, 8 * ((i + 1) % 24) + (j + 1) % 8, 8 * i + (j + 1) % 8]
        for i in range(24)
        for j in range(8)
    ]
    return points + centre, faces


def bar(start, end, width: float) -> tuple[np.ndarray, list]:
    """A square bar of ten pieces along x."""
    along = np.linspace(start, end, 11)
    corners = width * np.array([(0, 1, 1), (0, 1, -1), (0, -1, -1), (0, -1, 1)])
    points = (along[:, None] + corners[None]).reshape(-1, 3)
    faces = [
        [4 * i + j, 4 * i + (j + 1) % 4, 4 * i + 4 + (j + 1) % 4, 4 * i + 4 + j]
        for i in range(10)
        for j in range(4)
    ]
    return points, faces


def joined(pieces) -> tuple[np.ndarray, list]:
    points, faces, first = [], [], 0
    for own, own_faces in pieces:
        points.append(own)
        faces += [[first + vertex for vertex in face] for face in own_faces]
        first += len(own)
    return np.concatenate(points), faces


def wear(head, name: str, points, faces) -> bpy.types.Object:
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points, [], faces)
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    obj.parent = head
    bpy.context.view_layer.update()
    return obj


@pytest.fixture
def glasses(parts, split, rows):  # noqa: F811
    """Rims and a bridge, in the head's own frame, centimetres: it looks along -y, z is up."""
    points, pieces = parts[0], []
    for name in ("eye.L", "eye.R"):
        centre = points[rows[name]].mean(axis=0)
        pieces.append(ring(centre - (0, BEFORE, 0), RIM, TUBE))
    inner = [points[rows[n]].mean(axis=0) - (0, BEFORE, 0) for n in ("eye.L", "eye.R")]
    pieces.append(bar(inner[0] - (RIM, 0, 0), inner[1] + (RIM, 0, 0), 0.15))
    return wear(split, "glasses", *joined(pieces))


def test_glasses_stay_as_they_are_and_are_named(glasses, split):  # noqa: F811
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    assert result()["worn"] == ["glasses"]
    assert sorted(result()["parts"]) == ["eye.L", "eye.R", "teeth_lower", "tongue"]
    assert "glasses left as worn" in result()["message"]
    assert result()["notes"] == []
    assert glasses.data.shape_keys is None
    assert bpy.ops.mimetic.add_arkit_shapes() == {"FINISHED"}
    assert glasses.data.shape_keys is None
    glasses.parent = None
    glasses.matrix_world = split.matrix_world
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    assert any("glasses does not go where Bust goes" in note for note in result()["notes"])


def test_glasses_are_taken_along_on_request_and_left_again(glasses, split):  # noqa: F811
    rest = evaluated(glasses).copy()
    assert bpy.ops.mimetic.attach_muscles(others="ALL") == {"FINISHED"}
    assert "glasses" in result()["parts"] and result()["worn"] == []
    own = set(glasses.data.shape_keys.key_blocks.keys()) - {"Basis"}
    assert own
    for name in own:
        split.data.shape_keys.key_blocks[name].value = 1.0
    assert np.abs(evaluated(glasses) - rest).max() > 0.01
    for name in own:
        split.data.shape_keys.key_blocks[name].value = 0.0
    glasses.shape_key_add(name="theirs")
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    assert result()["worn"] == ["glasses"]
    assert glasses.data.shape_keys.key_blocks.keys() == ["Basis", "theirs"]
    assert not glasses.data.shape_keys.animation_data.drivers


def test_the_head_alone_leaves_all_others(split):  # noqa: F811
    assert bpy.ops.mimetic.attach_muscles(others="NONE") == {"FINISHED"}
    assert result()["parts"] == [] and result()["worn"] == []
    assert all(bpy.data.objects[name].data.shape_keys is None for name in NAMES)


def test_lashes_of_their_own_follow_the_lids(parts, split, rows):  # noqa: F811
    from mimetic.template.face_template import load_template

    template = load_template()
    lashes = np.asarray(template.part_vertices("lashes.L"))
    obj = wear(split, "lashes", *_piece(parts, lashes))
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    assert "lashes" in result()["parts"] and result()["worn"] == []
    rest = evaluated(obj).copy()
    split.data.shape_keys.key_blocks["lid_upper.L"].value = 1.0
    assert np.abs(evaluated(obj) - rest).max() > 0.4  # 4 mm
