# SPDX-License-Identifier: GPL-3.0-or-later
"""A capture where Google's networks are not installed: lids and gaze by our own regressor."""

import numpy as np
import pytest
from mimetic import _core
from mimetic.fit.fitting import find_face
from mimetic.fit.line_fit import with_lines
from mimetic.locate.feature_networks import FILES, installed_networks
from mimetic.media.footage import Footage
from mimetic.performance.gaze import gaze_of, has_gaze
from mimetic.shared.installed_data import data_folder
from mimetic.solve import clip_capture
from mimetic.template.face_template import load_template

from evaluation.runs.real_labels import read_labels
from evaluation.runs.real_methods import by_capture
from evaluation.runs.real_score import score_places

AT_REST, LAST = 13, 20


@pytest.fixture
def without_networks(tmp_path, monkeypatch):
    for file in data_folder().iterdir():
        if file.name not in FILES:
            (tmp_path / file.name).symlink_to(file)
    monkeypatch.setenv("MIMETIC_DATA", str(tmp_path))
    assert installed_networks() is None


def test_a_tracker_is_not_made_of_no_source_at_all():
    camera = _core.Camera(600.0, 600.0, 319.5, 239.5, 640, 480)
    with pytest.raises(TypeError):
        _core.FeatureInputs([], None, camera, np.zeros((6, 3)))


def test_lids_are_where_they_were_marked_and_the_eyes_look_somewhere(
    fetched_clip, without_networks
):
    path = fetched_clip("single_face.mp4")
    found = find_face(np.ascontiguousarray(Footage(path).read(AT_REST)), AT_REST)
    fit = with_lines(found, (), load_template())
    performance = clip_capture.capture(path, (1, LAST), fit)
    labels = read_labels("single_face")
    labels = labels.rows(labels.frame <= LAST)
    figures = score_places(labels, "capture", by_capture(labels, performance)).figures
    assert figures["lids"]["median"] < 1.2  # % of the interpupillary distance; 1.6 by appearance
    assert figures["iris"]["median"] < 2.2  # 2.7 of eyes that look straight ahead
    assert has_gaze(performance)
    assert np.abs(gaze_of(performance)).max() < 30  # degrees
