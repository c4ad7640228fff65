# SPDX-License-Identifier: GPL-3.0-or-later
"""How much at rest a person found the frames of a clip, and the frame that is taken."""

import pytest
from mimetic import InvalidInput

from evaluation.runs import real_rest
from evaluation.runs.real_rest import Part, figures, read_parts, scored


def test_every_part_of_the_table_has_frames_of_the_kinds_it_is_for():
    parts = read_parts("franck")
    assert len(parts) == 15
    for part in parts:
        assert part.last - part.first < 250 and len(part.ratings) == 24
        assert 0 in part.ratings.values() or max(part.ratings.values()) == 2


def test_figures_are_of_the_frames_that_were_taken():
    part = Part("clip", 1, 30, {1: 0, 10: 2, 20: 1, 30: 1})
    scores = [scored(part, frame) for frame in (10, 12, 19, 0)]  # 0: no face was found
    assert [score.rating for score in scores] == [2, 2, 1, 0]
    found = figures(scores)
    assert (found["at_rest"], found["nearly"], found["not"]) == (0.5, 0.25, 0.25)
    assert found["missed"] == pytest.approx(0.75) and found["chance"] == pytest.approx(1.0)


@pytest.mark.parametrize("row", ["1,9,10,2", "1,9,3,3", "1,9,3,", "1,9,x,1"])
def test_a_table_with_a_wrong_row_is_refused(row, tmp_path, monkeypatch):
    monkeypatch.setattr(real_rest, "FOLDER", tmp_path)
    (tmp_path / "clip.rest.csv").write_text(f"first,last,frame,rest\n{row}\n")
    with pytest.raises(InvalidInput, match=r"clip\.rest\.csv"):
        read_parts("clip")
