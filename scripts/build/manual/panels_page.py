# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of all panels, buttons and settings, written by the extension's sources."""

from __future__ import annotations

from addon_sources import OperatorSource, PanelSource, Setting, operators, panels, settings

EDITORS = {
    "CLIP_EDITOR": "the clip editor",
    "VIEW_3D": "the 3D view",
    "GRAPH_EDITOR": "the Graph Editor",
}
# What a panel is for, and the page that says more of it; in the order of use
ABOUT = {
    "Mimetic": "From footage to file, top to bottom: "
    "[the first minute](first-minute.md), [fitting.md](fitting.md), "
    "[calibration.md](calibration.md).",
    "Over the Footage": "What the clip editor draws over each frame.",
    "Captured Takes": "What was captured of the clip, refined or loaded, each a performance "
    "file, and which of them is used: [takes.md](takes.md).",
    "Corrections": "Single frames that are stated by hand, and the frames around solved again: "
    "[corrections.md](corrections.md).",
    "Head": "The head's motion on an object or on a character's bones, and the clip with the head "
    "held still: [head-tracking.md](head-tracking.md).",
    "Muscles": "Sliders of the face in groups, and muscles for a head of your own: "
    "[skin-and-muscles.md](skin-and-muscles.md).",
    "Overlays": "The face over its footage ([over-footage.md](over-footage.md)); muscles and "
    "strain, drawn on it.",
    "Own Controls": "A character's own shape keys or bones, played by a performance: "
    "[own-controls.md](own-controls.md).",
    "Baked Takes": "What was baked on this face: play, compare, blend in: [takes.md](takes.md).",
    "Curves": "All curves of the face at once, in one undo step: [curves.md](curves.md).",
    "Expressions": "Kept expressions, blended, mirrored and put in sequence: "
    "[expressions.md](expressions.md).",
    "Live": "A face driven by a camera: [live.md](live.md).",
    "Teach": "Looks for a taught set, kept while a live session runs: [live.md](live.md).",
}
# A panel that has one more picture, and the words for it
AT_WORK = ("Mimetic", "The same panel while the face is looked for")
BEGINNING = """\
# Panels and buttons

Every panel of the tab **Mimetic** (press N in the 3D view or in the clip editor), every button and
every setting, in their own words. A button that cannot run is grey and says why, as messages do
([messages.md](messages.md)). Each is in the menus Object > Mimetic or Clip > Mimetic too, and F3
finds it by its name; scripts call it by the name in the last column ([scripting.md](scripting.md)).

Long ones show their progress and the time left in the status bar, and leave the window free
meanwhile: scrub, play, undo, load the next clip. *Capture*, *Head Only*, *Find Face*, *Calibrate*,
*Refine* and *Bake* wait their turn behind one that is at work; on the same clip they begin with
what that one made, and not at all if it made nothing. Esc ends the one at work, in any of Blender's
windows (while the animation plays Esc ends that alone), and so does the cross beside it in the
panel. A window may be closed: what was begun in it goes on beside one that is left. What a job
writes into objects waits until you are in Object Mode and in its scene again; the status bar says
so.

While *Capture* works, the clip editor draws the face on each frame as it is followed, with the
strip of quality, and the playhead goes along. Scrub or play, and it leaves you there: frames that
were followed already show their face; back where it was left it goes along again.

A job at work is an unsaved change, also when the file was saved a moment ago: Blender asks before
it closes (unless Preferences > Save & Load > Save Prompt is off). **Cancel** leaves the job at
work. Whichever other answer is given, the frames that *Capture* and *Head Only* have followed are
kept as a take beside the .blend (**Load Performance**).

`scripts/make_manual` writes this page from the extension's sources; `scripts/panel_pictures` takes
its pictures in a real window, on a drawn person's clip.
"""


def page() -> str:
    parts = [BEGINNING]
    known = {operator.idname: operator for operator in operators()}
    labels = {panel.label: panel for panel in panels()}
    shown: set[str] = set()
    order = [
        *(label for label in ABOUT if label in labels),
        *(label for label in labels if label not in ABOUT),
    ]
    for label in order:
        parts.append(panel_part(labels[label], known))
        shown |= set(labels[label].operators)
    rest = [one for one in operators() if one.idname not in shown and not one.is_internal]
    parts.append("## In menus alone\n")
    parts.append(button_table(rest))
    parts.append(option_part(list(known.values())))
    return "\n".join(parts)


def panel_part(panel: PanelSource, known: dict[str, OperatorSource]) -> str:
    places = " and ".join(EDITORS[editor] for editor in panel.editors)
    lines = [f"## {panel.label}\n", f"In {places}. {ABOUT.get(panel.label, '')}".strip() + "\n"]
    lines.append(pictures(panel))
    if panel.operators:
        lines.append(button_table([known[name] for name in panel.operators]))
    own = [settings()[name] for name in panel.settings if name in settings()]
    if own:
        lines.append(setting_table(own))
    return "\n".join(lines)


def pictures(panel: PanelSource) -> str:
    """One of each editor's, which scripts/panel_pictures takes; of jobs at work in the first."""
    shown = [
        f"![The panel {panel.label} in {EDITORS[editor]}](../images/panels/{name}.png)"
        for name, editor in zip(panel.names, panel.editors, strict=True)
    ]
    if panel.label == AT_WORK[0]:
        shown.append(f"![{AT_WORK[1]}](../images/panels/at_work.png)")
    return "\n".join(shown) + "\n"


def button_table(buttons: list[OperatorSource]) -> str:
    rows = ["| button | what it does | in scripts |", "| --- | --- | --- |"]
    rows += [f"| **{one.label}** | {cell(one.description)} | `{one.idname}` |" for one in buttons]
    return "\n".join(rows) + "\n"


def setting_table(some: list[Setting], first: str = "setting") -> str:
    rows = [f"| {first} | what it is | from, to |", "| --- | --- | --- |"]
    rows += [f"| {one.label} | {cell(text_of(one))} | {limits(one)} |" for one in some]
    return "\n".join(rows) + "\n"


def option_part(every: list[OperatorSource]) -> str:
    """What buttons ask for: in the redo panel (F9), in the file browser, or of a script."""
    lines = ["## What buttons ask for\n"]
    lines.append(
        "In the panel at the view's lower left after the button ran (F9), in the file browser, "
        "or in a script's call.\n"
    )
    for operator in every:
        own = [one for one in operator.settings if not one.is_hidden]
        if own:
            lines.append(f"### {operator.label}\n\n{setting_table(own, 'option')}")
    return "\n".join(lines)


def text_of(setting: Setting) -> str:
    items = [f"*{item[1]}*: {item[2]}" for item in setting.items if item and len(item) > 2]
    return ". ".join(part for part in (setting.description, "; ".join(items)) if part)


def limits(setting: Setting) -> str:
    ends = [setting.keywords.get("min"), setting.keywords.get("max")]
    if ends == [None, None]:
        return ""
    low, high = ("" if end is None else f"{end:g}" for end in ends)
    return f"{low} … {high}".strip()


def cell(text: str) -> str:
    return " ".join(text.replace("|", "\\|").split())
