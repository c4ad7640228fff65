# SPDX-License-Identifier: GPL-3.0-or-later
"""The only door to the package `mimetic`, whose compiled module may be missing or not fit."""

from __future__ import annotations

import importlib
import sys
import tomllib
from dataclasses import dataclass
from enum import Enum
from functools import cache
from pathlib import Path
from types import ModuleType

import numpy as np


class State(Enum):
    ready = "ready"
    missing = "missing"
    broken = "broken"
    other_version = "other version"


@dataclass(frozen=True)
class Status:
    state: State
    text: str  # what is wrong and what to do; the version if all is well


@cache
def status() -> Status:
    """Whether the package can be used; asked once a session, as a loaded library stays loaded."""
    try:
        version = importlib.import_module("mimetic").__version__
    except ModuleNotFoundError as error:
        python = f"Python {sys.version_info.major}.{sys.version_info.minor} on {sys.platform}"
        if error.name in ("mimetic", "mimetic._core"):
            return Status(
                State.missing,
                f"This build of Mimetic carries no module for {python}. "
                "Install the Mimetic zip made for this Blender",
            )
        return Status(State.broken, f"Mimetic's module needs {error.name}, which is missing")
    except ImportError as error:
        return Status(
            State.broken,
            f"Mimetic's module cannot be loaded ({error}). "
            "Restart Blender; if it stays, install Mimetic again",
        )
    if version != extension_version():
        return Status(
            State.other_version,
            f"Mimetic's module is {version}, the extension {extension_version()}. "
            "Restart Blender to finish the update",
        )
    return Status(State.ready, version)


def problem() -> str:
    """Why nothing can run, or the empty string."""
    return "" if status().state is State.ready else status().text


def part(name: str) -> ModuleType:
    """A module of the package, as in part("pipeline")."""
    return importlib.import_module(f"mimetic.{name}")


def array(matrix):
    """A matrix of Blender's as the package takes them."""
    return np.array(matrix, dtype=np.float64)


def known_errors() -> tuple[type[Exception], ...]:
    """What bad input raises, with a text that is fit to show."""
    package = importlib.import_module("mimetic")
    return (package.InvalidInput, package.UnreadableMedia, OSError)


def invalid_input(text: str) -> Exception:
    """What to raise for bad input; among `known_errors`."""
    return importlib.import_module("mimetic").InvalidInput(text)


@cache
def extension_version() -> str:
    manifest = Path(__file__).with_name("blender_manifest.toml")
    return tomllib.loads(manifest.read_text(encoding="utf-8"))["version"]
