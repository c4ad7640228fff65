# SPDX-License-Identifier: GPL-3.0-or-later
"""Sentences in panels are broken where the sidebar ends."""


def test_lines_are_as_wide_as_the_sidebar_at_most(extension):
    lines = extension("panels.paragraph").lines
    text = "the clip has 30 frames a second, the scene 24"
    for limit in (12, 20, 44, 100):
        broken = lines(text, limit, len)
        assert " ".join(broken) == text
        assert max(map(len, broken)) <= limit
    assert lines(text, 100, len) == [text]


def test_a_word_wider_than_the_sidebar_has_a_line_of_its_own(extension):
    lines = extension("panels.paragraph").lines
    assert lines("of a_name_without_end.mp4 there", 6, len) == [
        "of",
        "a_name_without_end.mp4",
        "there",
    ]
    assert lines("", 6, len) == []
