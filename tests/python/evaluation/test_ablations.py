# SPDX-License-Identifier: GPL-3.0-or-later
"""Ablations are put together right; the captures themselves are not made here."""

import json
from argparse import Namespace
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from mimetic import _core
from mimetic.solve import clip_capture
from sample_performance import make_performance
from sample_truth import make_truth

from evaluation.runs import ablations


@pytest.fixture
def made(monkeypatch):
    """Figures of two clips, the second of a still face; "no smoother" finds no muscle."""
    performance = make_performance(num_frames=6)
    truth = make_truth(performance)
    still = replace(truth, muscles=None, groups=None, activations=None)
    shown = {"moving": truth, "still": still}
    clips = [Namespace(name=name, footage=Path(name), truth=name) for name in shown]
    lost = replace(performance, activations=np.zeros_like(performance.activations))
    monkeypatch.setattr(ablations, "clips_of", lambda which, people, report: clips)
    monkeypatch.setattr(ablations.Truth, "load", lambda name: shown[name])
    monkeypatch.setattr(clip_capture, "find_face", lambda footage: "the clip's fit")

    def capture(footage, fit, variant):
        assert (footage.name, fit) == ("moving", "the clip's fit")
        return performance if variant.smoothed else lost

    monkeypatch.setattr(ablations, "capture_varied", capture)
    return ablations.score_ablations("tuning", None, lambda line: None)


def test_every_variant_of_every_clip_that_moves_is_scored(made):
    assert list(made) == [f"moving: {name}" for name in ablations.VARIANTS]
    assert made["moving: as it is"]["image"] == pytest.approx(1, abs=1e-6)
    assert made["moving: as it is"]["groups"] == pytest.approx(1)
    assert made["moving: no smoother"]["image"] < 0.95
    assert made["moving: no smoother"]["groups"] == 0


def test_tables_hold_every_figure(made):
    lines = ablations.as_text(made).splitlines()
    assert len(lines) == 1 + len(made)
    assert "1.000" in lines[1] and "moving: as it is" in lines[1]
    read = json.loads(ablations.as_json(made))
    assert read["figures"].keys() == made.keys()
    assert read["variants"].keys() == ablations.VARIANTS.keys()


def test_variants_differ_in_options_that_there_are():
    for variant in ablations.VARIANTS.values():
        options = _core.TrackerOptions()
        for name, value in variant.tracker.items():
            assert getattr(options, name) != value
            setattr(options, name, value)
