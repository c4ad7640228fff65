# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits of curves: as keys with handles, and of a whole performance before a bake."""

import dataclasses

import numpy as np
import pytest
from mimetic import InvalidInput, _core
from mimetic.character.curve_keys import (
    CurveKeys,
    cubic_keys,
    mixed,
    sample_frames,
    samples,
    slope_frames,
    twin_of,
)
from mimetic.character.curve_settings import (
    ALL_GROUPS,
    CurveSettings,
    edited,
    group_names,
    parse_factors,
    settings_of,
)
from mimetic.character.sparse_curves import sparse_keys
from sample_performance import make_performance

FRAMES = np.array([1.0, 4, 9, 20, 22.5])


def parabola(frames):
    return 0.2 + 0.1 * frames - 0.004 * frames**2


def slopes(frames):
    return 0.1 - 0.008 * frames


@pytest.fixture
def keys() -> CurveKeys:
    return cubic_keys(FRAMES, parabola(FRAMES), slopes(FRAMES), slopes(FRAMES))


def played(keys, frames):
    """Cubics by their handles, which end a third of the way."""
    i = np.searchsorted(keys.points[1:-1, 0], frames, "right")
    a, b = keys.points[i], keys.right[i, 1]
    c, d = keys.left[i + 1, 1], keys.points[i + 1]
    s = (frames - a[:, 0]) / (d[:, 0] - a[:, 0])
    t = 1 - s
    return a[:, 1] * t**3 + 3 * b * s * t**2 + 3 * c * s**2 * t + d[:, 1] * s**3


def test_only_the_chosen_keys_change(keys):
    is_chosen = np.array([False, True, True, False, False])
    larger = keys.affine(2.0, 0.1, is_chosen)
    for name in ("points", "left", "right"):
        old, new = getattr(keys, name), getattr(larger, name)
        np.testing.assert_allclose(new[is_chosen, 1], 2 * old[is_chosen, 1] + 0.1)
        np.testing.assert_array_equal(new[~is_chosen], old[~is_chosen])
        np.testing.assert_array_equal(new[:, 0], old[:, 0])


def test_limits_hold_between_keys_too(keys):
    limited, count = keys.limited(0.3, 0.7)
    assert count == int(((keys.points[:, 1] < 0.3) | (keys.points[:, 1] > 0.7)).sum()) > 0
    values = played(limited, np.linspace(1, 22.5, 200))
    assert values.min() >= 0.3 - 1e-12
    assert values.max() <= 0.7 + 1e-12


def test_slower_keys_play_the_same_values_later(keys):
    slower = keys.retimed(1.0, 22.5, 1.5, 3.0)
    at = np.linspace(1, 22.5, 80)
    np.testing.assert_allclose(played(slower, 4 + 1.5 * (at - 1)), parabola(at), atol=1e-12)


def test_smoothing_leaves_a_slow_curve_and_its_handles(keys):
    at = sample_frames(FRAMES)
    assert (at[0], at[-1]) == (FRAMES[0], FRAMES[-1])
    assert np.diff(at).max() <= 0.25
    smooth = keys.smoothed(at, parabola(at), 2.0, np.ones(5, dtype=bool))
    inner = np.linspace(1, 22.5, 80)
    np.testing.assert_allclose(played(smooth, inner), parabola(inner), atol=1e-9)


@pytest.mark.parametrize("width", [2.0, 7.0])
def test_few_keys_are_smoothed_as_the_dense_curve_between_them_too(width):
    frames = np.arange(1.0, 101)
    dense = np.interp(frames, [1, 20, 30, 90, 100], [0, 0, 0.4, 0.5, 0.5])  # long spans, corners
    few = sparse_keys(frames, dense, 0.02)
    at = sample_frames(few.points[:, 0])
    smooth = few.smoothed(at, played(few, at), width, np.ones(len(few.points), dtype=bool))
    np.testing.assert_array_equal(smooth.points[:, 0], few.points[:, 0])
    expected, _ = _core.smooth_curve(frames, dense, at, width)
    assert np.abs(played(smooth, at) - expected).max() < 0.03


