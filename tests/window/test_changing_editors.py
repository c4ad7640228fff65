# SPDX-License-Identifier: GPL-3.0-or-later
import shutil


def test_work_goes_on_while_editors_and_windows_come_and_go(
    folder, screen, extension, clip, work, pictures
):
    for path in (extension, clip):
        shutil.copy(path, work)
    settings = {"extension": extension.name, "clip": clip.name}
    result = folder.walk(
        *(screen, "walk_changing_editors.py", work, pictures, settings),
        seconds=500,
        beside=("over_footage.py",),
    )
    assert not result.failures()
