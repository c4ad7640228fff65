# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks at a fitted head in other frames of its clip, for its relief."""

from __future__ import annotations

import itertools
import math
from collections.abc import Generator, Iterator, Sequence

from mimetic import _core
from mimetic.fit.face_fit import FaceFit
from mimetic.fit.views import LEAST_TURN, Candidate, turn_signs
from mimetic.media.backward import frames_away
from mimetic.media.cuts import Images, of_one_scene
from mimetic.media.footage import Footage
from mimetic.muscles.anatomy import Anatomy, AttachedSkin, factored_skin, modes_of
from mimetic.performance.document import HELD_QUALITY
from mimetic.shared.parallel import side_by_side
from mimetic.shared.progress import ATTACHED, MOST_FOLLOWED, Progress, frame_text, stages
from mimetic.solve import tracking
from mimetic.solve.face_place import FacePlace
from mimetic.solve.relief import LEAST_SIGHTINGS, find_relief
from mimetic.template.face_template import FaceTemplate, load_template

# Texture that is stretched over the wrong depth is measured wrongly where the head is turned far:
# the first rounds are for a rough depth. Frames that are followed, and times that each is solved.
ROUNDS = ((15, 2), (15, 2), (MOST_FOLLOWED, 4))
GIVEN_UP = 6  # frames in a row in which the face is lost
# Finer than a capture follows by: flow at half of the texture's size errs by half a pixel where the
# head is turned, which is two millimetres of depth. Few frames are looked at, so it costs little.
CROP_HEIGHT, SAMPLE_SPACING = 300, 6  # pixels of the face in the reference texture


def with_relief(
    footage: Footage,
    fit: FaceFit,
    candidates: Sequence[Candidate],
    progress: Progress | None,
    skin: AttachedSkin | None = None,
) -> FaceFit:
    """The fit with the relief by the frames in which the head is turned otherwise.

    candidates: frames in which the face was found, the fit's among them, expressions allowed; the
    face is followed from the fit's frame as far as any of them that is turned. skin: of nearly this
    head, if there is one. The fit as it is where too few are turned, or progress says to stop.
    """
    signs = {c.frame: turn_signs(c.features) for c in candidates}
    turned_frames = [
        frame for frame, sign in signs.items() if math.dist(sign, signs[fit.frame]) >= LEAST_TURN
    ]
    if len(turned_frames) < LEAST_SIGHTINGS:
        return fit
    first, last = min(*turned_frames, fit.frame), max(*turned_frames, fit.frame)
    attaching, *rounds = stages(progress, 0.0 if skin else ATTACHED, *[most for most, _ in ROUNDS])
    template = load_template()
    if skin is None:
        skin = factored_skin(fit.neutral_vertices(template), template, fit.calibration, attaching)
    if skin is None:
        return fit
    anatomy = modes_of(skin)  # some millimetres of depth hardly change what muscles do
    for effort, in_round in zip(ROUNDS, rounds, strict=True):
        found = _with_depth(footage, fit, template, anatomy, (first, last), effort, in_round)
        if found is None:
            return fit
        fit = found
    return fit


def _with_depth(
    footage: Footage,
    fit: FaceFit,
    template: FaceTemplate,
    anatomy: Anatomy,
    frames: tuple[int, int],
    effort: tuple[int, int],
    progress: Progress,
) -> FaceFit | None:
    """The fit with the relief that its head, followed through the frames, shows; None: stopped.

    effort: frames followed, with more of them every second, third ...; times that each is solved
    """
    motion = tracking.face_motion(fit.neutral_vertices(template), template, anatomy)
    reference = footage.read(fit.frame)
    face = FacePlace(fit).at(fit.head_pose)
    # Relief moves points along the rays of one frame: so no other frame's texture may be used.
    options = _core.TrackerOptions()
    options.max_key_views = 0
    options.crop_height, options.sample_spacing = CROP_HEIGHT, SAMPLE_SPACING
    most, options.max_iterations = effort
    first, last = frames
    stride = 1 + (last - first) // most

    def seen_to(end: int) -> Generator[_core.Sighting, None, None]:
        images = itertools.islice(frames_away(footage, fit.frame, end), stride - 1, None, stride)
        tracker = tracking.make_tracker(reference, fit, template, anatomy, motion, options)
        tracker.advance(reference)
        yield from _follow(tracker, of_one_scene(reference, images, face))

    sightings: list[_core.Sighting] = []
    for sighting in side_by_side([seen_to(end) for end in frames if end != fit.frame]):
        where = frame_text(sighting.frame, first, last)
        text = f"looking for the face's relief: {where}"
        if not progress(len(sightings) * stride / (1 + last - first), text):
            return None
        sightings.append(sighting)
    sightings.sort(key=lambda sighting: sighting.frame)
    modes, std = tracking.moving_modes(anatomy, template.num_skin_vertices)
    return find_relief(
        *(fit, template, sightings, modes, std),
        lambda _fraction: progress(1.0, "looking for the face's relief: depth"),
    )


def _follow(tracker: _core.FaceTracker, images: Images) -> Iterator[_core.Sighting]:
    num_lost = 0
    for frame, image in images:
        estimate = tracker.advance(image)
        if not estimate.held and estimate.quality >= HELD_QUALITY:
            outline = tracker.outline(image)
            yield _core.Sighting.of(frame, estimate, tracker.observations(), outline)
        num_lost = num_lost + 1 if estimate.held else 0
        if num_lost == GIVEN_UP:
            return
