# SPDX-License-Identifier: GPL-3.0-or-later
"""What is done to a clip, command after command, and whether it was done with the same input."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from mimetic import __version__
from mimetic.batch.clip_list import Row, lens_words
from mimetic.batch.person import Person
from mimetic.media.clip_fingerprint import fingerprint
from mimetic.media.image_sequence import is_sequence, opened
from mimetic.shared.results import PERFORMANCE

BAKES = ("blend", "glb")
NAMES = ("capture", *BAKES, "character")  # of all steps, in order
CAPTURED = (PERFORMANCE, "fit.json", "overlay.mp4", "report.html")


@dataclass(frozen=True)
class Settings:
    """What is asked of every clip."""

    bakes: tuple[str, ...] = ()  # of BAKES
    with_detail: bool = False
    tolerance: float | None = None  # of few keys; None for a key a frame
    blender_python: str = ""


@dataclass(frozen=True)
class Step:
    """A command of Mimetic's that reads `inputs` and writes `outputs` in the clip's folder."""

    name: str
    words: tuple[str, ...]  # of the command line
    inputs: tuple[Path, ...]
    outputs: tuple[str, ...]
    choices: Mapping[str, object] = field(default_factory=dict)  # what changes the outputs
    leaves_parts: bool = False  # of its outputs, when it is stopped or fails

    def key(self) -> str:
        """Equal for equal content of the inputs, choices and version, wherever the files are.

        Raises UnreadableMedia where an input is missing.
        """
        contents = [fingerprint(opened(path)) for path in self.inputs]
        parts = [self.name, __version__, self.choices, contents]
        return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()


def steps_of(
    row: Row, settings: Settings, folder: Path, person: Person | None = None
) -> list[Step]:
    """The steps of a clip in the order in which they are done; person: whose fit it shares."""
    return [_capture(row, folder, person), *_bakes(row, settings, folder)]


def _capture(row: Row, folder: Path, person: Person | None) -> Step:
    words = ["capture", row.clip, "--out", str(folder)]
    if row.frames:
        words.append(f"--frames={row.frames}")
    words += (of_rate := rate_words(row.clip, row.fps))
    option, fit = "--fit", row.fit
    if person is not None and not row.fit:
        option, fit = ("--fit" if person.is_of(row.clip) else "--person"), person.fit
    words += [option, fit] if fit else []
    inputs = (Path(row.clip), *([Path(fit)] if fit else []))
    choices: dict[str, object] = {"frames": row.frames, "fit": option if fit else ""}
    if option != "--fit" or not fit:
        words += (of_lens := lens_words(row.focal, row.sensor))
        choices |= {"lens": of_lens} if of_lens else {}
    if of_rate:
        choices["fps"] = row.fps
    return Step("capture", tuple(words), inputs, CAPTURED, choices, leaves_parts=True)


def rate_words(clip: str, fps: str) -> list[str]:
    """Of a command line that reads a clip; video files have rates of their own."""
    return [f"--fps={fps}"] if fps and is_sequence(clip) else []


def _bakes(row: Row, settings: Settings, folder: Path) -> Iterable[Step]:
    performance, clip = folder / PERFORMANCE, Path(row.clip)
    words = ["bake", str(performance), "--footage", row.clip]
    if settings.blender_python:
        words += ["--blender-python", settings.blender_python]
    if settings.tolerance is not None:
        words.append(f"--few-keys={settings.tolerance:g}")
    face_words = ["--detail"] if settings.with_detail else []
    choices: dict[str, object] = {"detail": settings.with_detail, "tolerance": settings.tolerance}
    for kind in settings.bakes:
        out = f"face.{kind}"
        face = (*words, *face_words, "--out", str(folder / out))
        yield Step(kind, face, (performance, clip), (out,), choices)
    if row.character:
        rig, _, name = row.character.rpartition(":")
        out = "character.blend"
        target = (*words, "--target", row.character, "--out", str(folder / out))
        inputs = (performance, clip, Path(rig))
        choices = {"object": name}
        if settings.tolerance is not None:
            choices["tolerance"] = settings.tolerance
        yield Step("character", target, inputs, (out,), choices)
