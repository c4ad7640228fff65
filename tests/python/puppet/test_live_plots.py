# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines of the last seconds: in their box, the newest at the right, a row for what moves."""

from types import SimpleNamespace

import numpy as np
import pytest
from mimetic.puppet.live_face import live_names
from mimetic.puppet.live_plots import HISTORY, LiveTrace
from mimetic.puppet.mapping import Mapping
from sample_taught import make_taught

BOX = (100.0, 50.0, 240.0, 260.0)  # left, bottom, width, height


@pytest.fixture(scope="module")
def names():
    return live_names()


def values_of(names, **values):
    row = np.zeros(len(names))
    for name, value in values.items():
        row[names.index(name)] = value
    return row


def curve_of(trace, plots, title):
    """The line (N x 2) of a row of a trace without a follower: each has one, of N points."""
    rows = [label.text.split("  ")[0] for label in plots.labels]
    pairs = np.split(plots.points, trace.num_rows)[rows.index(title)]
    return np.concatenate([pairs[:1], pairs[1::2]])


def test_without_a_moment_there_are_titles_and_no_lines(names):
    trace = LiveTrace(names)
    plots = trace.draw(*BOX)
    assert len(plots.points) == len(plots.colours) == 0
    titles = [label.text for label in plots.labels]
    assert len(titles) == trace.num_rows == 9
    assert titles[0] == "Lip corner pullers" and titles[-2:] == ["Jaw", "Upper lids"]


def test_a_jaw_that_opens_rises_and_the_newest_is_at_the_right(names):
    trace = LiveTrace(names)
    for n in range(50):
        trace.add(n / 25, values_of(names, jaw_open=n / 49))
    plots = trace.draw(*BOX)
    line = curve_of(trace, plots, "Jaw")
    assert len(line) == 50
    left, bottom, width, height = BOX
    assert line[-1, 0] == pytest.approx(left + width)
    assert line[0, 0] == pytest.approx(left + width * (1 - 49 / 25 / HISTORY))
    assert (np.diff(line[:, 1]) > 0).all()
    assert plots.points.min(axis=0) == pytest.approx([line[0, 0], plots.points[:, 1].min()])
    assert bottom <= plots.points[:, 1].min() and plots.points[:, 1].max() <= bottom + height
    assert any(label.text == "Jaw  1.00" for label in plots.labels)
    still = curve_of(trace, plots, "Brow raisers")
    assert np.ptp(still[:, 1]) == 0


def test_what_is_older_than_the_history_goes(names):
    trace = LiveTrace(names)
    for n in range(100):
        trace.add(n * HISTORY / 50, values_of(names))
    line = curve_of(trace, trace.draw(*BOX), "Jaw")
    assert len(line) == 51 and line[0, 0] == pytest.approx(BOX[0])
    trace.add(0.0, values_of(names))  # a source from its beginning
    trace.add(0.1, values_of(names))
    assert len(curve_of(trace, trace.draw(*BOX), "Jaw")) == 2


def test_scores_of_a_taught_set_have_rows_of_their_own_above(names):
    taught = make_taught()
    follower = SimpleNamespace(
        taught=taught,
        mapping=Mapping(taught),
        scores=np.full(len(taught.template_parts), 0.5),
        said=np.full(len(names), np.nan),
    )
    follower.said[names.index("jaw_open")] = 0.7
    trace = LiveTrace(names, follower)
    for n in range(10):
        follower.scores[4] = 0.5 + 0.05 * n  # the smile's mouth
        trace.add(n / 25, values_of(names, jaw_open=0.2))
    plots = trace.draw(*BOX)
    texts = [label.text for label in plots.labels]
    assert len(texts) == 11 and "mouth: smile  0.95" in texts[:2]
    above = min(label.place[1] for label in plots.labels[:2])
    assert above > max(label.place[1] for label in plots.labels[2:])
    # 5 templates, 9 rows of controls, and fainter what the set says of the jaw
    assert len(plots.points) == (5 + 9 + 1) * 18
    faint = plots.colours[:, 3] < 1
    assert faint.sum() == 18
    jaw = next(label for label in plots.labels if label.text.startswith("Jaw"))
    assert plots.points[faint][:, 1].min() < jaw.place[1]
