# SPDX-License-Identifier: GPL-3.0-or-later
"""Expressions are kept, mirrored and composed into performances that they alone make."""

import re
from dataclasses import replace

import numpy as np
import pytest
from mimetic import InvalidInput
from mimetic.analyse.timing import analyse_timing
from mimetic.commands.cli import main
from mimetic.commands.library import describe
from mimetic.library.composing import Placing, compose, parse_placing
from mimetic.library.cutting import cut_motion, from_curves
from mimetic.library.expression import Expression, limits_of
from mimetic.muscles.sides import mirrored_name
from mimetic.performance.document import Performance
from mimetic.performance.gaze import GAZE
from sample_performance import make_performance

FRAMES = 90
LIPS, BROWS = 1, 5  # groups


def acting(group: int, start: int, height: float, side: str = "", seed: int = 0) -> Performance:
    """One group's muscles rise and fall over 36 frames of 90, over .1 that never goes away."""
    performance = make_performance(FRAMES, rings=5, fps=30.0, quality=np.ones(FRAMES))
    t = np.clip((np.arange(FRAMES) - start) / 36, 0, 1)
    chosen = (performance.groups == group) & [name.endswith(side) for name in performance.muscles]
    noise = np.random.default_rng(seed).normal(0, 0.002, (FRAMES, 36))
    values = 0.1 + height * np.sin(np.pi * t)[:, None] ** 2 * chosen + noise
    bones = np.zeros((FRAMES, 2))
    bones[:, 1] = 0.4 * np.sin(np.pi * t) ** 2
    return replace(
        performance,
        activations=np.clip(values, 0, 1),
        activations_std=np.full((FRAMES, 36), 0.02),
        articulator_values=bones,
    )


def cut(performance: Performance, **how) -> Expression:
    return cut_motion(analyse_timing(performance, kinds=("group",)), **how)


@pytest.fixture(scope="module")
def smile() -> Expression:
    return cut(acting(LIPS, 20, 0.8, seed=1))


@pytest.fixture(scope="module")
def brows() -> Expression:
    return cut(acting(BROWS, 30, 0.6, seed=2), only=(BROWS,))


def test_an_event_is_cut_from_rest_to_rest_with_its_phases_and_without_idle_muscles(smile):
    performance = acting(LIPS, 20, 0.8, seed=1)
    moving = [n for n, g in zip(performance.muscles, performance.groups, strict=True) if g == LIPS]
    assert smile.channels == [*moving, "jaw_side"]
    assert np.abs(smile.values[[0, -1]]).max() < 1e-12
    # What never goes away is no part of it
    assert smile.values[:, :-1].max() == pytest.approx(0.8, abs=0.02)
    assert smile.event_names == ["lip-corner pullers"]
    onset, apex, release, amplitude = smile.events[0]
    assert 0 < onset < apex <= release < len(smile.values)
    assert amplitude == pytest.approx(0.8, abs=0.05)


def test_frames_can_be_named_and_levels_kept():
    performance = acting(LIPS, 20, 0.8)
    kept = cut(performance, frames=(22, 54), is_from_rest=False)
    rows = performance.activations[21:54]
    assert kept.values[:, : rows.shape[1]].min() > 0.05
    np.testing.assert_array_equal(kept.values[:, 0], rows[:, 0])
    assert len(kept.values) == 33
    with pytest.raises(InvalidInput, match="frame 400"):
        cut(performance, frames=(22, 400))
    with pytest.raises(InvalidInput, match="there is no 7"):
        cut(performance, group=LIPS, number=7)
    with pytest.raises(InvalidInput, match="nothing moves"):
        cut(performance, frames=(70, 85), only=(7,))


def test_what_only_falls_from_the_clips_beginning_is_said_to_be_cut():
    """Less the straight line between its ends nothing is left of it; `nothing moves` is not so."""
    falling = acting(LIPS, 200, 0.8)
    values = falling.activations.copy()
    values[:, falling.groups == LIPS] = np.interp(np.arange(FRAMES), (0, 12), (0.6, 0.0))[:, None]
    timing = analyse_timing(replace(falling, activations=values), kinds=("group",))
    [event] = timing.of_group(LIPS)
    assert event.fit.begins_before
    how = {"group": LIPS, "number": 1, "only": (LIPS,)}
    with pytest.raises(InvalidInput, match=r"is left of what moves .* begins before the clip"):
        cut_motion(timing, **how)
    with pytest.raises(InvalidInput, match=r"is taken off; try --as-captured$"):
        cut_motion(timing, frames=(1, 13), only=(LIPS,))
    assert cut_motion(timing, **how, is_from_rest=False).values.max() == pytest.approx(0.6)


def test_a_still_is_the_peak(smile):
    still = smile.still()
    assert still.is_still and still.seconds == 0
    np.testing.assert_array_equal(still.values[0], smile.values[smile.peak])
    assert smile.values[smile.peak, 0] > 0.75


