# SPDX-License-Identifier: GPL-3.0-or-later
"""What names, tooltips and grey buttons say: as Blender's own, with units, and what mends it."""

import re

import bpy
import pytest

# One of them says in what a number is counted
UNITS = re.compile(
    r"frame|second|\bmm\b|metre|degree|pixel|level|deviation|multipl|factor|times|exponent|"
    r"\b1 is|\b1 leaves|\bto 1\b|, 1\b|of which 1|\b0:|\b0 |of the distances|job|\brow\b|"
    r"own units|number",
    re.IGNORECASE,
)
SMALL = {"a", "and", "as", "at", "by", "from", "if", "in", "of", "on", "or", "over", "the", "to"}
# What has to be done in Blender itself, not by a button of ours
BY_HAND = re.compile(r"^(Select|Choose|Leave|Switch)\b|clip editor|Blender's window")
# There is nothing to mend
NOTHING_TO_DO = re.compile(r"^No (job|live|performance and no)|as it was filmed")


def shown_properties(extension):
    """Owner's name and property of all that a panel, a redo panel or a script may show."""
    blenders = {*bpy.types.Operator.bl_rna.properties.keys(), "filepath", "check_existing"}
    operators = [
        getattr(bpy.ops.mimetic, one.bl_idname.removeprefix("mimetic.")).get_rna_type()
        for one in extension("operators").CLASSES
    ]
    groups = [group.bl_rna for group in extension("properties").CLASSES]
    for kind in (*operators, *groups):
        for prop in kind.properties:
            if prop.identifier not in blenders and prop.name != prop.identifier:
                yield kind.identifier, prop


def test_every_property_says_what_it_is_as_blenders_own_do(extension):
    bad = [
        f"{owner}.{prop.identifier}: {prop.description!r}"
        for owner, prop in shown_properties(extension)
        if not re.match(r"[A-Z0-9].*[^.\s]$", prop.description, re.DOTALL)
    ]
    assert not bad, "\n".join(bad)


def test_every_number_says_in_what_it_is_counted(extension):
    bad = [
        f"{owner}.{prop.identifier}: {prop.description!r}"
        for owner, prop in shown_properties(extension)
        if prop.type in {"INT", "FLOAT"}
        and (prop.subtype, prop.unit) == ("NONE", "NONE")
        and not UNITS.search(prop.description or prop.name)
    ]
    assert not bad, "\n".join(bad)


def test_names_are_in_blenders_title_case(extension):
    bad = []
    for owner, prop in shown_properties(extension):
        words = re.findall(r"[A-Za-z][a-z']+", prop.name)
        if any(word[0].islower() and word not in SMALL for word in words):
            bad.append(f"{owner}.{prop.identifier}: {prop.name}")
    assert not bad, "\n".join(bad)


def test_buttons_and_panels_are_named_in_title_case_and_explained(extension):
    bad = []
    for one in (*extension("operators").CLASSES, *extension("panels").CLASSES):
        label = getattr(one, "bl_label", "").replace("glTF", "")  # has a spelling of its own
        words = re.findall(r"[A-Za-z][a-z']+", label)
        if any(word[0].islower() and word not in SMALL for word in words):
            bad.append(f"{one.__name__}: {one.bl_label}")
    for one in extension("operators").CLASSES:
        text = getattr(one, "bl_description", "") or one.__doc__ or ""
        if not re.match(r"[A-Z].*[^.\s]$", text, re.DOTALL):
            bad.append(f"{one.__name__}: {text!r}")
    assert not bad, "\n".join(bad)


def grey_reasons(extension) -> dict[str, str]:
    reasons = {}
    for one in extension("operators").CLASSES:
        obstacle = getattr(one, "obstacle", None)
        if obstacle is not None and (reason := obstacle(bpy.context)):
            reasons[one.bl_idname] = reason
    return reasons


@pytest.mark.parametrize("with_footage", [False, True])
def test_a_grey_button_names_the_button_that_mends_it(extension, footage, with_footage):
    if with_footage:
        bpy.ops.mimetic.load_clip(filepath=str(footage))
    labels = {one.bl_label for one in extension("operators").CLASSES if one.bl_label}
    reasons = grey_reasons(extension)
    assert len(reasons) > 20
    unhelpful = {
        name: reason
        for name, reason in reasons.items()
        if not (BY_HAND.search(reason) or NOTHING_TO_DO.search(reason))
        and not any(label in reason for label in labels)
    }
    assert unhelpful == {}
