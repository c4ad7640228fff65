# SPDX-License-Identifier: GPL-3.0-or-later
"""Muscles that go further than is assumed: how that is stated, kept in the fit, and used."""

from dataclasses import replace

import numpy as np
import pytest
from mimetic import InvalidInput
from mimetic.fit.face_fit import FaceFit
from mimetic.media.footage import Footage
from mimetic.muscles.anatomy import attach
from mimetic.muscles.calibration import Calibration
from mimetic.performance.corrections import FrameCorrection, Pinned
from mimetic.performance.document import Performance
from mimetic.performance.evidence import evidence_factors
from mimetic.performance.gaze import GAZE
from mimetic.puppet.live_face import canonical_anatomy, live_face
from mimetic.solve import full_range
from mimetic.solve.clip_capture import capture, find_face
from mimetic.solve.refining import refined
from mimetic.solve.tracking import ACTIVATION_STD, face_motion, moving_modes
from mimetic.template.face_template import load_template
from sample_fit import make_fit
from sample_performance import make_performance

SMILE = "zygomaticus_major.R"


@pytest.fixture(scope="module")
def anatomy():
    template = load_template()
    return attach(template.vertices, template)


def values_of(anatomy, peak):
    """Ten frames in which the smile rises to its peak beside another muscle that goes to .5."""
    values = np.zeros((10, len(anatomy.muscle_names)))
    values[:, anatomy.muscle_names.index(SMILE)] = np.linspace(0, peak, 10)
    values[:, 0] = np.linspace(0, 0.5, 10)
    return values


def evidence_of(anatomy):
    size = 6 + len(anatomy.muscle_names) + len(anatomy.articulator_names)
    length = size * (size + 3) // 2
    return np.random.default_rng(4).normal(size=(10, length)).astype(np.float32)


def test_evidence_says_the_same_of_activations_however_they_are_stated():
    rng = np.random.default_rng(7)
    scale = np.array([1.0, 1.4, 1.0])
    slopes = rng.normal(size=(12, 9))
    information, gradient, step = slopes.T @ slopes, rng.normal(size=9), rng.normal(size=9)
    packed = np.append(information[np.tril_indices(9)], gradient).astype(np.float32)
    own = packed * evidence_factors(scale)
    lower = np.zeros((9, 9))
    lower[np.tril_indices(9)] = own[:-9]
    own_information = lower + np.tril(lower, -1).T
    own_step = step / np.append(np.ones(6), scale)
    assert own_step @ own_information @ own_step == pytest.approx(step @ information @ step, 1e-5)
    assert own[-9:] @ own_step == pytest.approx(gradient @ step, 1e-5)


def test_activations_are_stated_relative_to_how_far_the_person_went(anatomy):
    values = values_of(anatomy, 1.4)
    std = np.full(values.shape, 0.07)
    fit = make_fit(calibration=Calibration())
    fit = full_range.with_extent(fit, anatomy.muscle_names, values, std)
    assert fit.calibration.extent == {SMILE: pytest.approx(1.47)}  # a deviation further
    fields = full_range.stated(fit, anatomy, values, std, evidence_of(anatomy))
    column = anatomy.muscle_names.index(SMILE)
    assert fields["activations"][:, column].max() == pytest.approx(1.4 / 1.47)
    np.testing.assert_allclose(fields["activations_std"][:, column], 0.07 / 1.47)
    np.testing.assert_array_equal(fields["activations"][:, 0], values[:, 0])
    moved = np.tensordot(fields["activations"], fields["muscle_modes"], axes=1)
    np.testing.assert_allclose(moved, np.tensordot(values, anatomy.muscle_modes, axes=1))


def test_nothing_is_stated_otherwise_where_no_muscle_went_further(anatomy):
    values = values_of(anatomy, 0.9)
    fit = make_fit(calibration=Calibration())
    fit = full_range.with_extent(fit, anatomy.muscle_names, values, np.full(values.shape, 0.2))
    assert fit.calibration.extent == {}
    evidence = evidence_of(anatomy)
    fields = full_range.stated(fit, anatomy, values, values, evidence)
    assert fields.keys() == {"activations", "activations_std", "evidence"}
    np.testing.assert_array_equal(fields["evidence"], evidence)
    np.testing.assert_array_equal(fields["activations"], values)


def test_no_extent_goes_beyond_what_a_muscle_may_do(anatomy):
    values = values_of(anatomy, full_range.HEADROOM)
    fit = make_fit(calibration=Calibration())
    fit = full_range.with_extent(fit, anatomy.muscle_names, values, np.full(values.shape, 0.2))
    assert fit.calibration.extent == {SMILE: full_range.HEADROOM}


