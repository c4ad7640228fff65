# SPDX-License-Identifier: GPL-3.0-or-later
import shutil


def test_a_face_follows_a_clip_live_and_a_take_is_recorded(
    folder, screen, extension, clip, work, pictures
):
    for path in (extension, clip):
        shutil.copy(path, work)
    settings = {"extension": extension.name, "clip": clip.name}
    result = folder.walk(screen, "walk_live.py", work, pictures, settings, seconds=400)
    assert not result.failures()


def test_looks_are_taught_while_a_clip_runs(folder, screen, extension, clip, work, pictures):
    for path in (extension, clip):
        shutil.copy(path, work)
    settings = {"extension": extension.name, "clip": clip.name}
    result = folder.walk(screen, "walk_live_looks.py", work, pictures, settings, seconds=400)
    assert not result.failures()
