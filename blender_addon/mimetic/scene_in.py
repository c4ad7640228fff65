# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender to plain values. Functions named `no_...` say why a button is grey, or nothing."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
from bpy.app.translations import pgettext_iface as iface_

from . import clips, jobs, native, own_tracks, takes, world, writable

UNDISTORTED = (
    "The clip editor shows undistorted proxies, over which nothing lies right: switch Undistorted "
    "off (Footage, Proxy/Timecode)"
)


@dataclass(frozen=True)
class Footage:
    path: object  # of a movie file, or a mimetic.media.footage.ImageSequence
    clip_name: str


@dataclass(frozen=True)
class Timing:
    """How the scene's timeline and the clip are related."""

    scene_rate: float  # frames a second
    frame_start: int  # scene frame of the clip's first frame
    frame_offset: int  # footage frames that the clip skips


def clip_of(context) -> bpy.types.MovieClip | None:
    """The clip on show in the clip editor, else the scene's."""
    return getattr(context, "edit_movieclip", None) or context.scene.mimetic.clip


def no_start() -> str:
    return native.problem() or jobs.busy()


def no_clip(context) -> str:
    if reason := no_start():
        return reason
    clip = clip_of(context)
    if clip is None:
        return "Load the footage first (Load Clip)"
    if clip.source == "SEQUENCE" and not native.footage().is_sequence(clips.path_of(clip)):
        return iface_(
            "{clip} is a single picture: load a movie or numbered pictures (Load Clip)"
        ).format(clip=clip.name)
    return writable.no_tracks(clip)


def no_footage(context) -> str:
    """Why the clip's pictures cannot be read."""
    if reason := no_clip(context):
        return reason
    clip = clip_of(context)
    if clips.is_missing(clip):
        return iface_("{name} is missing: look for it (Find Missing Files)").format(name=clip.name)
    return ""


def no_fit(context) -> str:
    """Why the person cannot be calibrated."""
    if reason := no_footage(context):
        return reason
    if not has_fit(clip_of(context)):
        return "Press Find Face first: the calibration is kept with its fit"
    return ""


def has_fit(clip: bpy.types.MovieClip | None) -> bool:
    """Whether the face was found in the clip."""
    record = clips.find(clip) if clip else None
    return bool(record and record.face_fit)


def no_take(context, first: str) -> str:
    """Why there is nothing to bake; first: what to do before."""
    if reason := no_start():
        return reason
    clip = clip_of(context)
    take = takes.of_clip(context.scene, clip)
    if take is None:
        text = iface_("press {buttons}, or Load Performance, first")
        if clip:
            text = iface_("{clip} has no performance: press {buttons}, or Load Performance, first")
        return text.format(clip=clips.name_of(clip), buttons=iface_(first))
    if not takes.find(take):
        return iface_("{name} is missing: look for it (Find Missing Files)").format(
            name=takes.name_of(take)
        )
    return ""


def take(context) -> takes.Take:
    """The take that buttons mean: the clip's, or the scene's while it has no clip."""
    clip = clip_of(context)
    path = takes.find(takes.of_clip(context.scene, clip))
    return takes.Take(path, clip.name, clips.fingerprint(clip)) if clip else takes.Take(path)


def no_performance(context) -> str:
    return no_take(context, "Capture") or no_edit_mode(context.scene.mimetic.face)


def no_footage_frame(clip: bpy.types.MovieClip, frame: int) -> str:
    """Why a footage frame of a clip is none, where Blender knows how many there are."""
    if clip.frame_duration <= 0 or frame <= clip.frame_duration:
        return ""
    return iface_("frame {frame}: {clip} has frames 1 to {last}").format(
        frame=frame, clip=clip.name, last=clip.frame_duration
    )


def no_landmarks(context, needs_selection: bool, needs_frame: bool = True) -> str:
    """Why no landmark can be pinned."""
    if reason := no_clip(context):
        return reason
    clip = clip_of(context)
    if not has_fit(clip):
        return "Press Find Face first: its landmarks are what is pinned"
    if not shows_landmarks(clip):
        message = "The landmarks of this face are not shown: press Landmarks Here"
        return message if needs_frame else ""
    tracks = own_tracks.landmark_object(clip).tracks
    if needs_selection and not any(track.select for track in tracks):
        return "Select landmarks in the clip editor first"
    frame = context.scene.frame_current - clip.frame_start + 1
    if needs_frame and tracks and not _is_marked(tracks[0], frame):
        return "The face was not found in this frame: press Landmarks Here"
    return ""


