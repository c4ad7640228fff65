# SPDX-License-Identifier: GPL-3.0-or-later
"""Words for how the package was found, and the version that it must have."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from enum import Enum
from functools import cache
from pathlib import Path


class State(Enum):
    ready = "ready"
    missing = "missing"
    broken = "broken"
    other_version = "other version"


@dataclass(frozen=True)
class Status:
    state: State
    text: str  # what is wrong and what to do; the version if all is well


def no_module_for(python: str) -> Status:
    return Status(
        State.missing,
        f"This build of Mimetic carries no module for {python}. "
        "Install the Mimetic zip made for this Blender",
    )


@cache
def extension_version() -> str:
    manifest = Path(__file__).with_name("blender_manifest.toml")
    return tomllib.loads(manifest.read_text(encoding="utf-8"))["version"]
