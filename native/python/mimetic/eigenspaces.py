# SPDX-License-Identifier: GPL-3.0-or-later
"""Eigenspaces of faces and their parts: the model, its file, and finding a face with it."""

from __future__ import annotations

import os
import zipfile
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, UnreadableMedia, _core
from mimetic.array_file import check_shape, read_array, read_headers
from mimetic.whole_file import whole_file

SCHEMA = 1
MOST_VIEWS, MOST_MODULES = 9, 6
LARGEST = {"N": 1 << 16, "M": 256, "C": 2 * MOST_MODULES}
SPACE_ARRAYS: dict[str, tuple[int | str, ...]] = {
    "size": (2,),
    "mean": ("N",),
    "basis": ("M", "N"),
    "eigenvalues": ("M",),
    "rho": (),
}


@dataclass(frozen=True)
class FoundFace:
    """A face found by maximum likelihood; pixels, left and right are the subject's."""

    match: _core.SpaceMatch
    yaw: float  # degrees, of the view that fits best
    places: dict[str, NDArray[np.float64]]  # 2 each, by module
    log_likelihood: dict[str, float]  # by module
    score: float  # sum of all log likelihoods less half the prior's distance


@dataclass(frozen=True)
class Eigenspaces:
    """View-based spaces of the whole face and modular ones of its parts."""

    views: list[_core.Eigenspace]  # of one patch size
    yaws: list[float]  # degrees, one a view
    modules: list[_core.FaceModule] = field(default_factory=list)
    covariance: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 0)))
    # of the modules' places (x0, y0, x1, ...), in squared widths of the face's patch

    def __post_init__(self) -> None:
        if not 1 <= len(self.views) <= MOST_VIEWS or len(self.yaws) != len(self.views):
            raise InvalidInput(f"eigenspaces need 1 to {MOST_VIEWS} views and a yaw for each")
        if len(self.modules) > MOST_MODULES:
            raise InvalidInput(f"eigenspaces hold at most {MOST_MODULES} modules")
        check_shape("covariance", self.covariance.shape, (2 * len(self.modules),) * 2, {}, {})

    def find(
        self, image: NDArray[np.uint8], options: _core.SpaceSearchOptions | None = None
    ) -> list[FoundFace]:
        """Faces in a (H, W) grey image, the highest score first; raises InvalidInput."""
        found = []
        for match in _core.search_spaces(self.views, image, options or _core.SpaceSearchOptions()):
            places, likelihoods, score = {}, {}, match.log_likelihood
            if self.modules:
                parts = _core.place_modules(self.modules, self.covariance, image, match)
                names = [module.name for module in self.modules]
                places = dict(zip(names, parts.positions, strict=True))
                likelihoods = dict(zip(names, parts.log_likelihood.tolist(), strict=True))
                score += parts.log_likelihood.sum() - 0.5 * parts.prior
            yaw = self.yaws[match.view]
            found.append(FoundFace(match, yaw, places, likelihoods, float(score)))
        return sorted(found, key=lambda face: -face.score)

    def save(self, path: str | os.PathLike) -> None:
        """Writes an .npz, whole or not at all; raises OSError."""
        arrays = {
            "schema": np.array(SCHEMA),
            "yaws": np.array(self.yaws, float),
            "module_names": np.array([module.name for module in self.modules], np.str_),
            "module_widths": np.array([module.width for module in self.modules], float),
            "module_places": np.array([m.place for m in self.modules], float).reshape(-1, 2),
            "covariance": self.covariance,
        }
        for i, space in enumerate(self.views):
            arrays |= _arrays_of(f"view_{i}", space)
        for i, module in enumerate(self.modules):
            arrays |= _arrays_of(f"module_{i}", module.space)
        with whole_file(path) as stream:
            np.savez_compressed(stream, **arrays)

    @classmethod
    def load(cls, path: str | os.PathLike) -> Eigenspaces:
        """Raises InvalidInput for a file that is no model, UnreadableMedia for one unreadable."""
        try:
            with zipfile.ZipFile(path) as archive:
                return _read(archive)
        except (OSError, zipfile.BadZipFile, EOFError) as error:
            raise UnreadableMedia(f"{path}: {error}") from None
        except InvalidInput as error:
            raise InvalidInput(f"{path}: {error}") from None


def train(patches: NDArray[np.uint8], num_modes: int, shrinkage: float = 0.01) -> _core.Eigenspace:
    """The space of grey patches (K x H x W); raises InvalidInput."""
    if patches.ndim != 3:
        raise InvalidInput(f"patches have the shape {patches.shape}; K x H x W is needed")
    count, height, width = patches.shape
    flat = np.ascontiguousarray(patches.reshape(count, -1), np.float64)
    return _core.train_eigenspace(flat, width, height, num_modes, shrinkage)


def _arrays_of(prefix: str, space: _core.Eigenspace) -> dict[str, NDArray]:
    return {
        f"{prefix}_size": np.array([space.width, space.height]),
        f"{prefix}_mean": space.mean,
        # Single precision halves the file and is far below what pixels tell
        f"{prefix}_basis": space.basis.astype(np.float32),
        f"{prefix}_eigenvalues": space.eigenvalues,
        f"{prefix}_rho": np.array(space.rho),
    }


def _read(archive: zipfile.ZipFile) -> Eigenspaces:
    headers = read_headers(archive)
    if not all(header.dtype.kind in "fiuU" for header in headers.values()):
        raise InvalidInput("holds arrays of neither numbers nor names")

    def read(name: str, shape: tuple[int | str, ...], lengths: dict, kinds: str = "fiu"):
        if name not in headers:
            raise InvalidInput(f"lacks {name}: not a file of eigenspaces")
        header = headers[name]
        check_shape(
            name, header.shape, shape, lengths, LARGEST | {"V": MOST_VIEWS, "K": MOST_MODULES}
        )
        if header.dtype.kind not in kinds:
            raise InvalidInput(f"{name} has the type {header.dtype}")
        return read_array(archive, name)

    def space(prefix: str) -> _core.Eigenspace:
        lengths: dict[str, int] = {}
        a = {n: read(f"{prefix}_{n}", shape, lengths) for n, shape in SPACE_ARRAYS.items()}
        try:
            return _core.Eigenspace(
                *(int(side) for side in a["size"]),
                a["mean"].astype(float),
                a["basis"].astype(float),
                a["eigenvalues"].astype(float),
                float(a["rho"]),
            )
        except InvalidInput as error:
            raise InvalidInput(f"{prefix}: {error}") from None

    if (schema := int(read("schema", (), {}))) != SCHEMA:
        raise InvalidInput(f"has schema {schema}, this version reads {SCHEMA}: update Mimetic")
    counts: dict[str, int] = {}
    yaws = read("yaws", ("V",), counts).astype(float).tolist()
    names = read("module_names", ("K",), counts, "U").tolist()
    widths = read("module_widths", ("K",), counts).astype(float).tolist()
    places = read("module_places", ("K", 2), counts).astype(float)
    modules = [
        _core.FaceModule(name, space(f"module_{i}"), widths[i], places[i])
        for i, name in enumerate(names)
    ]
    covariance = read("covariance", ("C", "C"), {}).astype(float)
    return Eigenspaces([space(f"view_{i}") for i in range(len(yaws))], yaws, modules, covariance)
