# SPDX-License-Identifier: GPL-3.0-or-later
"""The fitted face's landmarks as tracks of the clip, one marker for each frame the fit rests on.

A pinned landmark's track has a colour of its own and is where the user put it; the others are where
the fit has them. So the pins are in the .blend twice, as markers and in the fit itself.
"""

from __future__ import annotations

import bpy
import numpy as np

from .. import native, own_tracks

PIN_COLOUR = (1.0, 0.25, 0.1)
PATTERN_PIXELS = 7, 15  # of markers, small enough to see the face between them
OUT_OF_SIGHT = (-10.0, -10.0)  # in pictures
MOVED_PIXELS = 0.02  # markers are single precision


def tracks_of(clip: bpy.types.MovieClip):
    """The landmarks' tracks, or nothing if the clip has none."""
    tracking_object = own_tracks.landmark_object(clip)
    return tracking_object.tracks if tracking_object else ()


def show(clip: bpy.types.MovieClip, fit) -> None:
    """Marks a mimetic.fit.FaceFit's landmarks in the clip, instead of those of an earlier fit."""
    tracking_object = own_tracks.new_landmark_object(clip)
    frames = [frame - clip.frame_offset for frame in _frames(fit)]
    around = {frame + step for frame in frames for step in (-1, 1)}.difference(frames)
    settings = clip.tracking.settings
    usual = settings.default_pattern_size, settings.default_search_size
    settings.default_pattern_size, settings.default_search_size = PATTERN_PIXELS
    for name in native.fitting().landmark_places(fit):
        track = tracking_object.tracks.new(name=name, frame=frames[0])
        for frame in frames:
            track.markers.insert_frame(frame)
        for silent in around:  # nothing is known of other frames
            track.markers.insert_frame(silent, co=OUT_OF_SIGHT).mute = True
    settings.default_pattern_size, settings.default_search_size = usual
    clip.tracking.objects.active = tracking_object
    clip.mimetic.landmark_offset = clip.frame_offset
    place(clip, fit)


def place(clip: bpy.types.MovieClip, fit) -> None:
    """Puts the markers where the fit has their landmarks, but for pins, which are the user's."""
    pinned_names = {name for pins in fit.pins.values() for name in pins}
    tracks = {track.name: track for track in tracks_of(clip)}
    for frame in _frames(fit):
        places = expected_places(fit, frame)
        coordinates = native.picture().picture_coordinates(list(places.values()), fit.image_size)
        for name, coordinate in zip(places, coordinates, strict=True):
            marker = _marker(clip, tracks.get(name), frame)
            if marker is not None and np.abs(np.subtract(marker.co, coordinate)).max() > 1e-7:
                marker.co = coordinate
    for name, track in tracks.items():
        track.use_custom_color = name in pinned_names
        if name in pinned_names:
            track.color = PIN_COLOUR


def expected_places(fit, frame: int) -> dict[str, tuple[float, float]]:
    """Where a frame's markers belong, pixels: pins at their own place, the rest as fitted."""
    places = native.fitting().landmark_places(fit, frame)
    return places | fit.pins.get(frame, {})


def find_moves(clip: bpy.types.MovieClip, fit) -> dict[int, dict[str, tuple[float, float]]]:
    """Footage frame: landmark: pixel, of the markers that are not where the fit has them."""
    tracks = {track.name: track for track in tracks_of(clip)}
    moves = {}
    for frame in _frames(fit):
        places = {n: at for n, at in expected_places(fit, frame).items() if n in tracks}
        markers = {n: _marker(clip, tracks[n], frame) for n in places}
        # Those that are switched off are nowhere, as those beside the frames of the fit
        marker_places = {n: m.co for n, m in markers.items() if m is not None and not m.mute}
        pixels = native.picture().picture_pixels(list(marker_places.values()), fit.image_size)
        away = {
            name: tuple(pixel.tolist())
            for name, pixel in zip(marker_places, pixels, strict=True)
            if np.abs(pixel - places[name]).max() > MOVED_PIXELS
        }
        if away:
            moves[frame] = away
    return moves


def state(clip: bpy.types.MovieClip) -> bytes:
    """Changes when any landmark's marker does."""
    places = [m.co for track in tracks_of(clip) for m in track.markers if not m.mute]
    return np.array(places, dtype=np.float32).tobytes()


def selected(clip: bpy.types.MovieClip) -> list[str]:
    return [track.name for track in tracks_of(clip) if track.select]


def _frames(fit) -> list[int]:
    return [view.frame for view in fit.views]


def _marker(clip, track, frame: int):
    """A track's marker of a frame of the footage, or None: where `show` put it, though the clip
    may begin at another frame by now."""
    at = frame - clip.mimetic.landmark_offset
    return track.markers.find_frame(at, exact=True) if track is not None else None
