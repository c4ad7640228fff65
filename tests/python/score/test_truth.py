# SPDX-License-Identifier: GPL-3.0-or-later
"""Truth files are kept and refused; rendered truth agrees with its picture."""

import numpy as np
import pytest
from mimetic import InvalidInput, UnreadableMedia
from mimetic.media.footage import Footage
from mimetic.score.score import score
from mimetic.score.truth import Truth
from sample_performance import make_performance

LIPS_AND_AIR = ("lips-and-air", "lips-and-air-tuning")


def test_truth_comes_back_as_saved(tmp_path, truth):
    truth.save(tmp_path / "truth.npz")
    loaded = Truth.load(tmp_path / "truth.npz")
    np.testing.assert_array_equal(loaded.tracks, truth.tracks)
    assert loaded.muscles == truth.muscles
    assert loaded.fps == truth.fps
    assert [path.name for path in tmp_path.iterdir()] == ["truth.npz"]


def test_numbers_by_themselves_are_read(tmp_path, truth):
    path = tmp_path / "truth.npz"
    truth.save(path)
    alone = {"fps": np.float64(24), "schema": np.int64(1)}
    np.savez(path, **(dict(np.load(path)) | alone))
    assert Truth.load(path).fps == 24
    np.savez(path, **(dict(np.load(path)) | {"frame": np.int64(1)}))
    with pytest.raises(InvalidInput, match="frame has the shape"):
        Truth.load(path)


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("tracks", None, "lacks the key tracks"),
        ("tracks", np.zeros((3, 2, 2)), "tracks has the shape"),
        ("points", "nan", "points is not finite"),
        ("visible", np.zeros((40, 40)), "visible has the type"),
        ("head_pose", np.tile(np.diag([-1.0, 1, 1, 1]), (40, 1, 1)), "not a rigid motion"),
        ("head_pose", np.tile(np.eye(4), (40, 1, 1)), "before the camera"),
        ("schema", np.array([2]), "schema 2"),
        ("units", np.array(["jawOpen"]), "both or none of units and unit_values"),
        ("muscles", np.array([{}], object), "Python objects"),
    ],
)
def test_a_wrong_truth_file_is_refused(tmp_path, truth, key, value, said):
    path = tmp_path / "truth.npz"
    truth.save(path)
    arrays = dict(np.load(path))
    if value is None:
        del arrays[key]
    elif isinstance(value, str):
        arrays[key][1, 1] = float(value)
    else:
        arrays[key] = value
    np.savez(path, **arrays)
    with pytest.raises(InvalidInput, match=said):
        Truth.load(path)


def test_no_file_and_no_archive_are_unreadable(tmp_path):
    with pytest.raises(UnreadableMedia, match="no such file"):
        Truth.load(tmp_path / "absent.npz")
    (tmp_path / "text.npz").write_text("not an archive")
    with pytest.raises(UnreadableMedia, match="damaged"):
        Truth.load(tmp_path / "text.npz")


def test_people_of_tuning_and_held_out_clips_do_not_meet():
    from evaluation.synthetic.expressions.recipes import SETS as EXPRESSIONS
    from evaluation.synthetic.recipes import HELD_OUT, SETS

    held_out = {recipe.seed for recipe in HELD_OUT}
    held_out |= {take.recipe.seed for take in EXPRESSIONS["full"]}
    lips = [{take.recipe.seed for take in EXPRESSIONS[name]} for name in LIPS_AND_AIR]
    assert not lips[0] & lips[1]
    held_out |= lips[0]
    others = {r.seed for name, rs in SETS.items() if name != "held-out" for r in rs}
    others |= {take.recipe.seed for take in EXPRESSIONS["full-tuning"]}
    assert min(held_out) >= 100 > max(others)


def test_every_expression_is_shown_by_ten_people():
    from evaluation.synthetic.expressions.recipes import SETS

    shown = [name for take in SETS["full"] for name in take.expressions]
    assert {shown.count(name) for name in shown} == {10}
    assert len({take.recipe.seed for take in SETS["full"]}) == 30