def test_the_peak_is_the_faces_wherever_the_eyes_look():
    def peak_of(**courses):
        values = np.array(list(courses.values())).T
        return Expression([*courses], values, np.zeros(values.shape), 30.0).peak

    gaze, jaw, lips = [0, 5, 25.0], [0.9, 0.1, 0.2], [0, 0.8, 0.3]
    channels = {"gaze_yaw.L": gaze, "jaw_open": jaw}
    assert peak_of(**channels, **{"zygomaticus_major.L": lips}) == 1
    assert peak_of(**channels) == 0
    assert peak_of(**channels, oris_close_upper=lips) == 1
    assert peak_of(**{"gaze_yaw.L": gaze}) == 2


def test_what_moves_most_is_of_the_face():
    values = np.array([[0.3, 20.0, 0.9]])
    channels = ["zygomaticus_major.L", "gaze_yaw.L", "jaw_open"]
    kept = Expression(channels, values, np.zeros(values.shape), 30.0)
    assert "3 muscles and bones, most zygomaticus_major.L;" in describe(kept)
    alone = Expression(channels[:1], values[:, :1], np.zeros((1, 1)), 30.0)
    assert "1 muscle or bone, most zygomaticus_major.L;" in describe(alone)


def test_the_gaze_is_kept_whole_or_not_at_all():
    channels = ["zygomaticus_major.L", *GAZE]
    values = np.zeros((9, 5))
    values[4] = [0.8, 0.5, 1.0, 0.5, 1.0]  # degrees
    limits = limits_of(channels, channels[:1])
    assert from_curves(channels, values, 30.0, limits).channels == channels[:1]
    values[4, 1] = 8
    assert from_curves(channels, values, 30.0, limits).channels == channels


def test_lips_and_air_have_the_ranges_of_their_sliders():
    names = ["zygomaticus_major.L", "oris_close_upper", "air_cheek.L", "jaw_open", "gaze_yaw.L"]
    lowest, highest = limits_of(names, names[:1])
    assert lowest.tolist() == [0, -1.6, -0.5, 0, -90]
    assert highest.tolist() == [1, 1, 1, 1, 90]


def test_mirroring_changes_sides_and_the_signs_of_what_turns():
    left = cut(acting(LIPS, 20, 0.8, side=".L"))
    right = left.mirrored()
    assert all(name.endswith((".R", "jaw_side")) for name in right.channels)
    np.testing.assert_array_equal(right.values[:, :-1], left.values[:, :-1])
    np.testing.assert_array_equal(right.values[:, -1], -left.values[:, -1])
    again = right.mirrored()
    assert again.channels == left.channels
    np.testing.assert_array_equal(again.values, left.values)
    assert mirrored_name("jaw_open") == "jaw_open"


def test_what_is_saved_is_read_again(smile, tmp_path):
    path = tmp_path / "smile.expression.npz"
    for one in (smile, smile.still()):
        one.save(path)
        again = Expression.load(path)
        assert again.channels == one.channels and again.event_names == one.event_names
        np.testing.assert_array_equal(again.values, one.values)
        assert again.source == one.source and again.fps == one.fps
    arrays = dict(np.load(path))
    np.savez(path, **(arrays | {"values": np.full((1, len(smile.channels)), np.nan)}))
    with pytest.raises(InvalidInput, match="values is not finite"):
        Expression.load(path)
    np.savez(path, **(arrays | {"schema": np.array(9)}))
    with pytest.raises(InvalidInput, match="newer version"):
        Expression.load(path)


def test_a_smile_with_a_brow_raise_of_other_clips_is_one_expression_of_two_seconds(smile, brows):
    """Of library entries alone: nothing of the clips they were cut from is needed."""
    entries = {"smile": smile, "brows": brows}
    person = make_performance(1, rings=5)
    placings = [parse_placing("smile@0.3"), parse_placing("brows@0.4*0.9")]
    composed = compose(placings, entries.__getitem__, person, fps=30, seconds=2)
    assert composed.num_frames == 61 and composed.fps == 30
    values = dict(zip(composed.muscles, composed.activations.T, strict=True))
    assert values[smile.channels[0]].max() == pytest.approx(smile.values[:, 0].max(), abs=0.02)
    assert values[brows.channels[0]].max() == pytest.approx(
        0.9 * brows.values[:, 0].max(), abs=0.02
    )
    still = [n for n in composed.muscles if n not in smile.channels + brows.channels]
    assert still and max(values[name].max() for name in still) == 0
    # Together, not one after the other
    together = (values[smile.channels[0]] > 0.3) & (values[brows.channels[0]] > 0.3)
    assert together.sum() > 10
    assert composed.activations[[0, -1]].max() < 0.02
    assert np.abs(np.diff(composed.activations, axis=0)).max() < 0.15
    begin = np.flatnonzero(values[smile.channels[0]] > 0.01)[0] / 30  # stretched, as all is
    noted = re.fullmatch(
        r"composed: smile at ([.\d]+) s, ([.\d]+) s long, strength 1", composed.notes[0]
    )
    assert begin == pytest.approx(float(noted[1]), abs=0.05) and float(noted[1]) > 0.35
    assert float(noted[2]) / float(noted[1]) == pytest.approx(smile.seconds / 0.3, rel=1e-3)


