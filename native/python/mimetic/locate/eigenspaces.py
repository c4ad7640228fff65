# SPDX-License-Identifier: GPL-3.0-or-later
"""Eigenspaces of faces and their parts: training one, and the file they are kept in."""

from __future__ import annotations

import os

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.shared.array_file import ArrayArchive, check_names, check_shape, open_arrays
from mimetic.shared.array_writer import write_arrays
from mimetic.shared.installed_data import installed

SCHEMA = 2
FILE_NAME = "face_spaces.npz"  # in the folder of installed data
MOST_VIEWS, MOST_MODULES = 9, 6
LARGEST = {"N": 1 << 14, "M": 256, "V": MOST_VIEWS, "K": MOST_MODULES, "C": 2 * MOST_MODULES}
LARGEST |= {"E": 64}
SPACE_ARRAYS: dict[str, tuple[int | str, ...]] = {
    "size": (2,),
    "mean": ("N",),
    "basis": ("M", "N"),
    "eigenvalues": ("M",),
    "rho": (),
}
VIEW_ARRAYS: dict[str, tuple[int | str, ...]] = {
    "yaws": ("V",),
    "filters": ("V", "N"),
    "thresholds": ("V",),
    "places": ("V", "C"),
    "covariances": ("V", "C", "C"),
}


def train(windows: NDArray[np.floating], num_modes: int, shrinkage: float) -> _core.Eigenspace:
    """The space of windows of flattened contrast (K x H x W); raises InvalidInput."""
    if windows.ndim != 3:
        raise InvalidInput(f"windows have the shape {windows.shape}; K x H x W is needed")
    count, height, width = windows.shape
    flat = np.ascontiguousarray(windows.reshape(count, -1), np.float64)
    return _core.train_eigenspace(flat, width, height, num_modes, shrinkage)


def installed_spaces() -> _core.FaceSpaces:
    """The spaces that come with the package; raises UnreadableMedia without them."""
    return installed(FILE_NAME, load)


def save(spaces: _core.FaceSpaces, path: str | os.PathLike) -> None:
    """Writes an .npz, whole or not at all; raises OSError."""
    arrays = {
        "schema": np.array(SCHEMA),
        "module_names": np.array([module.name for module in spaces.modules], np.str_),
        "module_widths": np.array([module.width for module in spaces.modules], float),
        "weights": spaces.weights,
        "yaws": np.array([view.yaw for view in spaces.views], float),
        "filters": np.array([view.filter for view in spaces.views], np.float32),
        "thresholds": np.array([view.threshold for view in spaces.views], float),
        "places": np.array([view.places for view in spaces.views], float),
        "covariances": np.array([view.covariance for view in spaces.views], float),
    }
    arrays |= _arrays_of("other", spaces.other)
    for i, view in enumerate(spaces.views):
        arrays |= _arrays_of(f"view_{i}", view.space)
    for i, module in enumerate(spaces.modules):
        arrays |= _arrays_of(f"module_{i}", module.space)
        arrays |= _arrays_of(f"module_{i}_other", module.other)
    write_arrays(path, arrays)


def load(path: str | os.PathLike) -> _core.FaceSpaces:
    """Raises InvalidInput for a file that holds no spaces, UnreadableMedia for one unreadable."""
    with open_arrays(path, "a file of eigenspaces") as archive:
        return _read(archive)


def _arrays_of(prefix: str, space: _core.Eigenspace) -> dict[str, NDArray]:
    return {
        f"{prefix}_size": np.array([space.width, space.height]),
        f"{prefix}_mean": space.mean,
        # Single precision halves the file and is far finer than what pixels resolve
        f"{prefix}_basis": space.basis.astype(np.float32),
        f"{prefix}_eigenvalues": space.eigenvalues,
        f"{prefix}_rho": np.array(space.rho),
    }


def _read(archive: ArrayArchive) -> _core.FaceSpaces:
    headers = archive.headers
    if not all(header.dtype.kind in "fiuU" for header in headers.values()):
        raise InvalidInput("holds arrays of neither numbers nor names")

    def read(
        name: str, shape: tuple[int | str, ...], lengths: dict[str, int], kinds: str = "fiu"
    ) -> np.ndarray:
        if name not in headers:
            raise InvalidInput(f"lacks {name}: not a file of eigenspaces")
        header = headers[name]
        check_shape(name, header.shape, shape, lengths, LARGEST)
        if header.dtype.kind not in kinds:
            raise InvalidInput(f"{name} has the type {header.dtype}")
        return archive.read_one(name, None if header.dtype.kind == "U" else float)

    def space(prefix: str) -> _core.Eigenspace:
        lengths: dict[str, int] = {}
        a = {n: read(f"{prefix}_{n}", shape, lengths) for n, shape in SPACE_ARRAYS.items()}
        if not ((a["size"] >= 1) & (a["size"] <= LARGEST["N"])).all():
            raise InvalidInput(f"{prefix}_size is {a['size'].tolist()}")
        try:
            width, height = (int(side) for side in a["size"])
            return _core.Eigenspace(
                width,
                height,
                a["mean"],
                a["basis"],
                a["eigenvalues"],
                float(a["rho"]),
            )
        except InvalidInput as error:
            raise InvalidInput(f"{prefix}: {error}") from None

    if (schema := int(read("schema", (), {}))) != SCHEMA:
        raise InvalidInput(f"has schema {schema}, this version reads {SCHEMA}: update Mimetic")
    counts: dict[str, int] = {}
    names = read("module_names", ("K",), counts, "U").tolist()
    check_names("module_names", names)
    widths = read("module_widths", ("K",), counts).tolist()
    v = {n: read(n, shape, counts) for n, shape in VIEW_ARRAYS.items()}
    views = [
        _core.ViewSpace(yaw, v["filters"][i], threshold, space(f"view_{i}"), *places)
        for i, (yaw, threshold, *places) in enumerate(
            zip(v["yaws"], v["thresholds"], v["places"], v["covariances"], strict=True)
        )
    ]
    modules = [
        _core.ModuleSpace(name, space(f"module_{i}"), space(f"module_{i}_other"), widths[i])
        for i, name in enumerate(names)
    ]
    weights = read("weights", ("E",), {})
    return _core.FaceSpaces(views, space("other"), modules, weights)
