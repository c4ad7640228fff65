# SPDX-License-Identifier: GPL-3.0-or-later
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))


@pytest.fixture(scope="session")
def rendered_clip():
    """A rendered head that raises its brows and opens its mouth: `.footage`, `.truth` paths.

    50 frames of 320 x 240. Rendered by Blender in about 20 s the first time, then taken from the
    cache; never fetched.
    """
    from mimetic.face_template import load_template

    from evaluation.clips import clip
    from evaluation.recipes import TEST

    return clip(TEST, load_template())