@pytest.mark.parametrize("text", ["smile", "smile@0.5*0.5/1.0", "smile*2/0.4", "smile@0.52/0.31"])
@pytest.mark.parametrize("fps", [24, 29.97, 30])
def test_a_composition_ends_at_rest(smile, text, fps):
    person, placing = make_performance(1, rings=5), parse_placing(text)
    composed = compose([placing], lambda _: smile, person, fps=fps)
    assert composed.activations[-2].max() > 0
    assert composed.activations[-1].max() < 1e-6


def test_an_expression_begins_to_move_at_the_second_that_is_given(smile):
    person = make_performance(1, rings=5)
    composed = compose([Placing("smile", 1.0)], lambda _: smile, person, fps=30)
    fit = analyse_timing(composed, kinds=("group",)).of_group(LIPS)[0].fit
    assert (fit.shape.onset - 1) / 30 == pytest.approx(1.0, abs=0.05)
    assert composed.activations[:27].max() < 0.05


def test_stills_and_other_rates_compose(smile):
    person = make_performance(1, rings=5)
    composed = compose([Placing("s", 0, 0.5, 1.5)], lambda _: smile.still(), person, fps=24)
    first = composed.activations[:, composed.muscles.index(smile.channels[0])]
    assert composed.num_frames == 37
    assert first[0] == 0 and first[-1] == 0
    assert first.max() == pytest.approx(0.5 * smile.values[:, 0].max(), abs=1e-3)
    lacking = replace(person, articulators=["jaw_open", "chin"])
    notes = compose([Placing("smile")], lambda _: smile, lacking).notes
    assert notes[-1] == "smile: this head has no jaw_side"


@pytest.mark.parametrize("text", ["", "a@", "a@x", "a*", "@2", "a*-1", "a/0", "a@1@2", "a/1e9"])
def test_what_is_no_placing_is_refused(text):
    with pytest.raises(InvalidInput):
        parse_placing(text)


def test_placings_are_read():
    assert parse_placing("big smile@-0.5*0.8/2") == Placing("big smile", -0.5, 0.8, 2.0)
    assert parse_placing("a/2") == Placing("a", seconds=2.0)


def test_the_commands_keep_list_mirror_and_compose(tmp_path, capsys):
    take, library = tmp_path / "take.npz", tmp_path / "library"
    acting(LIPS, 20, 0.8, side=".L").save(take)
    keep = ["library", "keep", str(library), str(take), "--name"]
    assert main([*keep, "smile"]) == 0
    assert main([*keep, "peak", "--still", "--group", "1", "--event", "1"]) == 0
    assert main(["library", "mirror", str(library), "smile", "--as", "other smile"]) == 0
    assert (library / "smile.png").read_bytes()[:4] == b"\x89PNG"
    capsys.readouterr()
    assert main(["library", "list", str(library)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split("  ")[0] for line in lines] == ["other smile", "peak", "smile"]
    out = tmp_path / "new.npz"
    compose_it = ["library", "compose", str(library), "smile@0.2", "other smile@0.6*0.5", "--out"]
    assert main([*compose_it, str(out), "--person", str(take), "--seconds", "2"]) == 0
    assert Performance.load(out).num_frames == 61
    lacking = replace(Performance.load(take), articulators=["jaw_open", "chin"])
    lacking.save(tmp_path / "lacking.npz")
    capsys.readouterr()
    assert main([*compose_it, str(out), "--person", str(tmp_path / "lacking.npz")]) == 0
    assert "note: smile: this head has no jaw_side" in capsys.readouterr().out.splitlines()


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["keep", "{library}", "{take}", "--name", "smile"], "has an expression smile already"),
        (["keep", "{library}", "{take}", "--name", "mine"], "mine.png is there already, and of no"),
        (["keep", "{library}", "{take}", "--name", "../x"], "cannot name an expression"),
        (["keep", "{library}", "{take}", "--name", "y", "--event", "1"], "give the group too"),
        (["keep", "{take}", "{take}", "--name", "y"], "is a file"),
        (["list", "{library}x"], "a library is the folder"),
        (["mirror", "{library}", "frown", "--as", "x"], "has no expression frown; it has smile"),
        (["compose", "{library}", "smile@@", "--out", "{library}/x.npz"], "is no expression of"),
        (["compose", "{library}", "smile@-60", "--out", "{library}/x.npz"], "ends before 0 s"),
        (["compose", "{library}", "smile", "--out", "{library}/x.txt"], "is an .npz file"),
        (["compose", "{library}", "smile", "--out", "{take}", "--person", "{take}"], "take.npz"),
    ],
)
def test_bad_input_is_one_line(tmp_path, capsys, smile, arguments, reason):
    take, library = tmp_path / "take.npz", tmp_path / "library"
    acting(LIPS, 20, 0.8).save(take)
    library.mkdir()
    smile.save(library / "smile.expression.npz")
    (library / "mine.png").write_bytes(b"a picture of the user's")
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    places = {"take": take, "library": library}
    assert main(["library", *(text.format(**places) for text in arguments)]) == 2
    text = capsys.readouterr().err
    assert text.count("\n") == 1 and reason in text
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before
