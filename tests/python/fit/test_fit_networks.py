# SPDX-License-Identifier: GPL-3.0-or-later
"""The first fit with the networks' eyes and lips: nearer to points marked by hand on real faces."""

import numpy as np
import pytest
from mimetic import _core
from mimetic.fit import network_evidence
from mimetic.fit.fitting import find_face
from mimetic.locate.feature_networks import FILES
from mimetic.media.footage import Footage
from mimetic.muscles.feature_lines import feature_lines
from mimetic.shared.installed_data import data_folder
from mimetic.template.face_template import load_template

from evaluation.runs.real_labels import read_labels
from evaluation.runs.real_methods import by_fit
from evaluation.runs.real_score import score_places

needs_networks = pytest.mark.skipif(
    not (data_folder() / FILES[0]).exists(), reason="scripts/make_networks was not run"
)


def test_lines_run_from_corner_to_corner_on_both_sides_alike():
    template = load_template()
    lines = feature_lines(template)
    x, y = template.vertices[:, 0], template.vertices[:, 1]
    assert len(lines) == 8
    for name, line in lines.items():
        middle = line[len(line) // 2]
        if name.startswith("lip"):
            assert [int(template.mirror[v]) for v in line] == line[::-1]
            assert x[line[0]] < -0.02 < 0.02 < x[line[-1]]
        else:
            other = name[:-1] + ("R" if name.endswith("L") else "L")
            assert [int(template.mirror[v]) for v in line] == lines[other]
        if not name.endswith("inner"):
            assert (y[middle] > y[line[0]]) == ("upper" in name)
    heights = [
        y[lines[name]].mean()
        for name in ("lip_upper", "lip_upper_inner", "lip_lower_inner", "lip_lower")
    ]
    assert heights == sorted(heights, reverse=True)


@pytest.fixture(scope="module")
def marked(fetched_clip):
    """Footage of a real person, and the points that were marked in three frames at rest."""
    footage = Footage(fetched_clip("single_face.mp4"))
    labels = read_labels("single_face")
    return footage, labels.rows(np.isin(labels.frame, (1, 13, 17)))


@needs_networks
def test_lids_and_lips_of_the_first_fit_are_where_they_were_marked(marked):
    footage, labels = marked
    figures = score_places(labels, "first fit", by_fit(labels, footage)).figures
    assert figures["outer lips"]["median"] < 4  # % of the interpupillary distance
    assert figures["inner lips"]["median"] < 3
    assert figures["lids"]["median"] < 1.5


LIDS = {f"lid_{lid}.{side}" for lid in ("upper", "lower") for side in "LR"}


def test_without_networks_lids_are_the_regressors_and_the_mouth_the_landmarks(marked, monkeypatch):
    footage, labels = marked
    monkeypatch.setattr(network_evidence, "installed_networks", lambda: None)
    image = np.ascontiguousarray(footage.read(int(labels.frame[0])))
    view = find_face(image, 1).views[0].measured
    assert LIDS < {curve.name for curve in view.curves} <= {"jaw", "lip_line", *LIDS}
    figures = score_places(labels, "first fit", by_fit(labels, footage)).figures
    assert figures["lids"]["median"] < 1.2  # landmarks alone have 1.8


def test_lids_that_move_by_themselves_leave_corners_that_no_network_saw(marked, monkeypatch):
    footage, labels = marked
    monkeypatch.setattr(network_evidence, "installed_networks", lambda: None)
    image = np.ascontiguousarray(footage.read(int(labels.frame[0])))
    joined = find_face(image, 1).views[0].measured
    local = _core.local_features(joined, 1)
    assert {feature.name for feature in local.features} == {"pupil.L", "pupil.R"}
    assert {curve.name for curve in local.curves} == LIDS
