# SPDX-License-Identifier: GPL-3.0-or-later
"""Work beside a process in which OpenCV's threads are at work already."""

import os

import pytest
from mimetic import InvalidInput
from mimetic.muscles.anatomy import attach_skin, modes_of
from mimetic.template.face_template import load_template

from evaluation.runs.own_process import in_own_process


def attached_muscles() -> tuple[int, int]:
    template = load_template()
    anatomy = modes_of(attach_skin(template.vertices, template))
    return os.getpid(), len(anatomy.muscle_names)


def test_what_uses_threads_ends_beside_a_process_that_used_them():
    here, num_muscles = attached_muscles()
    there, same = in_own_process(attached_muscles)
    assert there != here
    assert same == num_muscles


def refuse() -> None:
    raise InvalidInput("refused")


def test_what_it_raises_is_raised_here():
    with pytest.raises(InvalidInput, match="refused"):
        in_own_process(refuse)
