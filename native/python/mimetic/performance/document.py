# SPDX-License-Identifier: GPL-3.0-or-later
"""The document that passes between capture and everything after it."""

from __future__ import annotations

import itertools
import os
import re
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.media.clip_fingerprint import is_fingerprint
from mimetic.performance.clip_keys import check_clip, check_size
from mimetic.performance.corrections import from_texts
from mimetic.performance.gaze import check_eyes, seen_articulators, with_eyes_turned
from mimetic.shared.array_document import ArrayDocument
from mimetic.shared.array_file import check_names, is_bounded, open_arrays
from mimetic.shared.array_writer import write_arrays
from mimetic.shared.shown_text import shown

SCHEMA = 1
CHECKED_AT_ONCE = 4096  # frames, for the memory's sake
HELD_QUALITY = 0.2  # frames under it are held, not invented
LARGEST = {"N": 10_000_000, "V": 2_000_000, "F": 4_000_000} | dict.fromkeys("PAMK", 1000)
LARGEST |= {"E": 600_000, "C": 100_000, "R": 4_000, "S": 10_000_000}

# key: (kind of number, shape); letters are lengths that must agree between the keys
REQUIRED: dict[str, tuple[str, tuple[int | str, ...]]] = {
    "frame": ("i", ("N",)),
    "fps": ("f", (1,)),
    "image_size": ("i", (2,)),
    "intrinsics": ("f", (3, 3)),
    "head_pose": ("f", ("N", 4, 4)),
    "head_pose_cov": ("f", ("N", 6, 6)),
    "muscles": ("U", ("P",)),
    "muscle_modes": ("m", ("P", "V", 3)),
    "groups": ("i", ("P",)),
    "activations": ("f", ("N", "P")),
    "activations_std": ("f", ("N", "P")),
    "articulators": ("U", ("A",)),
    "articulator_values": ("f", ("N", "A")),
    "neutral_vertices": ("f", ("V", 3)),
    "faces": ("i", ("F", 4)),
    "quality": ("f", ("N",)),
}
OPTIONAL: dict[str, tuple[str, tuple[int | str, ...]]] = {
    "articulator_modes": ("m", ("A", "V", 3)),
    "articulator_values_std": ("f", ("N", "A")),
    "detail_modes": ("m", ("M", "V", 3)),
    "detail_coefficients": ("f", ("N", "M")),
    "detail_coefficients_std": ("f", ("N", "M")),
    "notes": ("U", ("K",)),
    "stored_size": ("i", (2,)),
    "footage": ("U", (2,)),
    "eye_centers": ("f", (2, 3)),
    "eye_of_vertex": ("i", ("V",)),
    "iris_centers": ("f", (2, 3)),
    "lid_following": ("f", (2, 2)),
    "evidence": ("m", ("N", "E")),
    "corrections": ("U", ("C",)),
    "uncorrected": ("f", ("N", "R")),
    "muscle_extent": ("f", ("P",)),
    "confounded_with": ("i", ("N", "P")),
    "scene_starts": ("i", ("S",)),
}
# Modes are kept in single precision: 1e-7 of a displacement of centimetres, at half the memory.
DTYPES = {"f": np.float64, "m": np.float32, "i": np.int64}
ACCEPTED = {"f": "fiu", "m": "fiu", "i": "iu", "U": "U"}
DOCUMENT = ArrayDocument(
    what="performance",
    schema=SCHEMA,
    required=REQUIRED,
    optional=OPTIONAL,
    accepted=ACCEPTED,
    dtypes=DTYPES,
    largest=LARGEST,
    advice="capture the footage again",
)


