# SPDX-License-Identifier: GPL-3.0-or-later
"""How many keys a bake sets."""

from __future__ import annotations

from bpy.app.translations import pgettext_iface as iface_
from bpy.props import BoolProperty, FloatProperty


class FewKeysOptions:
    """Mixin of operators that set few keys: how few, and where first."""

    tolerance: FloatProperty(
        name="Tolerance",
        default=0.02,
        min=0.001,
        max=0.5,
        precision=3,
        description="By how much few keys may miss a curve, of which 1 is a full activation, or a "
        "centimetre or ten degrees of a bone",
    )
    use_phases: BoolProperty(
        name="At Phases",
        default=False,
        description="Keys at onset, apex, release and end of each event first",
    )


class KeyOptions(FewKeysOptions):
    """Mixin of operators that bake a face."""

    KEYS = ("Keys", ("use_few_keys", "tolerance", "use_phases"), False)

    use_few_keys: BoolProperty(
        name="Few Keys",
        default=False,
        description="Keys with handles where something changes, to drag, instead of one a frame",
    )

    def is_in_use(self, name: str) -> bool:
        return self.use_few_keys or name not in {"tolerance", "use_phases"}

    def few_keys(self) -> tuple[float, bool]:
        """Tolerance, 0 for a key a frame, and whether phases come first, as bakes take them."""
        return self.tolerance if self.use_few_keys else 0.0, self.use_phases

    def key_remarks(self) -> list[str]:
        """The same for the list of takes."""
        if not self.use_few_keys:
            return [iface_("a key a frame")]
        parts = [iface_("few keys within {tolerance:.3g}").format(tolerance=self.tolerance)]
        return [*parts, iface_("at phases")] if self.use_phases else parts
