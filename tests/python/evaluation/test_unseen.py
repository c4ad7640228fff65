# SPDX-License-Identifier: GPL-3.0-or-later
"""What two ways to see a face have in common, on clips without marks."""

import numpy as np
import pytest

from evaluation.runs import unseen
from evaluation.runs.real_labels import POINTS

AT = {name: i for i, name in enumerate(POINTS)}


def face(num_frames=20, size=80.0, roll=0.0):
    """A face whose lids and lips open and close; pixels."""
    places = np.zeros((num_frames, len(POINTS), 2))
    phase = np.sin(np.linspace(0, 6, num_frames))
    for side, sign in (("R", -1), ("L", 1)):
        places[:, AT[f"eye_outer.{side}"]] = (sign * 0.7, 0)
        places[:, AT[f"eye_inner.{side}"]] = (sign * 0.3, 0)
        for lid, way in (("upper", -1), ("lower", 1)):
            places[:, AT[f"lid_{lid}.{side}"], 0] = sign * 0.5
            places[:, AT[f"lid_{lid}.{side}"], 1] = way * (0.08 + 0.05 * phase)
        places[:, AT[f"mouth_corner.{side}"], 0] = sign * (0.4 + 0.05 * phase)
        places[:, AT[f"mouth_corner.{side}"], 1] = 1.1 - 0.1 * phase
    for edge, way in (("upper", -1), ("lower", 1)):
        places[:, AT[f"lip_inner_{edge}"], 1] = 1.1 + way * (0.1 + 0.1 * phase)
    turn = np.array([[np.cos(roll), np.sin(roll)], [-np.sin(roll), np.cos(roll)]])
    return size * places @ turn + 200


def test_movements_are_shares_of_the_pupils_distance_however_the_head_is_rolled():
    small, large = (unseen.movements(face(size=s, roll=r)) for s, r in ((40, 0), (90, 0.5)))
    for way, values in small.items():
        np.testing.assert_allclose(values, large[way], atol=1e-9)
    assert small["lids"].shape == (20, 2) and small["lips"].shape == (20, 1)
    assert small["lips"][0, 0] == pytest.approx(20)
    assert small["width"][0, 0] == pytest.approx(80)


def test_an_offset_counts_for_nothing_and_a_lid_that_stays_for_much():
    mesh = face()
    ours = mesh.copy()
    ours[:, AT["lip_inner_lower"], 1] += 3
    for side in "RL":
        ours[:, AT[f"lid_upper.{side}"]] = ours[0, AT[f"lid_upper.{side}"]]
        ours[:, AT[f"lid_lower.{side}"]] = ours[0, AT[f"lid_lower.{side}"]]
    ours[5] = np.nan  # held
    figures = unseen.compared(ours, mesh)
    assert figures["lips r"] == pytest.approx(1) and figures["lips left"] == pytest.approx(0)
    assert figures["corners left"] == pytest.approx(0)
    assert figures["lids left"] > 1 and np.isnan(figures["lids r"])


def test_the_slope_tells_a_mouth_that_opens_half_as_far():
    mesh = face()
    ours = mesh.copy()
    for edge in ("upper", "lower"):
        ours[:, AT[f"lip_inner_{edge}"]] = (mesh[0] + (mesh - mesh[0]) / 2)[
            :, AT[f"lip_inner_{edge}"]
        ]
    figures = unseen.compared(ours, mesh)
    assert figures["lips slope"] == pytest.approx(0.5)
    assert figures["lids slope"] == pytest.approx(1)


def test_without_frames_in_common_there_are_no_figures():
    assert unseen.compared(np.full((20, len(POINTS), 2), np.nan), face()) == {}


def test_a_clip_that_was_not_fetched_is_told(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(unseen, "FOLDER", tmp_path)
    monkeypatch.setattr(unseen, "face_mesh_python", lambda _: None)
    assert unseen.main([]) == 2
    assert "scripts/fetch_footage --more" in capsys.readouterr().err
