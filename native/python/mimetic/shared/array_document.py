# SPDX-License-Identifier: GPL-3.0-or-later
"""Documents that are archives of arrays: which keys of which shapes, checked before any is read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import DTypeLike

from mimetic import InvalidInput
from mimetic.shared.array_file import ArrayArchive, check_shape

Keys = Mapping[str, tuple[str, tuple[int | str, ...]]]


@dataclass(frozen=True)
class ArrayDocument:
    """What the archives of one kind hold.

    required, optional: key -> (kind of number, shape), equal letters are equal lengths; accepted:
    kind -> numpy's kinds that serve; largest: of each length; advice: what to do about a key that
    is missing.
    """

    what: str
    schema: int
    required: Keys
    optional: Keys
    accepted: Mapping[str, str]
    dtypes: Mapping[str, DTypeLike]
    largest: Mapping[str, int]
    advice: str

    def read(self, archive: ArrayArchive) -> dict[str, Any]:
        """The arrays of all keys that are there; raises InvalidInput, nothing being read first."""
        self._check_schema(archive)
        # Every shape is checked before the first large array is read: a small file can claim
        # terabytes
        lengths: dict[str, int] = {}
        dtypes = {}
        for key, (kind, shape) in {**self.required, **self.optional}.items():
            header = archive.headers.get(key)
            if header is None:
                if key in self.optional:
                    continue
                raise InvalidInput(f"{self.what} lacks the key {key}; {self.advice}")
            if header.dtype.kind not in self.accepted[kind]:
                raise InvalidInput(f"{self.what} {key} has the type {header.dtype}")
            # numpy writes a number by itself without a shape
            actual = header.shape or ((1,) if shape == (1,) else ())
            check_shape(f"{self.what} {key}", actual, shape, lengths, dict(self.largest))
            dtypes[key] = self.dtypes.get(kind)
        return {key: np.atleast_1d(array) for key, array in archive.read(dtypes).items()}

    def arrays_of(self, document: object) -> dict[str, np.ndarray]:
        """What an archive of a document holds: its fields that are not None, and the schema."""
        arrays = {"schema": np.array([self.schema], np.int64)}
        for key, (kind, _) in {**self.required, **self.optional}.items():
            value = getattr(document, key)
            if value is not None:
                arrays[key] = (
                    np.array(value, dtype=np.str_) if kind == "U" else np.atleast_1d(value)
                )
        return arrays

    def check_shapes(self, document: object) -> dict[str, int]:
        """The lengths that a document's fields have, which are named as the keys.

        A field that is None is missing. Raises InvalidInput where lengths do not agree.
        """
        lengths: dict[str, int] = {}
        for key, (_, shape) in {**self.required, **self.optional}.items():
            value = getattr(document, key)
            if value is not None:
                actual = np.shape(np.atleast_1d(value))
                check_shape(f"{self.what} {key}", actual, shape, lengths, dict(self.largest))
        return lengths

    def _check_schema(self, archive: ArrayArchive) -> None:
        header = archive.headers.get("schema")
        if header is None:
            raise InvalidInput(f"is not a {self.what}: it has no schema number")
        if header.shape not in ((), (1,)) or header.dtype.kind not in "iu":
            raise InvalidInput("the schema must be one whole number")
        schema = int(archive.read_one("schema").reshape(-1)[0])
        if schema != self.schema:
            newer = "a newer version of Mimetic wrote it; update Mimetic"
            why = newer if schema > self.schema else "no such schema existed"
            raise InvalidInput(f"has schema {schema}, this version reads {self.schema}: {why}")
