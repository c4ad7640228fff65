# SPDX-License-Identifier: GPL-3.0-or-later
import shutil

import pytest
from mimetic.media.footage import Footage
from mimetic.performance.document import Performance

# Where Blender's dialog has its buttons, pixels from the top left
ANSWERS = {"save": (800, 431), "do-not-save": (533, 431)}


@pytest.mark.parametrize("answer", ANSWERS)
def test_closing_in_the_middle_of_a_capture_asks_and_keeps_it(
    folder, screen, extension, clip, work, pictures, answer
):
    shutil.copy(extension, work)
    shutil.copy(clip, work)
    settings = {"extension": extension.name, "clip": clip.name, "answer": ANSWERS[answer]}
    # The question is answered by the screen's own mouse and keys
    way = {"seconds": 400, "is_simulated": False}
    result = folder.walk(screen, "walk_closing.py", work, pictures, settings, **way)
    assert not result.failures()
    (take,) = work.glob("*.performance.npz")
    performance = Performance.load(take)
    assert 10 <= performance.num_frames < Footage(clip).num_frames
    assert any(note.startswith("stopped by the user") for note in performance.notes)
