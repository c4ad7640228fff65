# SPDX-License-Identifier: GPL-3.0-or-later
"""Head-shape modes from modelling targets: one mode per opposed pair, and per pair of sides."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from .head import INTERPUPILLARY_DISTANCE, NEUTRAL_ANCESTRIES, SEXES, Cut, mirrored
from .source import Source

FOLDERS = ("head", "forehead", "eyebrows", "eyes", "nose", "mouth", "cheek", "chin", "ears", "neck")
OPPOSED = (
    ("decr", "incr"),
    ("down", "up"),
    ("in", "out"),
    ("backward", "forward"),
    ("concave", "convex"),
    ("compress", "uncompress"),
)
# Moves of the whole head on the body, duplicates, and what can hardly be seen.
LEFT_OUT = re.compile(
    "head-trans|head-angle|neck-trans|neck-back|neck-scale-vert|measure-neck|ear-shape|head-age"
    "|asymm-|mouth-dimples|laugh-lines|asym-eye-[3-8]|asym-ear-[34]|asym-top|asym-temple-2"
)


@dataclass(frozen=True)
class Identity:
    names: list[str]
    modes: np.ndarray
    limits: np.ndarray


def identity_modes(
    source: Source, cut: Cut, vertices: np.ndarray, landmarks: Mapping[str, int], scale: float
) -> Identity:
    """All modes (I,V,3) in metres.

    None moves the point midway between the tragi or changes the distance of the eyes, since these
    two fix the frame in which every person is measured.
    """
    eyes = [cut.part_vertices(f"eye.{s}") for s in "LR"]
    tragi = [landmarks["tragus.L"], landmarks["tragus.R"]]
    names, modes, limits = [], [], []
    for name, displacement, limit in _all_targets(source):
        mode = cut.carry(displacement) * scale
        sign = -1.0 if name.startswith("asym") else 1.0
        mode = (mode + sign * mirrored(mode, cut.mirror)) / 2
        mode -= mode[tragi].mean(0)
        apart = mode[eyes[0], 0].mean() - mode[eyes[1], 0].mean()
        mode -= apart / INTERPUPILLARY_DISTANCE * vertices
        names.append(name)
        modes.append(mode)
        limits.append(limit)
    return Identity(names, np.array(modes), np.array(limits))


def _all_targets(source: Source) -> list[tuple[str, np.ndarray, tuple[float, float]]]:
    return _macro_modes(source) + _local_modes(source) + _asymmetric_modes(source)


def _macro_modes(source: Source) -> list[tuple[str, np.ndarray, tuple[float, float]]]:
    folder = "mpfb2/targets/macrodetails"

    def mean(template: str, **choices: tuple[str, ...]) -> np.ndarray:
        names = [template]
        for key, values in choices.items():
            names = [n.replace(f"<{key}>", v) for n in names for v in values]
        return sum(source.target(f"{folder}/{n}.target.gz") for n in names) / len(names)

    body = "universal-<sex>-<age>-<muscle>muscle-<weight>weight"

    def person(sexes: tuple[str, ...], age: str) -> np.ndarray:
        face = mean("<a>-<sex>-" + age, a=NEUTRAL_ANCESTRIES, sex=sexes)
        average = body.replace("<age>", age).replace("<muscle>", "average")
        return face + mean(average.replace("<weight>", "average"), sex=sexes)

    def build(muscle: str, weight: str) -> np.ndarray:
        filled = body.replace("<age>", "young").replace("<muscle>", muscle)
        return mean(filled.replace("<weight>", weight), sex=SEXES)

    young = person(SEXES, "young")
    modes = [
        ("sex_male", (person(("male",), "young") - person(("female",), "young")) / 2, (-1.5, 1.5)),
        ("age_old", person(SEXES, "old") - young, (0.0, 1.0)),
        ("weight", (build("average", "max") - build("average", "min")) / 2, (-1.0, 1.0)),
        ("muscle", (build("max", "average") - build("min", "average")) / 2, (-1.0, 1.0)),
    ]
    common = mean("<a>-<sex>-young", a=NEUTRAL_ANCESTRIES, sex=SEXES)
    for ancestry in NEUTRAL_ANCESTRIES:
        own = mean(f"{ancestry}-<sex>-young", sex=SEXES)
        modes.append((f"ancestry_{ancestry}", own - common, (-0.5, 1.0)))
    return modes


def _local_modes(source: Source) -> list[tuple[str, np.ndarray, tuple[float, float]]]:
    modes = []
    for folder in FOLDERS:
        stems = [n.removesuffix(".target.gz") for n in source.names(f"mpfb2/targets/{folder}")]
        stems = [s for s in stems if not LEFT_OUT.search(s)]
        singles = dict.fromkeys(re.sub(r"^r-", "l-", s) for s in stems)
        while singles:
            stem, _ = singles.popitem()
            base, _, ending = stem.rpartition("-")
            pair = next((p for p in OPPOSED if ending in p), None)
            label = re.sub(r"^l-", "", base if pair else stem).replace("-", "_")
            label = label.replace("nose_nostrils", "nostrils")
            if pair is None:
                modes.append((label, _both_sides(source, folder, stem), (0.0, 1.0)))
                continue
            for end in pair:
                singles.pop(f"{base}-{end}", None)
            minus, plus = (_both_sides(source, folder, f"{base}-{end}") for end in pair)
            kind = {"down": "_height", "in": "_side", "backward": "_depth"}.get(pair[0], "")
            # A midline feature moved in or out goes to one side.
            one_sided = pair[0] == "in" and base.endswith("-trans") and not stem.startswith("l-")
            label = "asym_" + label if one_sided else label
            modes.append((label + kind, (plus - minus) / 2, (-1.0, 1.0)))
    return sorted(modes, key=lambda mode: mode[0])


def _both_sides(source: Source, folder: str, stem: str) -> np.ndarray:
    path = f"mpfb2/targets/{folder}"
    field = source.target(f"{path}/{stem}.target.gz")
    if stem.startswith("l-"):
        field += source.target(f"{path}/r-{stem[2:]}.target.gz")
    return field


def _asymmetric_modes(source: Source) -> list[tuple[str, np.ndarray, tuple[float, float]]]:
    path = "mpfb2/targets/asym"
    modes = []
    for name in source.names(path):
        stem = name.removesuffix(".target.gz")
        if LEFT_OUT.search(stem) or not stem.endswith("-l"):
            continue
        left = source.target(f"{path}/{name}")
        right = source.target(f"{path}/{stem[:-1]}r.target.gz")
        label = stem[:-2].replace("-", "_").replace("brown", "brow")
        modes.append((label, (left - right) / 2, (-1.0, 1.0)))
    return modes
