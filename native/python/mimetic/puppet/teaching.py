# SPDX-License-Identifier: GPL-3.0-or-later
"""From a clip and its performance to a taught set."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.media.footage import Footage
from mimetic.performance.document import HELD_QUALITY, Performance
from mimetic.puppet.seeing import MODEL, HeadStiller, Image, PersonView, Pose, PoseShaker
from mimetic.puppet.set_making import (
    REST,
    Channels,
    Sample,
    TaughtLook,
    cut,
    make_set,
    templates_of,
)
from mimetic.puppet.taught_look import Look
from mimetic.puppet.templates import TaughtSet
from mimetic.shared.pinhole import camera_of
from mimetic.shared.progress import Progress, check_goes_on
from mimetic.template.face_template import load_template

MOST_EXAMPLES = 200


def teach(
    footage: Footage,
    performance: Performance,
    looks: Sequence[Look],
    num_chosen: int = 0,
    frames: tuple[int, int] | None = None,
    num_examples: int = MOST_EXAMPLES,
    progress: Progress | None = None,
    left_out: Collection[int] = (),
    model: str = MODEL,
) -> TaughtSet:
    """Looks named, and `num_chosen` more that differ most, of a clip that is solved.

    One of the looks may be called `neutral`; otherwise the frame nearest to rest is. frames: those
    that are taught from, by default all; num_examples: of solved frames whose scores and state are
    kept as examples, 0, or a look with values of its own: the looks alone; left_out: frames that
    nothing is taught from; model: that the head is followed by. Raises InvalidInput,
    UnreadableMedia.
    """
    teaching = _Teaching(footage, performance, frames, progress, left_out, model)
    return teaching.run(looks, num_chosen, num_examples)


def has_own_state(looks: Iterable[Look]) -> bool:
    """Whether one drives something else than what was captured in its frame."""
    return any(look.values is not None for look in looks)


def best_seen(
    footage: Footage, performance: Performance, usable: NDArray[np.bool_] | None = None
) -> tuple[Image, Pose]:
    """The frame, of those usable, in which the head is seen best, and its pose there. From it the
    head is followed: the first frame may show it turned, or behind a hand."""
    quality = performance.quality if usable is None else np.where(usable, performance.quality, -1.0)
    best = int(quality.argmax())
    image = np.ascontiguousarray(footage.read(int(performance.frame[best])))
    return image, performance.head_pose[best]


def known_poses(performance: Performance) -> dict[int, Pose]:
    """By frame, where a head that was lost may be found again: where it was captured."""
    is_known = performance.quality >= HELD_QUALITY
    frames = performance.frame[is_known].tolist()
    return dict(zip(frames, performance.head_pose[is_known], strict=True))


class _Teaching:
    """One clip at work."""

    def __init__(
        self,
        footage: Footage,
        performance: Performance,
        frames: tuple[int, int] | None,
        progress: Progress | None,
        left_out: Collection[int],
        model: str,
    ) -> None:
        self.model = model
        self.footage, self.performance, self.progress = footage, performance, progress
        first, last = frames or (int(performance.frame[0]), int(performance.frame[-1]))
        in_range = (performance.frame >= first) & (performance.frame <= last)
        in_range &= ~np.isin(performance.frame, list(left_out))
        self.usable = in_range & (performance.quality >= max(HELD_QUALITY, 0.3))
        if not self.usable.any():
            raise InvalidInput(
                f"frames {first} to {last} of the performance show no face to teach from"
            )
        if len(performance.neutral_vertices) != len(load_template().vertices):
            raise InvalidInput("the performance is not of Mimetic's head: capture the clip again")
        camera = camera_of(performance.intrinsics, performance.image_size)
        self.view = PersonView(camera, performance.neutral_vertices)
        self.channels = Channels(
            performance.muscles, performance.groups.tolist(), performance.articulators
        )
        self.values = np.hstack([performance.activations, performance.articulator_values])

    def run(self, looks: Sequence[Look], num_chosen: int, num_examples: int) -> TaughtSet:
        self._check(looks)
        poses = self._followed()
        for look in looks:
            if look.frame not in poses:
                raise InvalidInput(
                    f"look {look.name}: the head was not followed in frame {look.frame}"
                )
        self.usable &= np.isin(self.performance.frame, list(poses))
        if not self.usable.any():
            raise InvalidInput("the head was not followed in any frame that can be taught from")
        if has_own_state(looks):
            num_examples = 0  # they teach what was captured, and would contradict it
        looks = self._with_rest(looks)
        looks = [*looks, *self._chosen(looks, num_chosen)]
        pictures, shaken = self._still_pictures(poses, {look.frame for look in looks}, num_examples)
        states = [self._state(look) for look in looks]
        templates = [
            cut(self.view.boxes(part), part, i, pictures[looks[i].frame])
            for i, part in templates_of(looks, states, self.channels)
        ]
        values = self._example_values(looks, states, pictures.keys(), num_examples)
        # Each frame twice: as it was seen, and as it might have been
        samples = [
            Sample(picture, values[frame], frame)
            for frame in sorted(values)
            for picture in (pictures[frame], shaken[frame])
        ]
        taught_looks = [
            TaughtLook(look.name, look.frame, state)
            for look, state in zip(looks, states, strict=True)
        ]
        return make_set(
            self.view, self.channels, taught_looks, templates, samples, list(self.footage.identity)
        )

    def _with_rest(self, looks: Sequence[Look]) -> list[Look]:
        if any(look.name == REST for look in looks):
            return list(looks)
        size = np.abs(self.values / self.channels.units).sum(axis=1)
        best = int(np.where(self.usable, size, np.inf).argmin())
        return [Look(REST, int(self.performance.frame[best])), *looks]

    def _chosen(self, looks: Sequence[Look], number: int) -> list[Look]:
        """Frames in which the mouth, the brows or the eyes differ most, a third of them each."""
        rest = self.performance.index_of(next(look.frame for look in looks if look.name == REST))
        performance = self.performance
        frames: set[int] = set()
        third = number // 3
        for parts, share in (
            (("mouth",), number - 2 * third),
            (("brow.L", "brow.R"), third),
            (("eye.L", "eye.R"), third),
        ):
            channels = sorted(channel for part in parts for channel in self.channels.of_parts[part])
            rows = np.ascontiguousarray((self.values / self.channels.units)[:, channels])
            count = min(share + 1, int(self.usable.sum()))
            indices = _core.distinct_rows(rows, self.usable.tolist(), rest, count)
            frames |= {int(performance.frame[i]) for i in indices if i != rest}
        taken = {look.frame for look in looks}
        return [Look(f"look {frame}", frame) for frame in sorted(frames - taken)]

    def _check(self, looks: Sequence[Look]) -> None:
        for look in looks:
            if not self.usable[self.performance.index_of(look.frame)]:
                raise InvalidInput(
                    f"look {look.name}: in frame {look.frame} the face is not seen well, or it is "
                    "outside of --frames"
                )

    def _state(self, look: Look) -> NDArray[np.float64]:
        if look.values is None:
            return self.values[self.performance.index_of(look.frame)]
        return self.channels.state(look)

    def _example_values(
        self,
        looks: Sequence[Look],
        states: Sequence[NDArray[np.float64]],
        seen: Iterable[int],
        number: int,
    ) -> dict[int, NDArray[np.float64]]:
        """By frame."""
        values = {look.frame: state for look, state in zip(looks, states, strict=True)}
        if number:
            for frame in seen:
                values.setdefault(frame, self.values[self.performance.index_of(frame)])
        return values

    def _still_pictures(
        self, poses: Mapping[int, Pose], wanted: set[int], number: int
    ) -> tuple[dict[int, Image], dict[int, Image]]:
        """Of the looks' frames and of `number` others, evenly among those that can be used.

        By frame, as the puppet will see them; and with that pose a little off.
        """
        usable = self.performance.frame[self.usable]
        spread = usable[np.linspace(0, len(usable) - 1, min(number, len(usable))).astype(int)]
        wanted = wanted | set(spread.tolist())
        pictures, shaken, shaker = dict[int, Image](), dict[int, Image](), PoseShaker()
        for frame, image in self.footage.frames(min(wanted), max(wanted)):
            check_goes_on(self.progress, 1.0, f"taking the picture of frame {frame}")
            if frame in wanted:
                image = np.ascontiguousarray(image)
                pictures[frame] = self.view.picture(image, poses[frame])
                shaken[frame] = self.view.picture(image, shaker.shaken(poses[frame]))
        return pictures, shaken

    def _followed(self) -> dict[int, Pose]:
        """By frame, the head's poses, followed from frame to frame as the puppet will; frames in
        which it is held are missing."""
        start, end = np.flatnonzero(self.usable)[[0, -1]]
        first, last = int(self.performance.frame[start]), int(self.performance.frame[end])
        best = best_seen(self.footage, self.performance, self.usable)
        known = known_poses(self.performance)
        stiller = HeadStiller(self.view, *best, self.model)
        poses, is_lost = dict[int, Pose](), True
        for frame, image in self.footage.frames(first, last):
            fraction = (frame - first) / max(1, last - first)
            check_goes_on(self.progress, fraction, f"looking at frame {frame}")
            guess = known.get(frame) if is_lost else None
            head = stiller.tracker.advance(np.ascontiguousarray(image), guess)
            is_lost = head.held
            if not is_lost:
                poses[frame] = np.asarray(head.camera_from_head)
        return poses
