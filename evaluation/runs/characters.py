# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic evaluate characters`: how near landmarks that place themselves come to the true ones."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, field

import numpy as np
from mimetic.character.face_units import FaceUnits
from mimetic.character.foreign_head import ForeignHead, attach_foreign
from mimetic.character.foreign_mesh import REQUIRED
from mimetic.character.self_landmarks import find_landmarks
from mimetic.score.json_text import json_text
from mimetic.score.text_table import text_table
from mimetic.template.face_template import load_template

from evaluation.anatomy.closed_eyes import seen_area
from evaluation.synthetic.characters import EYEBALL, OTHER, SETS, Character, characters

__all__ = ["SETS", "CharacterScore", "as_json", "as_text", "score_characters"]
BLINKS = ("eyeBlinkLeft", "eyeBlinkRight")
COLUMNS = {
    "mean": ("mean, % IPD", ".1f"),
    "median": ("median", ".1f"),
    "worst": ("worst", ".1f"),
    "doubtful": ("doubtful", ".0f"),
    "inside": ("in 2 sigma", ".2f"),
    "seconds": ("seconds", ".1f"),
}

SHAPE_COLUMNS = {
    "eyeBlinkLeft": ("left lids, mm", ".2f"),
    "eyeBlinkRight": ("right lids", ".2f"),
    "mouthClose": ("lips", ".2f"),
    "seen": ("eye seen, mm2", ".2f"),
    "depth": ("lid in eye, mm", ".2f"),
    "attach": ("attached, s", ".1f"),
    "shapes": ("52 shapes, s", ".1f"),
}


@dataclass(frozen=True)
class CharacterScore:
    """Errors in % of the interpupillary distance, by landmark; empty where no face was seen."""

    name: str
    num_vertices: int
    seconds: float
    errors: dict[str, float] = field(default_factory=dict)
    doubts: dict[str, float] = field(default_factory=dict)
    doubtful: list[str] = field(default_factory=list)
    shapes: dict[str, float] = field(default_factory=dict)  # gaps in mm and seconds of the 52

    def row(self) -> dict[str, float]:
        errors = np.array(list(self.errors.values()))
        if not len(errors):
            return {"seconds": self.seconds}
        within = errors < 2 * np.array([self.doubts[name] for name in self.errors])
        return {
            "mean": float(errors.mean()),
            "median": float(np.median(errors)),
            "worst": float(errors.max()),
            "doubtful": len(self.doubtful),
            "inside": float(within.mean()),
            "seconds": self.seconds,
        }


def score_shapes(character: Character) -> dict[str, float]:
    """What is left open by the 52 shapes of a head with its true landmarks, and their time."""
    started = time.perf_counter()
    metre = 0.063 / character.pupil_distance
    places = {name: metre * place for name, place in character.truth.items()}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        head = attach_foreign(
            metre * character.vertices, character.triangles, places, load_template()
        )
    attached = time.perf_counter()
    units = head.make_units()
    return {
        **units.gaps_mm,
        **score_closed_eyes(character, metre, head, units),
        "attach": attached - started,
        "shapes": time.perf_counter() - attached,
    }


def score_closed_eyes(
    character: Character, metre: float, head: ForeignHead, units: FaceUnits
) -> dict[str, float]:
    """Of a blink of both eyes: mm^2 of an eyeball that are seen, and how deep lids lie in it."""
    if not len(character.kind) or not units.depths_mm:
        return {}
    to_template = head.mesh_from_template.inverse()
    blink = sum(units.modes[units.names.index(name)] for name in BLINKS)
    shut = to_template.apply(metre * character.vertices + blink)
    drawn = character.triangles[(character.kind != OTHER)[character.triangles].all(axis=1)]
    seen = [
        seen_area(shut, np.ascontiguousarray(drawn), character.kind == EYEBALL, centre)
        for centre in to_template.apply(head.eye_centers)
    ]
    return {"seen": max(seen), "depth": max(units.depths_mm.values())}


def score_characters(which: str, report: Callable[[str], None]) -> Iterator[CharacterScore]:
    for character in characters(which):
        report(f"characters: {character.name}")
        yield score(character)


def score(character: Character) -> CharacterScore:
    started = time.perf_counter()
    placed = find_landmarks(character.vertices, character.triangles)
    seconds = time.perf_counter() - started
    size = len(character.vertices)
    if placed.guess:
        return CharacterScore(character.name, size, seconds)
    errors = {
        name: 100
        * float(np.sqrt(((placed.places[name] - place) ** 2).sum()))
        / character.pupil_distance
        for name, place in character.truth.items()
    }
    doubts = {name: 100 * doubt for name, doubt in placed.doubts.items()}
    shapes = score_shapes(character)
    return CharacterScore(character.name, size, seconds, errors, doubts, placed.doubtful, shapes)


def as_text(scores: list[CharacterScore]) -> str:
    """By head, then by landmark over all heads."""
    heads = {f"{score.name} ({score.num_vertices:,})": score.row() for score in scores}
    seen = [score for score in scores if score.errors]
    marks = {}
    for name in REQUIRED:
        errors = [score.errors[name] for score in seen]
        if errors:
            doubt = float(np.mean([score.doubts[name] for score in seen]))
            marks[name] = {"mean": np.mean(errors), "worst": np.max(errors), "doubt": doubt}
    by_mark = {
        "mean": ("mean, % IPD", ".1f"),
        "worst": ("worst", ".1f"),
        "doubt": ("said: sigma", ".1f"),
    }
    tables = [text_table("landmarks that place themselves (vertices)", COLUMNS, heads)]
    if marks:
        tables.append(text_table("by landmark", by_mark, marks))
        shapes = {score.name: score.shapes for score in seen}
        tables.append(text_table("ARKit's 52 shapes, widest gaps", SHAPE_COLUMNS, shapes))
    return "\n\n".join(tables)


def as_json(scores: list[CharacterScore]) -> str:
    return json_text([asdict(score) for score in scores])
