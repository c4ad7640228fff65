# SPDX-License-Identifier: GPL-3.0-or-later
"""What corrections state in a frame, as lines of a panel."""

from __future__ import annotations

from dataclasses import dataclass

from bpy.app.translations import pgettext_iface as iface_

from . import native

VALUE_TEXTS = {
    "gap": "{name} {value:.1f} mm",
    "angle": "{name} {value:.1f}\N{DEGREE SIGN}",
    "signed": "{name} {value:+.2f}",
    "closing": "{name} {value:+.2f}",
    "share": "{name} {value:.2f}",
}

LONGEST, END = 28, 9  # letters of a name, and of its end where it is longer: a sidebar is narrow


@dataclass(frozen=True)
class StatedPart:
    name: str  # as `delete_correction` takes it
    text: str
    icon: str
    operator: str = ""  # that states it again; pins are dragged


def stated_parts(entry) -> list[StatedPart]:
    """Of a frame's entry, in the order of `correcting.parts_of`."""
    correcting = native.correcting()
    return [_part(entry, name, correcting) for name in correcting.parts_of(entry)]


def _part(entry, name: str, correcting) -> StatedPart:
    if name.startswith(correcting.PIN):
        number = int(name.removeprefix(correcting.PIN))
        x, y = entry.pins[number - 1].pixel
        text = iface_("Pin {number} at {x:.0f}, {y:.0f}").format(number=number, x=x, y=y)
        return StatedPart(name, text, "PINNED")
    if name == correcting.POSE:
        return StatedPart(name, iface_("Pose"), "ORIENTATION_GIMBAL", "mimetic.correct_pose")
    kind = correcting.kind_of(name)
    value = correcting.pinned_at((entry,), entry.frame, name).value
    short = name
    if len(name) > LONGEST:
        short = f"{name[: LONGEST - END]}\N{HORIZONTAL ELLIPSIS}{name[-END:]}"
    text = VALUE_TEXTS[kind].format(name=short, value=1000 * value if kind == "gap" else value)
    return StatedPart(name, text, "DRIVER", "mimetic.correct_value")