def shows_landmarks(clip: bpy.types.MovieClip) -> bool:
    """Whether the clip's tracks are landmarks of the face found in what it shows now, and lie on
    the frames in which it was found: markers stay where they are when Frame Offset changes."""
    record = clips.find(clip)
    is_theirs = record is not None and clip.mimetic.landmarks_of == record.name
    is_theirs = is_theirs and clip.mimetic.landmark_offset == clip.frame_offset
    return is_theirs and own_tracks.landmark_object(clip) is not None


def _is_marked(track: bpy.types.MovieTrackingTrack, frame: int) -> bool:
    marker = track.markers.find_frame(frame, exact=True)
    return marker is not None and not marker.mute


def no_stabilising(context) -> str:
    if reason := no_clip(context) or no_take(context, "Capture, or Head Only"):
        return reason
    clip = clip_of(context)
    stabilisation = clip.tracking.stabilization
    track_names = {track.name for track in (*stabilisation.tracks, *stabilisation.rotation_tracks)}
    if names := sorted(track_names.difference(own_tracks.held_by(clip))):
        return iface_("The clip is stabilised by {names}; remove that first").format(
            names=", ".join(names[:3])
        )
    return ""


def is_held(clip: bpy.types.MovieClip) -> bool:
    """Whether the clip is stabilised on the head."""
    ours = own_tracks.held_by(clip)
    return any(track.name in ours for track in clip.tracking.stabilization.tracks)


def holds(
    owner: bpy.types.Scene | bpy.types.ViewLayer | bpy.types.Collection,
    obj: bpy.types.Object | None,
) -> bool:
    """Whether an object is among the owner's: not by its name, which one that is linked may share
    with one that was deleted or is another scene's."""
    same_name = owner.objects.get(obj.name) if obj is not None else None
    if same_name is None or same_name == obj:
        return same_name is not None
    return obj in owner.objects.values()  # slower, where two have the name


def active(context) -> bpy.types.Object | None:
    """The active object: of the view layer, where a script overrides the window's scene alone."""
    obj = context.active_object
    return obj if holds(context.scene, obj) else context.view_layer.objects.active


def face_of(context) -> bpy.types.Object | None:
    """The face that panels and buttons mean: the active object if it is one, else the baked one."""
    chosen = active(context)
    if chosen is not None and is_face(chosen):
        return chosen
    if chosen is not None and (controlled_face := face_by_control(context.scene, chosen)):
        return controlled_face
    if chosen is not None and chosen.mimetic.landmark and chosen.parent and is_face(chosen.parent):
        return chosen.parent
    face = context.scene.mimetic.face
    return face if holds(context.scene, face) else None


def face_by_control(scene: bpy.types.Scene, control: bpy.types.Object) -> bpy.types.Object | None:
    """The face whose control object an armature is."""
    if control.type != "ARMATURE":
        return None
    return next((obj for obj in scene.objects if obj.mimetic.control_object == control), None)


def shown_face(context) -> bpy.types.Object | None:
    """The face whose sliders are listed; none while another mesh is active, which decides."""
    chosen, face = active(context), face_of(context)
    if face is None or not is_face(face):
        return None
    return None if chosen is not None and chosen.type == "MESH" and chosen != face else face


def is_face(candidate: bpy.types.Object) -> bool:
    """Whether an object has the sliders of a face."""
    return (
        candidate.type == "MESH"
        and len(candidate.mimetic.shapes) > 0
        and candidate.data.shape_keys is not None
    )


def no_face(context) -> str:
    if reason := no_start():
        return reason
    face = face_of(context)
    if face is None:
        return "Press Bake or Add Face first: the scene has no face"
    return no_edit_mode(face)


def no_sliders(context) -> str:
    """Why there is no face whose sliders could be read or set."""
    if reason := no_face(context):
        return reason
    face = face_of(context)
    if face.data.shape_keys is not None:
        return ""
    if face == context.scene.mimetic.face:
        return iface_("{face} has lost its shape keys: bake it again").format(face=face.name)
    return iface_("{name} has no sliders: press Attach Muscles").format(name=face.name)


def no_visible_face(context) -> str:
    if reason := no_face(context):
        return reason
    return no_sight(face_of(context))


def no_sight(obj: bpy.types.Object) -> str:
    """Why an object cannot be exported, if that is because it is hidden."""
    if obj.visible_get():
        return ""
    return iface_("{face} is hidden; show it to export it").format(face=obj.name)


def no_edit_mode(face: bpy.types.Object | None) -> str:
    """Why a face's shape keys cannot be changed: what is done to them then, leaving it undoes."""
    return (
        iface_("Leave {name}'s edit mode first").format(name=face.name)
        if face and face.mode == "EDIT"
        else ""
    )


