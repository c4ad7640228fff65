# SPDX-License-Identifier: GPL-3.0-or-later
"""A person whose head is of another make, made and attached once for the tests of this folder."""

import pytest
from mimetic.character.foreign_head import attach_foreign
from mimetic.muscles import anatomy
from mimetic.template.face_template import load_template

from evaluation.anatomy.foreign_agreement import disguise


@pytest.fixture(scope="session")
def template():
    return load_template()


@pytest.fixture(scope="session")
def head(template):
    """Another person, meshed anew, 1.3 times as large, turned and moved, with eyes and teeth."""
    return disguise(template, seed=3, identity=0.25, kept=0.75)


@pytest.fixture(scope="session")
def direct(template, head):
    return anatomy.attach(head.mesh.neutral, template)


@pytest.fixture(scope="session")
def foreign(template, head):
    return attach_foreign(head.vertices, head.faces, head.landmarks, template)