def test_what_no_muscle_does_has_sets_of_its_own():
    from evaluation.synthetic.expressions.recipes import SETS

    for name in LIPS_AND_AIR:
        shown = [expression for take in SETS[name] for expression in take.expressions]
        assert {shown.count(expression) for expression in shown} == {9}
        assert not set(shown) & {e for take in SETS["full"] for e in take.expressions}


def test_rendered_truth_agrees_with_its_picture(rendered_clip):
    """Patches about the points look alike where truth says they went, and less so 2 px beside."""
    truth = Truth.load(rendered_clip.truth)
    images = [image.mean(2) for _, image in Footage(rendered_clip.footage)]
    assert len(images) == len(truth.frame)
    last = int(np.linalg.norm(truth.tracks - truth.tracks[0], axis=2).mean(1).argmax())
    at = truth.visible[last] & truth.visible[0]
    first, moved = truth.tracks[0][at], truth.tracks[last][at]
    right = _likeness(images[0], images[last], first, moved)
    for offset in ((2, 0), (-2, 0), (0, 2), (0, -2)):
        assert right > _likeness(images[0], images[last], first, moved + offset) + 0.1
    assert right > 0.6


def _likeness(a, b, at_a, at_b, reach=4):
    """Median correlation of the patches about pixels of two grey images."""
    from mimetic.score.peers import sampled

    steps = np.stack(np.meshgrid(*[np.arange(-reach, reach + 1.0)] * 2), 2).reshape(-1, 2)
    patches = [
        sampled(im[..., None], at[:, None] + steps)[..., 0] for im, at in ((a, at_a), (b, at_b))
    ]
    patches = [p - p.mean(1, keepdims=True) for p in patches]
    norms = [np.linalg.norm(p, axis=1) for p in patches]
    return np.median((patches[0] * patches[1]).sum(1) / (norms[0] * norms[1]))


def test_swung_heads_show_what_turning_ones_do():
    from evaluation.synthetic.expressions.recipes import SETS

    turning = [take for take in SETS["full"] if take.head == "turning"]
    swung = SETS["full-swung"]
    assert len(swung) == len(turning) == 9
    for slow, fast in zip(turning, swung, strict=True):
        assert fast.recipe.phases == slow.recipe.phases
        assert fast.recipe.seed == slow.recipe.seed
        assert (slow.recipe.head_motion.yaw, fast.recipe.head_motion.yaw) == (18, 30)


def test_the_true_surface_scores_well_on_the_rendered_clip(rendered_clip):
    """The clip's own person and motion as a performance: what a perfect capture would score."""
    truth = Truth.load(rendered_clip.truth)
    result = score(
        truth, true_performance(truth), images=(i for _, i in Footage(rendered_clip.footage))
    )
    assert result.image["mimetic"]["nonrigid_r2"] > 0.97
    assert abs(result.image["its head motion alone"]["nonrigid_r2"]) < 0.05
    assert result.surface["r2"] > 0.97
    for peer in ("chained", "direct"):
        assert result.image[f"DIS flow, {peer}"]["r2"] > 0.8


def true_performance(truth):
    from mimetic.template.face_template import load_template

    template = load_template()
    moving = [u for u, name in enumerate(truth.units) if truth.unit_values[:, u].max() > 0]
    num_frames = len(truth.frame)
    modes = np.zeros((36, *template.vertices.shape), np.float32)
    activations = np.zeros((num_frames, 36))
    modes[: len(moving)] = template.unit_modes[moving]
    activations[:, : len(moving)] = truth.unit_values[:, moving]
    return make_performance(
        num_frames,
        frame=truth.frame,
        fps=truth.fps,
        image_size=truth.image_size,
        intrinsics=truth.intrinsics,
        head_pose=truth.head_pose,
        muscle_modes=modes,
        activations=activations,
        articulators=[],
        articulator_values=np.zeros((num_frames, 0)),
        articulator_modes=None,
        neutral_vertices=truth.neutral_vertices,
        faces=template.faces,
    )
