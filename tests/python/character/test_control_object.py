# SPDX-License-Identifier: GPL-3.0-or-later
"""What bones of a control object are, and that their drivers' arithmetic is the core's."""

import ast
import math
import operator

import numpy as np
import pytest
from mimetic import InvalidInput, _core
from mimetic.character.canonical_head import make_head
from mimetic.character.control_object import (
    GAZE_DISTANCE,
    JAW_BONE,
    LOCATION,
    Slider,
    channels_of,
    gaze_expressions,
    lid_expression,
    parents_of,
    places_of,
)
from mimetic.character.gaze_shapes import gaze_kind, look_values, turn_weights
from mimetic.character.placement import to_object
from mimetic.character.shapes import GROUPS, JAW_AND_LIDS

FUNCTIONS = {"sin": math.sin, "cos": math.cos, "degrees": math.degrees, "min": min, "max": max}


OPERATORS = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.USub: operator.neg,
}


def value(expression: str, **numbers: float) -> float:
    """A driver's expression, of which each word is a function or one of the numbers."""
    return value_of(ast.parse(expression, mode="eval").body, numbers)


def value_of(node: ast.expr, numbers: dict[str, float]) -> float:
    """Of what Blender evaluates without scripts: sums, products and known functions."""
    match node:
        case ast.Constant():
            return node.value
        case ast.Name():
            return numbers[node.id]
        case ast.UnaryOp():
            return OPERATORS[type(node.op)](value_of(node.operand, numbers))
        case ast.BinOp():
            sides = (value_of(side, numbers) for side in (node.left, node.right))
            return OPERATORS[type(node.op)](*sides)
        case ast.Call(func=ast.Name(id=name)):
            return FUNCTIONS[name](*(value_of(part, numbers) for part in node.args))
    raise AssertionError(ast.dump(node))


@pytest.mark.parametrize("kind", ["turns", "looks"])
@pytest.mark.parametrize("side", ["L", "R"])
def test_the_gazes_drivers_compute_what_the_core_does(kind, side):
    for yaw, pitch in ((0.0, 0.0), (0.4, -0.3), (-0.6, 0.2), (0.05, 0.5)):
        degrees = np.degrees([yaw]), np.degrees([pitch])
        if kind == "turns":
            expected = turn_weights(*degrees)[0]
        else:
            expected = [float(v[0]) for v in look_values(side, *degrees).values()]
        expressions = gaze_expressions(kind, side).values()
        actual = [value(expression, yaw=yaw, pitch=pitch) for expression in expressions]
        np.testing.assert_allclose(actual, expected, atol=1e-12)


def test_a_lid_goes_along_with_its_eye_as_in_the_core():
    lid = _core.LidFollowing(0.02, 3.0)
    for own, pitch in ((0.0, -0.5), (0.6, 0.3), (0.2, 0.0), (1.0, -1.2), (0.0, 1.2)):
        expected = lid.seen(np.array([own]), np.degrees([pitch]))[0]
        actual = value(lid_expression(0.02, 3.0), control=own, pitch=pitch)
        assert actual == pytest.approx(expected, abs=1e-8)


def test_a_target_stands_where_the_eye_looks():
    yaw, pitch = np.array([0.0, 20.0, -35.0]), np.array([0.0, -15.0, 10.0])
    offsets = _core.gaze_offsets(yaw, pitch, GAZE_DISTANCE)
    for i in range(3):
        sight = np.array([*offsets[i], GAZE_DISTANCE])
        direction = _core.gaze_direction(yaw[i], pitch[i])
        np.testing.assert_allclose(sight / np.linalg.norm(sight), direction, atol=1e-12)
    with pytest.raises(InvalidInput, match="75"):
        _core.gaze_offsets(np.array([80.0]), np.array([0.0]), GAZE_DISTANCE)
    with pytest.raises(InvalidInput, match="same number"):
        _core.gaze_offsets(yaw, pitch[:2], GAZE_DISTANCE)


def test_sides_are_pairs_below_their_groups():
    group = GROUPS[1]
    sliders = [
        *(Slider(f"zygomaticus_major.{side}", group, 0.0, 1.0) for side in "LR"),
        Slider("jaw_open", JAW_AND_LIDS, 0.0, 1.0),
        Slider("lid_upper.L", JAW_AND_LIDS, -1.0, 1.0),
        Slider("detail_1", "Detail", -1.0, 1.0),
    ]
    groups = [Slider(group + side, group, -1.0, 1.0) for side in ("", ".L", ".R")]
    channels = channels_of(sliders, groups)
    assert "detail_1" not in {channel.shape for channel in channels}
    jaw = next(channel for channel in channels if channel.bone == JAW_BONE)
    assert (jaw.path, jaw.index) == (LOCATION, 2)
    control = 0.4 * jaw.unit
    assert value(jaw.expression, control=control) == pytest.approx(0.4)
    parents = parents_of(channels)
    assert parents["zygomaticus_major.L"] == f"{group}.L"
    assert parents[f"{group}.L"] == group
    assert parents[group] == parents["lid_upper.L"] == parents[JAW_BONE] == "head"
    tip = next(c.tip for c in channels if c.shape == "zygomaticus_major.R")
    assert "the subject's right" in tip and "12" in tip


def test_bones_stand_before_what_they_move():
    sliders = [Slider("muscle.L", GROUPS[1], 0.0, 1.0), Slider("lid_upper.L", "Lids", 0.0, 1.0)]
    points = np.array([[0.03, -0.1, 0.02], [0.02, -0.1, 0.05]])
    fields = dict(
        zip(("muscle.L", "lid_upper.L"), 0.01 * np.eye(2)[:, :, None] * [0, 0, 1], strict=True)
    )
    places = places_of(channels_of(sliders, []), points, fields)
    np.testing.assert_allclose(places["muscle.L"], points[0] + [0, -0.02, 0])


def test_bones_of_a_mouths_corner_stand_apart():
    head = make_head()
    sliders = [Slider(s.name, s.group, s.lowest, s.highest) for s in head.shapes]
    channels = channels_of(sliders, [])
    fields = {shape.name: to_object(shape.offsets) for shape in head.shapes}
    places = places_of(channels, to_object(head.vertices), fields)
    front = np.array(list(places.values()))[:, [0, 2]]
    apart = np.linalg.norm(front[:, None] - front, axis=2)
    assert apart[np.triu_indices(len(front), 1)].min() > 0.0058
    for name, place in places.items():
        if name.endswith(".L"):
            other = places[f"{name.removesuffix('.L')}.R"]
            np.testing.assert_allclose(place, other * [-1, 1, 1], atol=1e-3)
    # Still before what they move: the highest of the corner's is the one that lifts it
    assert places["levator_anguli_oris.L"][2] > places["depressor_anguli_oris.L"][2]


def test_a_gaze_needs_all_its_shapes():
    looks = [f"look_{way}.{side}" for way in ("up", "down", "in", "out") for side in "LR"]
    assert gaze_kind(looks) == "looks"
    assert gaze_kind(looks[:-1]) == ""
