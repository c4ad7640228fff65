# SPDX-License-Identifier: GPL-3.0-or-later
import bpy
from bpy.app.translations import pgettext_iface as iface_
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import BoolProperty, EnumProperty, IntProperty
from bpy.types import Operator

from .. import clips, native, scene_in, scene_out, takes, targets, turned_views, writable
from ..jobs import Job
from .curve_options import CurveOptions
from .key_options import KeyOptions
from .sections import InSections
from .take_options import TakeOptions


class MIMETIC_OT_bake(KeyOptions, CurveOptions, TakeOptions, InSections, Job, Operator):
    """Put the performance into the scene: face, muscle curves, head motion, footage and camera"""

    bl_idname = "mimetic.bake"
    bl_label = "Bake"
    bl_options = {"REGISTER", "UNDO"}

    subdivision: IntProperty(
        name="Subdivision", default=1, min=0, max=3, description="Levels in the viewport"
    )
    use_texture: BoolProperty(
        name="Footage as Skin", default=True, description="Project a frame of the clip on the skin"
    )
    use_contact: BoolProperty(
        name="Contact",
        default=True,
        description="Let lips rest on each other and lids on each other, by additional shapes",
    )
    use_detail: BoolProperty(
        name="Detail",
        default=False,
        description="Additional shapes for what the muscles leave unexplained: the surface as "
        "closely as it was measured, and some eighty curves that are not meant to be edited",
    )
    use_head_motion: BoolProperty(
        name="Head Motion",
        default=True,
        description="On a character of your own: move the object as the actor's head moves, unless "
        "a rig moves it. The performer's own face always moves",
    )
    use_view: BoolProperty(
        name="Look Through Camera", default=True, description="Turn 3D views to the footage"
    )
    use_render: BoolProperty(
        name="Render over Footage",
        default=True,
        description="Where the scene has no compositor nodes of its own: have renders show the "
        "face over the footage, by nodes behind a transparent film, in its own colours (view "
        "transform Standard), lit by lights that go along with the face",
    )
    to: EnumProperty(
        name="To",
        items=(
            ("AUTO", "As Before", "The control object of a face that has one, else shape keys"),
            ("KEYS", "Shape Keys", "Curves on the values of the face's shape keys"),
            ("CONTROLS", "Control Object", "Curves on the bones of an armature that drives them"),
        ),
        description="What is keyed, and edited afterwards",
    )
    use_units: BoolProperty(
        name="Action Units",
        default=False,
        description="Sliders of FACS's action units too, left and right, and an asset of each",
    )
    reset_hand_changes: BoolProperty(
        name="Reset Hand Changes",
        default=False,
        options={"SKIP_SAVE"},
        description="Undo what was changed by hand on the face's shapes, their names, limits and "
        "subdivision since the last bake; otherwise it stays",
    )

    FACE = (
        "to",
        "use_texture",
        "use_contact",
        "use_detail",
        "use_units",
        "subdivision",
        "reset_hand_changes",
    )
    sections = (
        CurveOptions.CURVES,
        KeyOptions.KEYS,
        ("Face", FACE, True),
        ("Scene", ("use_head_motion", "use_view", "use_render"), True),
        TakeOptions.TAKE,
    )

    obstacle = staticmethod(targets.no_bake)

    @classmethod
    def description(cls, context, properties):
        """Of a character by its whole name, which may be too long for the button."""
        head = targets.bound_head(context)
        if head is None:
            return ""  # as above
        return iface_("Put the performance on {head}: its sliders, and the head's motion").format(
            head=head.name
        )

    @classmethod
    def subject(cls, context):
        return clips.name_of(scene_in.clip_of(context))

    def read(self, context):
        clip = scene_in.clip_of(context)
        head = targets.bound_head(context)
        footage = scene_in.footage(context).path if clip and self.use_texture else None
        options = (footage, self.use_contact, self.use_detail) if head is None else None
        if options and footage and clips.is_missing(clip):
            raise native.invalid_input(
                rpt_(
                    "{name} is missing: look for it (Find Missing Files), or untick Footage as Skin"
                ).format(name=clip.name)
            )
        return scene_in.take(context), options, head.name if head else "", self.curve_settings()

    def work(self, inputs, progress):
        take, options, bound_name, settings = inputs
        performance = native.curve_settings().edited(takes.load(take), settings)
        name = takes.action_name(take, performance)
        if options is None:
            return performance, name, take, None, bound_name
        footage, use_contact, use_detail = options
        if not use_detail:
            performance = performance.without_detail()
        contact = None
        if use_contact:
            contact = native.contact_shapes().contact_shapes(performance, progress)
        if not progress(0.9, "projecting the texture" if footage else "painting"):
            return None
        appearance = native.appearance().appearance_of(performance, footage)
        return performance, name, take, (appearance, contact), ""

    def write(self, context, result):
        performance, name, take, dress, bound_name = result
        clip = bpy.data.movieclips.get(take.clip_name)
        if bound_name:
            head = writable.own_object(context.scene, bound_name)
            before = scene_out.take_list.before_bake(head)
            message = self.write_bound(context.scene, performance, name, head, clip)
            like = performance, name, take, clip, self.settings(), before
            return message + self.note_take(context, head, *like)
        appearance, contact = dress
        face = scene_out.face.find(context.scene, performance)
        before = scene_out.take_list.before_bake(face)
        use_controls = self.uses_controls(face)
        summary = scene_out.bake(
            context.scene,
            performance,
            name,
            appearance,
            clip,
            self.subdivision,
            contact_shapes=contact,
            is_reset=self.reset_hand_changes,
            tolerance=self.tolerance if self.use_few_keys else 0.0,
            with_units=self.use_units,
            by_phases=self.use_phases,
            use_controls=use_controls,
        )
        face = context.scene.mimetic.face
        self.facts = {"object": face.name, "camera": context.scene.camera.name, **_made(summary)}
        message = rpt_("{num_curves} curves from frame {first:.6g} to {last:.6g} on {name}").format(
            num_curves=summary.num_curves, first=summary.first, last=summary.last, name=face.name
        )
        like = performance, name, take, clip, self.settings(), before
        message += self.note_take(context, face, *like)
        if summary.kept:
            message += rpt_("; {kept} (Reset Hand Changes undoes that)").format(kept=summary.kept)
        message += f"; {summary.remark}" if summary.remark else ""
        if clip and clips.is_missing(clip):
            message += rpt_("; {clip} is missing: the camera shows it once it is found").format(
                clip=clip.name
            )
        if clip and self.use_render:
            remark = scene_out.over_footage.set_up(context.scene, face, performance)
            message += f"; {remark}" if remark else ""
        if self.use_view:
            with turned_views.turning(context.scene):
                is_alone = scene_out.camera.look_through(context, face)
            if is_alone:
                message += rpt_(
                    "; other objects are out of view, View > Local View shows them again"
                )
        if not scene_out.canonical.select_only(context.view_layer, face):
            message += rpt_("; {name} is in no collection that this view layer shows").format(
                name=face.name
            )
        elif not face.visible_get():
            message += rpt_(
                "; {name} is hidden: its eye in the Outliner, or its collection's, shows it"
            ).format(name=face.name)
        return message

    def settings(self) -> str:
        """Of this bake, for the list of takes."""
        parts = self.key_remarks() + self.curve_remarks()
        parts += [iface_("detail")] if self.use_detail else []
        return ", ".join(parts)

    def uses_controls(self, face) -> bool:
        if remark := scene_out.control_object.forget_lost(face):
            self.report({"WARNING"}, remark)
        if self.to == "AUTO":
            return scene_out.control_object.of(face) is not None
        return self.to == "CONTROLS"

    def write_bound(self, scene, performance, take, head, clip):
        """On a character's own head; the message names all that it cannot play."""
        place = scene, performance, take, head, clip, self.use_head_motion
        if self.uses_controls(head):
            summary = scene_out.bound_controls.bake(*place, *self.few_keys())
        else:
            writable.check(scene_out.control_object.no_keys(head))
            summary = scene_out.bound.bake(*place, *self.few_keys())
        self.facts = {"object": head.name, "left_out": list(summary.left_out), **_made(summary)}
        for remark in summary.left_out:
            self.report({"WARNING"}, remark)
        if summary.untouched:
            self.report(
                {"INFO"},
                rpt_("The performance leaves alone: {names}").format(
                    names=", ".join(summary.untouched)
                ),
            )
        message = rpt_(
            "{num_curves} curves from frame {first:.6g} to {last:.6g} on "
            "{name}; its mesh, materials, contact and the scene's camera stay"
        ).format(
            num_curves=summary.num_curves, first=summary.first, last=summary.last, name=head.name
        )
        if performance.detail_modes is not None and self.use_detail:
            message += rpt_("; detail is the performer's own skin's and was left out")
        return message if summary.has_motion else message + rpt_("; the object was not moved")


def _made(summary) -> dict:
    return {"num_curves": summary.num_curves, "scene_frames": [summary.first, summary.last]}