def test_keys_at_one_frame_and_a_single_key_are_smoothed():
    for frames in (np.array([3.0]), np.array([1.0, 4, 4, 4, 9])):
        keys = cubic_keys(frames, *np.zeros((3, len(frames))))
        at = sample_frames(frames)
        smooth = keys.smoothed(at, np.ones(len(at)), 2.0, np.ones(len(frames), dtype=bool))
        np.testing.assert_allclose(smooth.points[:, 1], 1)
        np.testing.assert_allclose(smooth.left[:, 1], 1)


def test_a_mean_of_cubics_is_exact():
    first, second = np.array([0.0, 8, 20]), np.array([0.0, 5, 20])

    def line(frames):
        return 0.05 * frames

    union = np.unique(np.concatenate([first, second]))
    parts = [samples(f(slope_frames(union))) for f in (parabola, line)]
    keys = mixed(union, list(zip((0.25, 0.75), parts, strict=True)))
    at = np.linspace(0, 20, 50)
    np.testing.assert_allclose(played(keys, at), 0.25 * parabola(at) + 0.75 * line(at), atol=1e-9)


@pytest.mark.parametrize(
    ("shape", "twin"),
    [
        ("brow.L", ("brow.R", 1)),
        ("jaw_side", ("jaw_side", -1)),
        ("eye_left.L", ("eye_left.R", -1)),
        ("eye_down_left.R", ("eye_down_left.L", -1)),
        ("eye_left_left.R", ("eye_left_left.L", 1)),
        ("gaze_yaw", ("gaze_yaw", -1)),
    ],
)
def test_the_mirror_turns_what_points_aside(shape, twin):
    assert twin_of(shape) == twin


def test_settings_that_change_nothing_give_the_performance_back():
    performance = make_performance()
    assert edited(performance, CurveSettings()) is performance
    assert edited(performance, settings_of()) is performance


def test_one_group_is_exaggerated_and_stays_within_its_limits():
    performance = make_performance()
    group = group_names()[4]
    result = edited(performance, settings_of(of_groups=f"{group}=1.5"))
    is_in = performance.groups == 5
    expected = np.clip(1.5 * performance.activations[:, is_in], 0, 1)
    np.testing.assert_allclose(result.activations[:, is_in], expected)
    np.testing.assert_array_equal(result.activations[:, ~is_in], performance.activations[:, ~is_in])
    np.testing.assert_array_equal(result.articulator_values, performance.articulator_values)


@pytest.mark.parametrize(
    ("how", "left", "right", "middle"),
    [("swap", 2, 1, -3), ("left", 1, 1, 3), ("right", 2, 2, 3), ("both", 1.5, 1.5, 0)],
)
def test_a_mirrored_performance_does_on_a_side_what_the_other_did(how, left, right, middle):
    performance = make_performance()
    names = list(performance.muscles)
    names[:3] = ["brow.L", "brow.R", "lonely.L"]
    activations = performance.activations.copy()
    activations[:, :3] = 0.1, 0.2, 0.7
    given = {"muscles": names, "activations": activations}
    for bones, row, expected in (
        # Eyes that look aside are exchanged, or stay: else one would turn away from the other
        (["gaze_yaw.L", "gaze_yaw.R"], (14, 19), (-19, -14) if how == "swap" else (14, 19)),
        (["jaw_side", "jaw_open"], (0.3, 0.4), (0.1 * middle, 0.4)),
    ):
        values = np.tile(row, (performance.num_frames, 1))
        given |= {"articulators": bones, "articulator_values": values}
        result = edited(dataclasses.replace(performance, **given), settings_of(mirror=how))
        np.testing.assert_allclose(result.activations[0, :3], [0.1 * left, 0.1 * right, 0.7])
        np.testing.assert_allclose(result.articulator_values[0], expected, atol=1e-12)


