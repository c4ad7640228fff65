# SPDX-License-Identifier: GPL-3.0-or-later
from mimetic.shared.counted import counted


def test_one_thing_is_told_as_one():
    assert [counted(number, "frame") for number in range(3)] == ["0 frames", "1 frame", "2 frames"]
