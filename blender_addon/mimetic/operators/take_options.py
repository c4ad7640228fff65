# SPDX-License-Identifier: GPL-3.0-or-later
"""What every bake does about takes: the row in the list, and the take that was edited by hand."""

from __future__ import annotations

from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import BoolProperty, EnumProperty

from .. import scene_in, scene_out


class TakeOptions:
    """Mixin of operators that bake."""

    TAKE = ("Take", ("edited", "replace_take", "use_strips", "use_lost_markers"), True)

    edited: EnumProperty(
        name="If Edited",
        items=(
            ("NEW", "New Take", "The edited take stays in the list, and the new one plays"),
            ("KEEP", "Keep", "The edited take plays on, and the new one waits in the list"),
            ("REPLACE", "Replace", "The edited take and its curves go"),
        ),
        description="What becomes of the take that plays if its curves were edited since its bake",
        options={"SKIP_SAVE"},
    )
    replace_take: BoolProperty(
        name="Replace Take",
        description="The new take takes the place of the one that plays, unless that was edited",
        options={"SKIP_SAVE"},
    )
    use_strips: BoolProperty(
        name="As NLA Strips",
        description="Strips on tracks of their own instead of active actions: room for keys above",
    )
    use_lost_markers: BoolProperty(
        name="Mark Lost Frames",
        default=True,
        description="Markers in the timeline where the face of the take that plays was lost and is "
        "held, instead of those of another take; unticked, no take's",
    )

    def note_take(self, context, obj, performance, name, take, clip, settings, before) -> str:
        """Lists what was baked on `obj`; take: `takes.Take`; before: of
        `take_list.before_bake`. Returns what the message adds."""
        takes = scene_out.take_list
        earlier = next((r for r in reversed(obj.mimetic.takes) if takes.plays(r, before)), None)
        earlier_name = earlier.name if earlier else ""
        is_edited = earlier is not None and takes.is_edited(earlier)
        frames = scene_in.scene_frames(performance, scene_in.timing(context.scene, clip))
        row = takes.note(obj, performance, name, take.path, frames, settings, before)
        new = row.name
        is_replaced = self.edited == "REPLACE" if is_edited else self.replace_take
        is_kept = is_edited and self.edited == "KEEP"
        remark = ""
        is_inherited = earlier is not None and takes.is_inherited(
            obj, obj.mimetic.takes[earlier_name]
        )
        if is_replaced and is_inherited:
            remark = rpt_("; {take} is a take of the linked file and stays in Baked Takes").format(
                take=earlier_name
            )
        elif earlier_name and is_replaced:
            takes.remove(obj, obj.mimetic.takes[earlier_name])
            remark = rpt_("; {take} is replaced").format(take=earlier_name)
            remark += rpt_(", edits and all") if is_edited else ""
            if earlier_name == name or earlier_name.startswith(f"{name}."):
                obj.mimetic.takes[new].name = new = earlier_name
        elif is_kept:
            takes.play(obj, obj.mimetic.takes[earlier_name])
            remark = rpt_("; {take} was edited and plays on, {new} waits in Baked Takes").format(
                take=earlier_name, new=new
            )
        elif is_edited:
            remark = rpt_("; {take} was edited: it is kept in Baked Takes, {new} plays").format(
                take=earlier_name, new=new
            )
        if self.use_strips and not is_kept:
            takes.as_strips(obj, obj.mimetic.takes[new])
        num_ranges = self.mark_lost(context.scene, obj, earlier_name if is_kept else new)
        if num_ranges == 1:
            remark += rpt_("; 1 lost range is marked in the timeline")
        elif num_ranges:
            remark += rpt_("; {count} lost ranges are marked in the timeline").format(
                count=num_ranges
            )
        if shared := takes.shared(obj):
            remark += f"; {shared}"
        self.facts = {**(self.facts or {}), "take": new, "num_ranges": num_ranges}
        return remark

    def mark_lost(self, scene, obj, playing: str) -> int:
        """Returns how many lost ranges of the take that plays are marked now."""
        if self.use_lost_markers:
            return scene_out.lost_markers.show(scene, obj.mimetic.takes[playing])
        scene_out.lost_markers.clear(scene)
        return 0