def test_a_mirror_that_there_is_not_is_refused():
    with pytest.raises(InvalidInput, match="mirror up: it is one of swap, left"):
        edited(make_performance(), settings_of(mirror="up"))


def test_the_neutral_frame_is_at_rest_and_larger_is_about_it():
    performance = make_performance()
    result = edited(performance, CurveSettings(0.0, 4, {ALL_GROUPS: 2.0}))
    assert np.abs(result.activations[3]).max() == 0
    rise = performance.activations - performance.activations[3]
    np.testing.assert_allclose(result.activations, np.clip(2 * rise, 0, 1), atol=1e-12)
    with pytest.raises(InvalidInput, match=r"neutral frame 99 .* 1 to 12"):
        edited(performance, CurveSettings(neutral_frame=99))


def test_smoothing_is_the_same_at_any_rate_and_leaves_the_gaze():
    def at_rate(fps, count):
        seconds = np.arange(count) / fps
        activations = np.repeat(0.5 + 0.3 * np.sin(2 * seconds)[:, None], 36, axis=1)
        activations += 0.05 * np.sin(40 * seconds)[:, None]
        yaw = 10 * np.sin(30 * seconds)[:, None]
        performance = make_performance(count, fps=fps, activations=activations)
        return dataclasses.replace(
            performance,
            articulators=["gaze_yaw.L"],
            articulator_values=yaw,
            articulator_modes=performance.articulator_modes[:1],
        )

    slow, fast = at_rate(30.0, 121), at_rate(60.0, 241)
    settings = CurveSettings(smoothing=0.1)
    few, many = edited(slow, settings), edited(fast, settings)
    difference = np.abs(few.activations - many.activations[::2])[10:-10].max()
    assert difference < 2e-3
    seconds = np.arange(121) / 30
    motion = 0.5 + 0.3 * np.sin(2 * seconds)
    left = np.abs(few.activations[10:-10, 0] - motion[10:-10]).max()
    assert left < 0.02  # of .05
    np.testing.assert_array_equal(few.articulator_values, slow.articulator_values)


def test_curves_are_not_smoothed_over_a_cut():
    steps = np.repeat([0.2, 0.8], 10)[:, None] * np.ones(36)
    performance = make_performance(20, activations=steps, scene_starts=np.array([11]))
    result = edited(performance, CurveSettings(smoothing=0.1))
    np.testing.assert_allclose(result.activations, steps, atol=1e-9)


def test_blinks_stay_as_the_rest_is_smoothed():
    lids = np.zeros((30, 2))
    lids[10:13] = 1.0
    performance = make_performance(30, articulators=["lid_upper.L", "jaw_open"])
    performance = dataclasses.replace(performance, articulator_values=lids)
    result = edited(performance, CurveSettings(smoothing=0.1))
    np.testing.assert_array_equal(result.articulator_values[:, 0], lids[:, 0])
    assert result.articulator_values[:, 1].max() < 0.8
    result = edited(performance, CurveSettings(smoothing=0.1, smooths_lids=True))
    assert result.articulator_values[:, 0].max() < 0.8


@pytest.mark.parametrize(
    ("texts", "message"),
    [
        (["nose=2"], "groups are lip-corners"),
        (["much"], "give FACTOR or GROUP=FACTOR"),
        (["11"], "between 0 and 10"),
        (["-1"], "between 0 and 10"),
        (["nan"], "between 0 and 10"),
    ],
)
def test_factors_that_nothing_can_have_are_refused(texts, message):
    with pytest.raises(InvalidInput, match=message):
        parse_factors(texts)


def test_factors_are_read_by_group():
    assert parse_factors(["1.2", "brow-raisers=1.5", "Eye Ring=.5"]) == {
        ALL_GROUPS: 1.2,
        "Brow Raisers": 1.5,
        "Eye Ring": 0.5,
    }
    with pytest.raises(InvalidInput, match="give GROUP=FACTOR"):
        settings_of(of_groups="1.5")
    with pytest.raises(InvalidInput, match="between 0 and 10"):
        edited(make_performance(), CurveSettings(smoothing=-1.0))
