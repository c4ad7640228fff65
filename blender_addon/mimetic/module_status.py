# SPDX-License-Identifier: GPL-3.0-or-later
"""Words for how the package was found, and the version that it must have."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, field
from enum import Enum
from functools import cache
from pathlib import Path

from bpy.app.translations import pgettext_iface as iface_


class State(Enum):
    ready = "ready"
    missing = "missing"
    broken = "broken"
    other_version = "other version"


@dataclass(frozen=True)
class Status:
    state: State
    message: str  # what is wrong and what to do; the version if all is well
    values: dict[str, object] = field(default_factory=dict)  # of the message, by their names

    @property
    def text(self) -> str:
        """In the language that Blender has now: a status is asked once a session."""
        return iface_(self.message).format(**self.values)


def no_module_for(python: str) -> Status:
    message = (
        "This build of Mimetic carries no module for {python}. "
        "Install the Mimetic zip made for this Blender"
    )
    return Status(State.missing, message, {"python": python})


def part_missing(name: str) -> Status:
    return Status(State.broken, "Mimetic's module needs {name}, which is missing", {"name": name})


def not_loaded(error: ImportError) -> Status:
    message = (
        "Mimetic's module cannot be loaded ({error}). "
        "Restart Blender; if it stays, install Mimetic again"
    )
    return Status(State.broken, message, {"error": error})


def of_other_version(version: str) -> Status:
    message = (
        "Mimetic's module is {version}, the extension {extension}. "
        "Restart Blender to finish the update"
    )
    values = {"version": version, "extension": extension_version()}
    return Status(State.other_version, message, values)


@cache
def extension_version() -> str:
    manifest = Path(__file__).with_name("blender_manifest.toml")
    return tomllib.loads(manifest.read_text(encoding="utf-8"))["version"]
