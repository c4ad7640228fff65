# SPDX-License-Identifier: GPL-3.0-or-later
"""What stands still in the picture before the face, as a fit and its file keep it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mimetic import InvalidInput, _core
from mimetic.shared.documents import numbers

IN, OUT = "#", "."  # a cell of the picture that it is in, and one that it is not
MOST_CELLS = 400  # along a side


@dataclass(frozen=True)
class StillCover:
    """Captions, logos, a microphone on its stand: square cells of the picture that they are in."""

    corner: tuple[float, float] = (0.0, 0.0)  # top left of the first cell, pixels
    cell: float = 1.0  # side of a cell, pixels
    rows: tuple[str, ...] = ()  # downward; IN or OUT for each cell; none: there is nothing

    @classmethod
    def of(cls, found: _core.StillCover | None) -> StillCover:
        """What a `_core.StillCoverWatch` has found."""
        if found is None:
            return cls()
        rows = tuple("".join(np.where(row, IN, OUT)) for row in found.cells)
        x, y = found.corner.tolist()
        return cls((x, y), found.cell, rows)

    def in_core(self) -> _core.StillCover | None:
        """As a tracker takes it; None where there is nothing."""
        if not self.rows:
            return None
        cells = np.array([list(row) for row in self.rows]) == IN
        return _core.StillCover(np.array(self.corner), self.cell, cells)

    def as_json(self) -> dict:
        if not self.rows:
            return {}
        return {"corner": list(self.corner), "cell": self.cell, "rows": list(self.rows)}

    @classmethod
    def from_json(cls, document: object) -> StillCover:
        """Raises InvalidInput naming the field."""
        if document == {}:
            return cls()
        if not isinstance(document, dict) or sorted(document) != ["cell", "corner", "rows"]:
            raise InvalidInput(
                "still_cover of a face fit must be an object with corner, cell and rows"
            )
        corner = numbers("still_cover's corner", document["corner"], (2,))
        cell = float(numbers("still_cover's cell", document["cell"], ()))
        if not 0.1 <= cell <= 16384:
            raise InvalidInput(
                f"still_cover of a face fit has cells of {cell:g} pixels; .1 to 16384 are needed"
            )
        rows = document["rows"]
        if (
            not isinstance(rows, list)
            or not 1 <= len(rows) <= MOST_CELLS
            or not all(isinstance(row, str) and set(row) <= {IN, OUT} for row in rows)
            or {len(row) for row in rows} - {*range(1, MOST_CELLS + 1)}
            or len({len(row) for row in rows}) != 1
        ):
            raise InvalidInput(
                f"still_cover of a face fit must have 1 to {MOST_CELLS} rows of one length, of the "
                f"signs {IN} and {OUT}"
            )
        return cls((float(corner[0]), float(corner[1])), cell, tuple(rows))
