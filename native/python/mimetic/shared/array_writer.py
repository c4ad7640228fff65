# SPDX-License-Identifier: GPL-3.0-or-later
"""Writing numpy archives (.npz), whole or not at all.

Unlike numpy's own writer this one closes what it has begun when the disk is full: numpy leaves
that to the collector, which tries again and prints a traceback.
"""

from __future__ import annotations

import contextlib
import os
import zipfile
from collections.abc import Iterator, Mapping
from typing import IO

import numpy as np
from numpy.lib import format as npy
from numpy.typing import ArrayLike, DTypeLike

from mimetic.shared.whole_file import whole_file


@contextlib.contextmanager
def whole_archive(path: str | os.PathLike[str]) -> Iterator[zipfile.ZipFile]:
    """A compressed archive that appears at `path` when the block ends well; raises OSError."""
    with (
        whole_file(path) as stream,
        zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive,
    ):
        yield archive


def write_arrays(path: str | os.PathLike[str], arrays: Mapping[str, ArrayLike]) -> None:
    """Writes arrays of numbers or names, whole or not at all; raises OSError."""
    with whole_archive(path) as archive:
        for name, values in arrays.items():
            with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
                npy.write_array(member, np.asanyarray(values), allow_pickle=False)


@contextlib.contextmanager
def array_stream(
    archive: zipfile.ZipFile, name: str, shape: tuple[int, ...], dtype: DTypeLike
) -> Iterator[IO[bytes]]:
    """An array of the archive, its header written, to write its numbers to in C order."""
    with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
        descr = npy.dtype_to_descr(np.dtype(dtype))
        header = {"descr": descr, "fortran_order": False, "shape": shape}
        npy.write_array_header_1_0(member, header)
        yield member
