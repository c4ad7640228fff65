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


def test_a_word_wider_than_the_sidebar_is_broken_where_it_has_a_mark(extension):
    lines = extension("panels.paragraph").lines
    broken = lines("of a_name_without_end.mp4 there", 9, len)
    assert broken == ["of", "a_name_", "without_", "end.mp4", "there"]
    assert lines("abcdefghij", 4, len) == ["abcd", "efgh", "ij"]
    assert lines("", 6, len) == []


def test_a_text_of_one_line_loses_its_middle(extension):
    shortened = extension("panels.paragraph").shortened
    assert shortened("interview_sc03_tk07", 100, len) == "interview_sc03_tk07"
    assert shortened("interview_sc03_tk07", 10, len) == "inter…tk07"
    assert len(shortened("interview_sc03_tk07", 1, len)) == 3
