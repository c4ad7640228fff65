# SPDX-License-Identifier: GPL-3.0-or-later
import shutil


def test_zip_installs_and_shows_its_panel(folder, screen, extension, work, pictures):
    shutil.copy(extension, work)
    result = folder.walk(
        screen, "walk_install.py", work, pictures, {"extension": extension.name}, seconds=300
    )
    assert not result.failures()
    assert result.pictures["panel"].stat().st_size > 10_000
