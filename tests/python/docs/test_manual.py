# SPDX-License-Identifier: GPL-3.0-or-later
"""The manual's pages that say what the program says are as the program says it now."""

import ast
import re

import addon_sources
import message_texts
import messages
import pytest
from make import WRITTEN
from manual_pages import ROOT

GUIDE = ROOT / "docs" / "guide"


@pytest.mark.parametrize("name", WRITTEN)
def test_written_pages_are_up_to_date(name):
    """`scripts/make_manual` writes them."""
    assert (GUIDE / name).read_text(encoding="utf-8") == WRITTEN[name]()


def test_every_panel_and_button_is_in_the_manual():
    page = (GUIDE / "panels.md").read_text(encoding="utf-8")
    panels = [panel.label for panel in addon_sources.panels()]
    assert len(panels) >= 9 and [label for label in panels if f"\n## {label}\n" not in page] == []
    buttons = [one for one in addon_sources.operators() if not one.is_internal]
    assert len(buttons) >= 40
    assert [one.idname for one in buttons if f"| **{one.label}** |" not in page] == []


def test_every_panel_has_its_picture_on_the_page():
    """scripts/panel_pictures takes them; a new one is a step in tests/window/walk_panels.py."""
    page = (GUIDE / "panels.md").read_text(encoding="utf-8")
    names = [name for panel in addon_sources.panels() for name in panel.names]
    declared = re.findall(
        r"^class MIMETIC_PT_(\w+)",
        "".join(path.read_text() for path in (addon_sources.ADDON / "panels").glob("*.py")),
        re.MULTILINE,
    )
    assert sorted(names) == sorted(declared) and len(names) >= 13
    for name in names:
        assert f"(../images/panels/{name}.png)" in page, name
        size = (ROOT / "docs" / "images" / "panels" / f"{name}.png").stat().st_size
        assert 1000 < size < 40_000, name


def test_operators_are_read_from_the_sources_whole():
    """As many as register: none is missed by the way that it is written."""
    text = "".join(
        path.read_text(encoding="utf-8")
        for path in (ROOT / "blender_addon" / "mimetic" / "operators").glob("*.py")
    )
    names = set(re.findall(r'bl_idname = "(mimetic\.\w+)"', text))
    assert {one.idname for one in addon_sources.operators()} == names


def test_every_button_and_setting_has_a_tooltip():
    """What Blender shows when the pointer rests on it."""
    bare = [one.idname for one in addon_sources.operators() if not one.description]
    for operator in addon_sources.operators():
        bare += [
            f"{operator.idname} {setting.name}"
            for setting in operator.settings
            if not setting.is_hidden and not setting.description
        ]
    bare += [
        f"{setting.group}.{setting.name}"
        for setting in addon_sources.every_setting()
        if not setting.is_hidden and not setting.is_group and not setting.description
    ]
    assert bare == []


def test_every_message_is_in_the_manual_and_none_that_is_not():
    page = (GUIDE / "messages.md").read_text(encoding="utf-8")
    every = messages.messages()
    assert len(every) > 500
    assert [f"{one.source}: {one.text}" for one in messages.missing(page)] == []
    assert messages.unused(page) == []


SAID = """
LOCAL = "make it local first of all"
WORDS = (("no such file", "there is no such {device}"), ("denied", "the {device} may not be used"))
KINDS = {"A": "the first kind is not there", "B": "the second kind is not there"}

def _bent(value):
    return "" if value else f"{value} is bent out of shape"

def obstacle(self, context):
    reason = no_clip(context)
    if not reason:
        reason = iface_("{name} is hidden; show it first").format(name=context.name)
    return reason or "Select the head's mesh first"

def no_module_for(self, context):
    return Status("This build is not for {python}", {"python": self.version})

def execute(self, context):
    message = f"{self.name} has no curves at all"
    if self.is_long:
        raise native.invalid_input("the clip is " + f"{self.length} frames too long: cut it")
    self.report({"INFO"}, "All is well and done")
    self.report({"WARNING"}, "That was beside the footage")
    text = rpt_("{count} keys are left over") if self.count > 1 else rpt_("one key is left over")
    self.report({"WARNING"}, text.format(count=self.count))
    self.report({"ERROR"}, rpt_("{way}, or {other}").format(way=rpt_(LOCAL), other=self.name))
    return outcome.cancelled(self, context, message)

def read(self, text, kind):
    for value, name in ((self.rate, "the rate"), (self.size, "the size")):
        if value < 0:
            raise InvalidInput(f"{name} is {value}")
    for word, reason in WORDS:
        if word in text:
            raise InvalidInput(f"{text}: {reason.format(device='camera')}")
    if kind:
        raise InvalidInput(shortened(KINDS[kind]))
    if self.is_linked:
        raise InvalidInput(f"{text}: {LOCAL}")
    notes = ["recorded as it was seen"]
    notes += [f"frames {first} are left out" for first in self.lost]
    if bent := _bent(text):
        notes.append(bent)
    raise InvalidInput("{} faces are one too many".format(text))
    message = "What is said later on is none of the earlier"
"""


def test_messages_are_found_however_they_are_given():
    """In tables, dicts, names, constants, functions, lists of notes."""
    tree = ast.parse(SAID)
    sources = message_texts.Sources.of([tree])
    functions = [one for one in tree.body if isinstance(one, ast.FunctionDef)]
    texts = {
        messages.plain(text)
        for function in functions
        for said in messages.said_by(function, is_addon=True)
        for text in message_texts.texts(said, function, sources)
    }
    assert texts - {""} == {
        "… is hidden; show it first",
        "Select the head's mesh first",
        "This build is not for …",
        "… has no curves at all",
        "the clip is … frames too long: cut it",
        "That was beside the footage",
        "… keys are left over",
        "one key is left over",
        "make it local first of all, or …",
        "the rate is …",
        "the size is …",
        "…: there is no such …",
        "…: the … may not be used",
        "the first kind is not there",
        "the second kind is not there",
        "…: make it local first of all",
        "recorded as it was seen",
        "frames … are left out",
        "… is bent out of shape",
        "… faces are one too many",
    }


def test_a_message_that_the_page_lacks_is_noticed():
    page = (GUIDE / "messages.md").read_text(encoding="utf-8")
    row = "| `Choose an expression` |"
    assert row in page
    assert "Choose an expression" in [one.text for one in messages.missing(page.replace(row, ""))]
    invented = page + "\n| `the moon is … too large` | |\n"
    assert messages.unused(invented) == ["the moon is … too large"]
