# SPDX-License-Identifier: GPL-3.0-or-later
import shutil

from mimetic.performance.document import Performance


def test_closing_in_the_middle_of_a_capture_keeps_it(
    folder, screen, extension, clip, work, pictures
):
    shutil.copy(extension, work)
    shutil.copy(clip, work)
    settings = {"extension": extension.name, "clip": clip.name}
    result = folder.walk(screen, "walk_closing.py", work, pictures, settings, seconds=300)
    assert not result.failures()
    (take,) = work.glob("*.performance.npz")
    performance = Performance.load(take)
    assert 10 <= performance.num_frames < 200
    assert any(note.startswith("stopped by the user") for note in performance.notes)
