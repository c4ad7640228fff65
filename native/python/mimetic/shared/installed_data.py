# SPDX-License-Identifier: GPL-3.0-or-later
"""Trained models that come with the package."""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import TypeVar

from mimetic import UnreadableMedia

Model = TypeVar("Model")


def installed(name: str, load: Callable[[Path], Model]) -> Model:
    """What `load` makes of an installed file, the same until it changes; raises UnreadableMedia."""
    path = data_folder() / name
    try:
        return _loaded(load, path, path.stat().st_mtime_ns)
    except OSError as error:
        raise UnreadableMedia(f"{path}: {error.strerror}; build the package again") from None


@lru_cache(maxsize=4)
def _loaded(load: Callable[[Path], Model], path: Path, _modification_time: int) -> Model:
    return load(path)


def data_folder() -> Path:
    """Where the installed data files are: `MIMETIC_DATA`, or `data` beside the compiled module."""
    if folder := os.environ.get("MIMETIC_DATA"):
        return Path(folder)
    from mimetic import _core

    return Path(_core.__file__).parent / "data"
