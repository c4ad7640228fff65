# SPDX-License-Identifier: GPL-3.0-or-later
"""Units that jaw and lids do are compared with what jaw and lids do."""

from dataclasses import replace

import numpy as np
import pytest
from mimetic import InvalidInput
from mimetic.analyse.comparison import compare
from mimetic.analyse.tables import phase_rows
from mimetic.analyse.timing import analyse_timing
from mimetic.muscles.action_units import action_unit
from mimetic.template.face_template import load_template
from test_comparison import FRAMES, moved_by

NAMES = ["jaw_open", "lid_upper.L", "lid_upper.R"]
EARLY, LATE, LAST = ((1, 4, 7, 10), (22, 26, 30, 35), (38, 41, 44, 48))


@pytest.fixture(scope="module")
def template():
    return load_template()


def ramp(rows, height):
    return np.interp(np.arange(FRAMES), rows, (0, height, height, 0))


def acted(template, jaw=0.0, lids=(0.0, 0.0)):
    """Muscles of groups 4 and 7 act early; the jaw late, by AU26; lids late, then last."""
    plain = moved_by(template, "AU12")
    muscles = np.repeat(ramp(EARLY, 0.9)[:, None], 4, axis=1)
    lid = ramp(LATE, lids[0]) + ramp(LAST, lids[1])
    mode = action_unit("AU26", template.vertices, template).mode
    values = np.column_stack([ramp(LATE, jaw), lid, lid])
    return replace(
        plain,
        groups=np.array([4, 4, 7, 7]),
        activations=muscles,
        articulators=NAMES,
        articulator_values=values,
        articulator_values_std=np.full(values.shape, 0.02),
        articulator_modes=np.stack([mode, 0 * mode, 0 * mode]).astype(np.float32),
    )


def test_a_jaw_drop_is_the_jaws_and_not_the_chins(template):
    timing = analyse_timing(acted(template, jaw=0.8), kinds=("group",))
    comparison = compare(timing, "AU26", template)
    peak = comparison.performance.frame[comparison.rows[comparison.peak]]
    assert 26 <= peak <= 31 and comparison.rows[0] >= EARLY[3]
    assert comparison.spatial.intensity == pytest.approx(0.8, abs=0.02)
    assert compare(timing, "AU23", template).event.curve.group == 4


@pytest.mark.parametrize(("unit", "span"), [("AU43", LATE), ("AU5", LAST)])
def test_lids_that_close_and_rise_are_told_apart(template, unit, span):
    timing = analyse_timing(acted(template, lids=(0.9, -0.4)), kinds=("group",))
    event = compare(timing, unit, template).event
    assert event.number == 1 and event.fit.shape.amplitude == pytest.approx(
        0.9 if unit == "AU43" else 0.4, abs=0.05
    )
    assert span[0] <= event.curve.values.argmax() <= span[3]


def test_a_lid_at_rest_between_two_blinks_was_not_raised(template):
    timing = analyse_timing(acted(template, lids=(0.9, 0.9)), kinds=("group",))
    with pytest.raises(InvalidInput, match="the raising of the upper lids, which is what AU5 does"):
        compare(timing, "AU5", template)


def test_a_jaw_that_stays_shut_is_said_and_no_group(template):
    timing = analyse_timing(acted(template), kinds=("group",))
    with pytest.raises(InvalidInput, match=r"^the opening of the jaw, which is what AU26 does"):
        compare(timing, "AU26", template)
    with pytest.raises(InvalidInput, match="--event 3: the opening of the jaw has 0 events"):
        compare(timing, "AU26", template, 3)


def test_events_of_jaw_and_lids_are_counted_as_in_the_table_of_phases(template):
    timing = analyse_timing(acted(template, jaw=0.8, lids=(0.9, 0.9)))
    rows = [row for row in phase_rows(timing) if row["kind"] == "articulator"]
    jaw, lids = "opening of the jaw", "closing of the upper lids"
    assert [(row["name"], row["group"], row["event"]) for row in rows] == [
        *((jaw, "", 1), (lids, "", 1), (lids, "", 2)),
    ]
    second = compare(timing, "AU43", template, 2).event
    assert second.fit.onset.value == pytest.approx(rows[2]["onset_frame"], abs=1e-9)