def footage(context) -> Footage:
    """Raises what `known_errors` has."""
    clip = clip_of(context)
    return Footage(clips.source_of(clip, context.scene), clip.name)


def timing(scene: bpy.types.Scene, clip: bpy.types.MovieClip | None) -> Timing:
    return Timing(
        scene.render.fps / scene.render.fps_base,
        clip.frame_start if clip else 1,
        clip.frame_offset if clip else 0,
    )


def scene_frames(performance, clock: Timing):
    """N scene frames, whole or not, at which the performance's frames are."""
    return scene_frames_of(performance.frame, performance.fps, clock)


def scene_frames_of(frames, rate: float, clock: Timing):
    """The same of any footage frames; rate: the footage's frames a second."""
    return native.timing().scene_frames(
        frames, rate, clock.scene_rate, clock.frame_start, clock.frame_offset
    )


def shown_frame(context) -> int:
    """The footage frame on show. Blender shows one clip frame a scene frame, whatever the rates."""
    clip = clip_of(context)
    frame = context.scene.frame_current - scene_frame(clip, 0)
    return min(max(frame, 1), max(clip.frame_duration, 1))


def scene_frame(clip: bpy.types.MovieClip, frame: int) -> int:
    """The scene frame at which Blender shows a footage frame of a clip."""
    return frame + clip.frame_start - 1 - clip.frame_offset


def no_picture(context) -> str:
    """Why no place in the footage can be clicked on."""
    return _no_picture_in(context.space_data)


def _no_picture_in(space) -> str:
    if space is None or space.type != "CLIP_EDITOR" or space.clip is None:
        return "Faces are picked in the clip editor, with the footage on show"
    if space.show_stable and space.clip.tracking.stabilization.use_2d_stabilization:
        # Blender does not give the picture's place then
        return "Press Release Head first, or switch the stabilised view off"
    if is_undistorted(space):
        return UNDISTORTED
    return ""


def is_undistorted(space) -> bool:
    """Whether a clip editor shows another picture than the file has: an undistorted proxy."""
    is_clip = space is not None and space.type == "CLIP_EDITOR" and space.clip is not None
    return is_clip and space.clip.use_proxy and space.clip_user.use_render_undistorted


def footage_area(
    context, x: int, y: int, clip: bpy.types.MovieClip | None = None
) -> bpy.types.Area | None:
    """The clip editor with this clip, or any, under a place of the window, whose picture's places
    Blender gives. Not of `context.area`: an operator that waits may have lost its own."""
    for area in context.window.screen.areas if context.window else ():
        is_under = 0 <= x - area.x < area.width and 0 <= y - area.y < area.height
        if is_under and not _no_picture_in(area.spaces.active):
            return area if clip in (None, area.spaces.active.clip) else None
    return None


def footage_pixel(area: bpy.types.Area, x: int, y: int, size) -> tuple[float, float] | None:
    """The pixel of the footage under a place of the window, None beside it; of a clip editor.

    size: width and height of the file's pictures; a clip's are rounded while Blender shows a proxy.
    """
    under = [r for r in area.regions if 0 <= x - r.x < r.width and 0 <= y - r.y < r.height]
    if [region.type for region in under] != ["WINDOW"]:  # a sidebar may lie over the footage
        return None
    place = under[0].view2d.region_to_view(x - under[0].x, y - under[0].y)
    if not all(0 <= part <= 1 for part in place):
        return None
    pixels = native.picture().picture_pixels(place, size)
    return tuple(float(part) for part in pixels[0])


def frame_range(scene: bpy.types.Scene) -> tuple[int, int] | None:
    settings = scene.mimetic
    return (settings.frame_first, settings.frame_last) if settings.use_frame_range else None


def picture_size(scene: bpy.types.Scene) -> tuple[int, int]:
    return scene.render.resolution_x, scene.render.resolution_y


def side(scene: bpy.types.Scene, axis: str) -> float:
    """A side of the picture in pixels that are square: `x` or `y`."""
    render = scene.render
    return getattr(render, f"resolution_{axis}") * getattr(render, f"pixel_aspect_{axis}")


def pixel_aspect(scene: bpy.types.Scene) -> float:
    return scene.render.pixel_aspect_y / scene.render.pixel_aspect_x


def camera_matrix(scene: bpy.types.Scene) -> list[list[float]] | None:
    """Where the footage's camera stands, world from camera; None before the first bake."""
    camera = scene.mimetic.camera
    if not holds(scene, camera):
        return None
    return [list(row) for row in world.matrix(camera)]
