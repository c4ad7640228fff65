# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks that are worth teaching, and the parts of the face that each is of."""

from __future__ import annotations

from mimetic.puppet.set_making import REST

# Names for lists of looks; a part's words are those of `taught_look.SHORT` and `parts.KINDS`, and
# without any a look is of all parts in which it differs from the others
USUAL_LOOKS: dict[str, tuple[str, ...]] = {
    REST: (),
    "smile": (),
    "surprise": (),
    "brows raised": ("brows",),
    "eyes open": ("eyes",),
    "eyes closed": ("eyes",),
    "eyes left": ("eyes",),
    "eyes right": ("eyes",),
    "mouth open": ("mouth",),
    "mouth closed": ("mouth",),
    "mouth smiling": ("mouth",),
    "mouth pursed": ("mouth",),
}
# Asked for one after the other where none is named
ASKED_FOR = (REST, "smile", "mouth open", "mouth pursed", "brows raised", "eyes closed")
