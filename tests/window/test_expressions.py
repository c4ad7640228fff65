# SPDX-License-Identifier: GPL-3.0-or-later
import shutil

import numpy as np
from mimetic.library.expression import Expression

KEPT = {
    "smile": {"zygomaticus_major.L": 0.8, "zygomaticus_major.R": 0.8},
    "brows": {"frontalis_middle.L": 0.7, "frontalis_middle.R": 0.7},
}


def test_expressions_are_blended_browsed_and_sequenced(folder, screen, extension, work, pictures):
    shutil.copy(extension, work)
    (work / "library").mkdir()
    rise = np.sin(np.pi * np.arange(31) / 30) ** 2
    for name, channels in KEPT.items():
        values = np.outer(rise, list(channels.values()))
        kept = Expression(list(channels), values, 0 * values, 30.0)
        kept.save(work / "library" / f"{name}.expression.npz")
    result = folder.walk(
        screen, "walk_expressions.py", work, pictures, {"extension": extension.name}, seconds=400
    )
    assert not result.failures()
    taken = ("expression-dragged", "expression-assets", "expression-strips", "curves-few")
    for name in taken:
        assert result.pictures[name].stat().st_size > 10_000, name