@dataclass
class Performance:
    """A person's performance: surface, head motion and muscle activations, frame by frame.

    N frames, V control vertices, F quads, P muscles, A articulators. Metres, pixels; the head frame
    has x to the image right when the person faces the camera, y up, z out of the face, its origin
    midway between the ears; the camera frame x right, y down, z forward.
    """

    frame: NDArray[np.int64]  # N, numbers in the footage, first = 1
    fps: float
    image_size: NDArray[np.int64]  # width, height
    intrinsics: NDArray[np.float64]  # 3 x 3
    head_pose: NDArray[np.float64]  # N x 4 x 4, camera from head
    head_pose_cov: NDArray[np.float64]  # N x 6 x 6, of (rotation vector, translation)
    muscles: list[str]  # P
    muscle_modes: NDArray[np.float32]  # P x V x 3, displacement at full activation
    groups: NDArray[np.int64]  # P, 1 to 7
    activations: NDArray[np.float64]  # N x P, 0 to 1
    activations_std: NDArray[np.float64]  # N x P
    articulators: list[str]  # A
    articulator_values: NDArray[np.float64]  # N x A
    neutral_vertices: NDArray[np.float64]  # V x 3
    faces: NDArray[np.int64]  # F x 4
    quality: NDArray[np.float64]  # N, 0 lost to 1 well explained
    articulator_modes: NDArray[np.float32] | None = None  # A x V x 3, displacement at value 1
    articulator_values_std: NDArray[np.float64] | None = None  # N x A
    detail_modes: NDArray[np.float32] | None = None  # M x V x 3
    detail_coefficients: NDArray[np.float64] | None = None  # N x M
    detail_coefficients_std: NDArray[np.float64] | None = None  # N x M
    notes: list[str] | None = None  # what the reader should know: stopped early, cut, held frames
    # Width, height of the footage's frames as the file stores them, where pixels may not be square;
    # all else is in pixels of `image_size`, which are
    stored_size: NDArray[np.int64] | None = None
    # Of the clip it was captured from: file name, and `clip_fingerprint` of its content
    footage: list[str] | None = None
    # Of eyes that turn, the left first; all of these or none
    eye_centers: NDArray[np.float64] | None = None  # 2 x 3, of the neutral's eyeballs
    iris_centers: NDArray[np.float64] | None = None  # 2 x 3, on them
    eye_of_vertex: NDArray[np.int64] | None = None  # V, 0 none, 1 left, 2 right
    # 2 x 2: closure of the upper lid a degree downwards, the pitch at which it is not carried
    lid_following: NDArray[np.float64] | None = None
    # N x E, what the pictures say about pose and values (`_core.pack_evidence`), for refining
    evidence: NDArray[np.float32] | None = None
    corrections: list[str] | None = None  # C: JSON of `performance.corrections`, one frame each
    # N x R, what refining changed, as the pictures alone had it (`refining.Refinement`)
    uncorrected: NDArray[np.float64] | None = None
    # P, of muscles that this person contracts further than is assumed; modes go that far
    muscle_extent: NDArray[np.float64] | None = None
    # N x P: what pictures cannot tell a muscle from, by its index among muscles, then articulators
    confounded_with: NDArray[np.int64] | None = None
    # S, frames with which another scene starts: nothing is smoothed over these cuts
    scene_starts: NDArray[np.int64] | None = None

    def __post_init__(self) -> None:
        for key, (kind, shape) in (REQUIRED | OPTIONAL).items():
            value = getattr(self, key)
            if value is None and key in OPTIONAL:
                continue
            if kind == "U":
                setattr(self, key, [str(name) for name in np.atleast_1d(value)])
            elif key == "fps":
                self.fps = float(np.asarray(value, dtype=np.float64).reshape(1)[0])
            else:
                array = np.asarray(value)
                if array.dtype.kind not in ACCEPTED[kind]:
                    raise InvalidInput(
                        f"performance {key} holds {array.dtype}; "
                        + ("whole numbers" if kind == "i" else "numbers")
                        + f" of the shape {_shape_text(shape)} are needed"
                    )
                setattr(self, key, np.ascontiguousarray(array, dtype=DTYPES[kind]))
        if self.notes is not None:
            self.notes = [shown(note) for note in self.notes]
        self.check()

    @property
    def num_frames(self) -> int:
        return len(self.frame)

    @property
    def pixel_aspect(self) -> float:
        """Width over height of the pixels that the footage's file stores, as they are shown."""
        if self.stored_size is None:
            return 1.0
        width, height = self.image_size / self.stored_size
        return float(width / height)

    @property
    def scenes(self) -> list[slice]:
        """Rows of each scene, in order; one of all where no cut is known."""
        starts = () if self.scene_starts is None else self.scene_starts
        bounds = np.unique([0, *np.searchsorted(self.frame, starts), self.num_frames]).tolist()
        return [slice(begin, after) for begin, after in itertools.pairwise(bounds)]

    def index_of(self, frame: int) -> int:
        """The index of a frame number; raises InvalidInput if the performance lacks it."""
        i = int(np.searchsorted(self.frame, frame))
        if i == self.num_frames or self.frame[i] != frame:
            raise InvalidInput(
                f"frame {frame} is not in the performance, "
                f"which has frames {self.frame[0]} to {self.frame[-1]}"
            )
        return i

    def surface(self, i: int) -> NDArray[np.float64]:
        """Control vertices (V x 3, metres, head frame) at frame index `i`, counted from 0."""
        shape = (-1, self.neutral_vertices.size)
        displacement = self.activations[i].astype(np.float32) @ self.muscle_modes.reshape(shape)
        if self.articulator_modes is not None and len(self.articulators):
            values = seen_articulators(self, slice(i, i + 1))[0].astype(np.float32)
            displacement += values @ self.articulator_modes.reshape(shape)
        if self.detail_modes is not None and self.detail_coefficients is not None:
            coefficients = self.detail_coefficients[i].astype(np.float32)
            displacement += coefficients @ self.detail_modes.reshape(shape)
        return with_eyes_turned(self, i, self.neutral_vertices + displacement.reshape(-1, 3))

    def is_of(self, fingerprint: str) -> bool:
        """Whether it is of the footage with a fingerprint; true if either is unknown."""
        return not (fingerprint and self.footage) or self.footage[1] == fingerprint

    def without_detail(self) -> Performance:
        """The same performance by its muscles and articulators alone."""
        return replace(
            self, detail_modes=None, detail_coefficients=None, detail_coefficients_std=None
        )

    def surface_in_camera(self, i: int) -> NDArray[np.float64]:
        """Control vertices (V x 3, metres, camera frame) at frame index `i`, counted from 0."""
        camera_from_head = self.head_pose[i]
        return self.surface(i) @ camera_from_head[:3, :3].T + camera_from_head[:3, 3]

    def project(self, points_in_camera: NDArray[np.float64]) -> NDArray[np.float64]:
        """Pixels (K x 2) of points (K x 3, metres, camera frame, z > 0)."""
        pixels = points_in_camera @ self.intrinsics.T
        return pixels[:, :2] / pixels[:, 2:]

    def check(self) -> None:
        """Raises InvalidInput: which key, which frame, what is wrong."""
        lengths = DOCUMENT.check_shapes(self)
        check_names("performance muscles and articulators", self.muscles + self.articulators)
        if (self.detail_modes is None) != (self.detail_coefficients is None):
            raise InvalidInput(
                "performance has one of detail_modes and detail_coefficients; it needs both or none"
            )
        if self.detail_coefficients_std is not None and self.detail_modes is None:
            raise InvalidInput("performance has detail_coefficients_std without detail_modes")
        if lengths["N"] < 1 or lengths["F"] < 1 or lengths["P"] < 1:
            raise InvalidInput("performance has no frames, no faces or no muscles")
        self._check_finite()
        self._check_ranges()
        from_texts(self.corrections or [])
        check_eyes(self, lengths["V"])

    def _check_finite(self) -> None:
        for key, (kind, shape) in (REQUIRED | OPTIONAL).items():
            value = getattr(self, key)
            if value is None or kind not in "fm" or is_bounded(np.asarray(value)):
                continue
            where = ""
            if shape[0] == "N":
                bad = next(i for i, row in enumerate(value) if not is_bounded(row))
                where = f" at frame {self.frame[bad]}"
            raise InvalidInput(
                f"performance {key} is not finite{where}, or too large; capture the footage again"
            )

    def _check_ranges(self) -> None:
        tolerance = 1e-6
        check_clip("performance", self.frame, self.fps, self.image_size, self.intrinsics)
        if self.stored_size is not None:
            check_size("performance stored_size", self.stored_size)
        if self.faces.min() < 0 or self.faces.max() >= len(self.neutral_vertices):
            raise InvalidInput("performance faces name vertices that do not exist")
        if self.groups.min() < 1 or self.groups.max() > 7:
            raise InvalidInput("performance groups must be 1 to 7")
        for key in ("activations", "quality"):
            value = getattr(self, key)
            if value.min() < -tolerance or value.max() > 1 + tolerance:
                raise InvalidInput(f"performance {key} must lie in 0 to 1")
        if self.muscle_extent is not None and not (self.muscle_extent >= 1).all():
            raise InvalidInput("performance muscle_extent must not be under 1")
        num_values = len(self.muscles) + len(self.articulators)
        if (of := self.confounded_with) is not None:
            if not ((of >= -1) & (of < num_values)).all():
                raise InvalidInput("performance confounded_with names values that do not exist")
            if (of == np.arange(len(self.muscles))).any():
                raise InvalidInput("performance confounded_with names a muscle for itself")
        if self.activations_std.min() < 0:
            raise InvalidInput("performance activations_std must not be negative")
        if self.articulator_values_std is not None and (self.articulator_values_std < 0).any():
            raise InvalidInput("performance articulator_values_std must not be negative")
        std = self.detail_coefficients_std
        if std is not None and (std < 0).any():
            raise InvalidInput("performance detail_coefficients_std must not be negative")
        if self.scene_starts is not None and (np.diff(self.scene_starts) < 1).any():
            raise InvalidInput("performance scene_starts must ascend")
        self._check_poses()
        self._check_footage()

    def _check_poses(self) -> None:
        largest = max(-self.head_pose_cov.min(), self.head_pose_cov.max())
        for start in range(0, self.num_frames, CHECKED_AT_ONCE):
            frames = slice(start, start + CHECKED_AT_ONCE)
            for what, bad in (
                ("head_pose is not a rigid motion", ~_core.are_rigid(self.head_pose[frames], 1e-4)),
                (
                    "head_pose_cov is not a covariance",
                    ~_core.are_covariances(self.head_pose_cov[frames], 1e-6 * largest),
                ),
            ):
                if bad.any():
                    frame = self.frame[frames][bad][0]
                    raise InvalidInput(f"performance {what} at frame {frame}")

    def _check_footage(self) -> None:
        if self.footage is None:
            return
        name, mark = self.footage
        # A name, never a way to somewhere: the file is looked for by it
        if not name or name in (".", "..") or re.search(r"[/\\\0]", name) or len(name) > 255:
            raise InvalidInput("performance footage must be a file name without its folder")
        if not is_fingerprint(mark):
            raise InvalidInput("performance footage has no fingerprint of a file's content")

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes `performance.npz`, whole or not at all."""
        self.check()
        write_arrays(path, DOCUMENT.arrays_of(self))

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Performance:
        """Reads and checks `performance.npz`; raises UnreadableMedia or InvalidInput."""
        what = "a performance (the performance.npz of a capture)"
        with open_arrays(path, what) as archive:
            return cls(**DOCUMENT.read(archive))


def _shape_text(shape: tuple[int | str, ...]) -> str:
    return " x ".join(str(length) for length in shape)