def test_what_an_earlier_clip_showed_holds_in_the_next_one(anatomy):
    fit = make_fit(calibration=Calibration(extent={SMILE: 1.5}))
    values = values_of(anatomy, 1.2)
    fit = full_range.with_extent(fit, anatomy.muscle_names, values, np.full(values.shape, 0.5))
    assert fit.calibration.extent == {SMILE: 1.5}
    fields = full_range.stated(fit, anatomy, values, values, evidence_of(anatomy))
    assert fields["activations"].max() == pytest.approx(0.8)


def test_extents_are_kept_in_the_fit_file(tmp_path):
    fit = make_fit(calibration=Calibration(extent={SMILE: 1.25}))
    fit.save(tmp_path / "fit.json")
    assert FaceFit.load(tmp_path / "fit.json").calibration.extent == {SMILE: 1.25}


@pytest.mark.parametrize("extent", [0.99, 10.1])
def test_an_extent_that_is_none_is_refused(extent):
    with pytest.raises(InvalidInput, match="extent zygomaticus_major"):
        Calibration(extent={SMILE: extent})


def test_an_extent_of_no_muscle_is_refused(anatomy):
    with pytest.raises(InvalidInput, match="winker"):
        anatomy.extended_by(Calibration(extent={"winker.L": 1.2}))


def test_a_muscle_that_reaches_further_is_as_likely_to_move_the_skin_as_before(anatomy):
    """The priors are of displacements: raising a muscle gives it no work of its neighbours'."""
    extended = anatomy.extended_by(Calibration(extent={SMILE: 1.5}))
    count = len(load_template().vertices)
    (modes, std), (own_modes, own_std) = (moving_modes(each, count) for each in (anatomy, extended))
    column = anatomy.muscle_names.index(SMILE)
    assert own_std[column] == ACTIVATION_STD / 1.5
    np.testing.assert_allclose(own_modes * own_std[:, None, None], modes * std[:, None, None])


def test_a_muscles_bound_is_its_extent(anatomy):
    template = load_template()
    extent = np.ones(len(anatomy.muscle_names))
    extent[3] = 1.3
    motion = face_motion(template.vertices, template, anatomy, extent=extent)
    np.testing.assert_array_equal(motion.upper[: len(extent)], extent)


def test_a_live_filter_follows_within_the_persons_extents(rendered_clip):
    image = Footage(rendered_clip.footage).read(1)
    fit = replace(find_face(rendered_clip.footage, 1), calibration=Calibration(extent={SMILE: 1.5}))
    face = live_face(image, fit)
    column = face.anatomy.muscle_names.index(SMILE)
    usual_modes = canonical_anatomy().muscle_modes
    np.testing.assert_array_equal(face.anatomy.muscle_modes[column], 1.5 * usual_modes[column])
    np.testing.assert_array_equal(face.anatomy.muscle_modes[0], usual_modes[0])
    assert face.tracker.advance(image, None).values.max() <= 1


def test_a_performance_with_an_extent_under_one_is_refused():
    with pytest.raises(InvalidInput, match="muscle_extent must not be under 1"):
        make_performance(muscle_extent=np.full(36, 0.9))


def test_corrections_move_the_skin_alike_however_far_a_muscle_extentes(
    rendered_clip, rest_fit, tmp_path
):
    usual = capture(rendered_clip.footage, frames=(1, 30), fit=rest_fit)
    assert usual.muscle_extent is None
    column = int(usual.activations.max(axis=0).argmax())
    extent = np.ones(len(usual.muscles))
    extent[column] = 1.25
    num_articulators = len([name for name in usual.articulators if name not in GAZE])
    raised = replace(
        usual,
        activations=usual.activations / extent,
        activations_std=usual.activations_std / extent,
        muscle_modes=usual.muscle_modes * extent[:, None, None],
        muscle_extent=extent,
        evidence=usual.evidence * evidence_factors(np.append(extent, np.ones(num_articulators))),
    )
    raised.save(tmp_path / "raised.npz")
    raised = Performance.load(tmp_path / "raised.npz")
    name, wanted = usual.muscles[column], 0.5
    as_usual = refined(usual, (FrameCorrection(20, 5.0, values={name: Pinned(wanted, 0.02)}),))
    entry = FrameCorrection(20, 5.0, values={name: Pinned(wanted / 1.25, 0.016)})
    as_raised = refined(raised, (entry,))
    np.testing.assert_allclose(as_raised.activations * extent, as_usual.activations, atol=1e-4)
    assert np.abs(as_raised.surface(19) - as_usual.surface(19)).max() < 1e-6
    assert as_usual.activations[19, column] == pytest.approx(wanted, abs=0.05)
