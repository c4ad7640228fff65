# SPDX-License-Identifier: GPL-3.0-or-later
"""What a command says before it works on a clip."""

from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace

from mimetic.commands.on_clip import beginning


def test_a_run_says_at_its_start_what_it_will_do():
    footage = SimpleNamespace(path=Path("folder/clip.mp4"), fps=Fraction(25))
    text = beginning(footage, (11, 60), None)
    assert text.startswith("clip.mp4: finding the face, following it through 50 frames from 11 on")
    assert "(2.0 s)" in text and "Ctrl-C keeps" in text
    assert "finding" not in beginning(footage, (11, 60), SimpleNamespace(frame=20))
    assert "following it through 1 frame from 11 on" in beginning(footage, (11, 11), None)


def test_a_run_that_begins_far_from_its_reference_frame_says_so():
    footage = SimpleNamespace(path=Path("folder/clip.mp4"), fps=Fraction(25))
    text = beginning(footage, (200, 249), SimpleNamespace(frame=20))
    way = "following the face through 180 frames from the reference frame 20 to 200, then"
    assert f"{way} following it through 50 frames from 200 on" in text
