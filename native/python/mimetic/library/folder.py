# SPDX-License-Identifier: GPL-3.0-or-later
"""A library of expressions: a folder with a file each, NAME.expression.npz, and its picture."""

from __future__ import annotations

import os
import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, UnreadableMedia
from mimetic.library.expression import Expression
from mimetic.shared.png import png_bytes
from mimetic.shared.regular_file import check_folder, check_replaceable
from mimetic.shared.shown_text import shown
from mimetic.shared.whole_file import whole_file

SUFFIX = ".expression.npz"
PICTURE_SUFFIX = ".png"
# No signs that a composition or a path has: @ * / and the like
NAME = re.compile(r"[\w][\w .+-]{0,58}")


class Library:
    """The expressions of a folder, by their names."""

    def __init__(self, folder: Path) -> None:
        self.folder = Path(folder)

    def names(self) -> list[str]:
        """In alphabetical order; raises UnreadableMedia where there is no folder."""
        try:
            files = sorted(path.name for path in self.folder.iterdir())
        except OSError as error:
            raise UnreadableMedia(
                f"{shown(self.folder)}: {error.strerror}; a library is the folder that "
                "`mimetic library keep` made"
            ) from None
        return [name.removesuffix(SUFFIX) for name in files if name.endswith(SUFFIX)]

    def load(self, name: str) -> Expression:
        """Raises InvalidInput where the library has no such expression, UnreadableMedia."""
        if name not in self.names():
            listing = ", ".join(map(shown, self.names())) or "nothing"
            raise InvalidInput(
                f"{shown(self.folder)} has no expression {shown(name)}; it has {listing}"
            )
        return Expression.load(self.path_of(name))

    def path_of(self, name: str) -> Path:
        return self.folder / f"{name}{SUFFIX}"

    def check_new(self, name: str, may_replace: bool = False) -> None:
        """Makes sure that an expression can be kept under a name; raises InvalidInput, OSError."""
        if not NAME.fullmatch(name) or name != name.strip():
            raise InvalidInput(
                f"{shown(name)!r} cannot name an expression: letters, digits, spaces and . _ + - "
                "are possible, 59 at most"
            )
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except FileExistsError:
            raise InvalidInput(f"{shown(self.folder)} is a file; a library is a folder") from None
        check_folder(self.folder, shown(self.folder))
        if self.path_of(name).exists() and not may_replace:
            raise InvalidInput(
                f"{shown(self.folder)} has an expression {shown(name)} already; give another name, "
                "or --replace"
            )
        if os.path.lexists(self.picture_of(name)) and not (
            may_replace or self.path_of(name).exists()
        ):
            raise InvalidInput(
                f"{shown(self.picture_of(name))} is there already, and of no expression; give "
                "another name, or --replace"
            )
        for path in (self.path_of(name), self.picture_of(name)):
            check_replaceable(path)

    def picture_of(self, name: str) -> Path:
        return self.folder / f"{name}{PICTURE_SUFFIX}"

    def keep(self, name: str, expression: Expression, picture: NDArray[np.uint8]) -> Path:
        """Writes the expression and its picture (H x W x 4); raises OSError."""
        with whole_file(self.picture_of(name)) as stream:
            stream.write(png_bytes(picture))
        expression.save(self.path_of(name))
        return self.path_of(name)
