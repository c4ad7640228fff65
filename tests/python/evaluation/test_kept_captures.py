# SPDX-License-Identifier: GPL-3.0-or-later
import pytest
from mimetic.performance.document import Performance
from sample_performance import make_performance

from evaluation.runs.kept_captures import KeptCaptures


def refuse_to_render():
    raise AssertionError("a clip was rendered whose capture is kept")


def test_a_kept_capture_is_taken_without_rendering_and_kept_again(tmp_path):
    before, out = tmp_path / "before", tmp_path / "out"
    before.mkdir()
    out.mkdir()
    make_performance().save(before / "one.npz")
    kept = KeptCaptures(out, before, print)
    taken = kept.of("one", refuse_to_render)
    assert (taken.activations == make_performance().activations).all()
    assert Performance.load(out / "one.npz").fps == taken.fps
    with pytest.raises(AssertionError, match="was rendered"):
        kept.of("other", refuse_to_render)
