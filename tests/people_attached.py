# SPDX-License-Identifier: GPL-3.0-or-later
"""Captures of one person in many tests, whose skin is solved in the first of them alone."""

import functools
from contextlib import contextmanager

KEPT = 4  # people in memory, some 40 MB each
TABLES = ("muscles.toml", "materials.toml", "extras.toml")


@contextmanager
def people_attached_once():
    """Muscles and detail of a capture depend on the head at rest, its calibration and the tables
    alone, by which they are kept; they are most of what a capture of few frames costs."""
    from mimetic.muscles import anatomy
    from mimetic.solve import clip_capture

    def tables() -> str:
        return repr([anatomy.load_table(name) for name in TABLES])

    def person(_capture, skin):
        has_lips = bool(clip_capture.installed_networks())
        return skin.mesh.neutral.tobytes(), repr(skin.calibration), has_lips, tables()

    def mesh_and_how(mesh, *how):
        return mesh.neutral.tobytes(), *how, tables()

    capture = clip_capture.ClipCapture
    attach, detail_of = capture.attach, clip_capture.detail_of
    capture.attach = _keeping(attach, person)
    clip_capture.detail_of = _keeping(detail_of, mesh_and_how)
    try:
        yield
    finally:
        capture.attach, clip_capture.detail_of = attach, detail_of


def _keeping(make, key_of):
    """`make`, whose last results are kept by `key_of` its arguments."""
    kept = {}

    @functools.wraps(make)
    def kept_or_made(*arguments):
        key = key_of(*arguments)
        result = kept.pop(key) if key in kept else make(*arguments)
        kept[key] = result  # the most recently used last
        while len(kept) > KEPT:
            kept.pop(next(iter(kept)))
        return result

    return kept_or_made
