# SPDX-License-Identifier: GPL-3.0-or-later
"""Drawn people's clips encoded again, captured by textures of several sizes.

    .venv/bin/python -m evaluation.runs.compressed --people 9 --crf 26 30 \\
        --tracker crop_height=200 sample_spacing=4 --tracker crop_height=300 sample_spacing=6

The first clips of `--set full-tuning` (or `consistency-tuning`), as they were drawn and encoded
once more at each of the constant rate factors of H.264. Each is captured as it is, where the
texture's size follows the footage, and with each of the settings, from one fit. Printed are the
contrast that decides (`mimetic.solve.texture_size`) and the motion that is explained in the image,
by muscles alone, and in space (R2).
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from mimetic import InvalidInput
from mimetic.media.footage import Footage
from mimetic.score.json_text import json_text
from mimetic.score.text_table import text_table
from mimetic.score.truth import Truth
from mimetic.solve import clip_capture
from mimetic.solve.texture_size import fine_contrast
from mimetic.template.face_template import load_template

from evaluation.progress import to_stderr
from evaluation.runs.ablations import Variant, capture_varied, variant_of
from evaluation.runs.deviation import Explained
from evaluation.runs.expressions import Take, seen_at_start, shown_expressions, takes
from evaluation.runs.methods import MUSCLES, OURS, of_performance
from evaluation.runs.settings import AS_IT_IS
from evaluation.synthetic import footage
from evaluation.synthetic.recipes import TEST

SETS = ("full-tuning", "consistency-tuning")
COLUMNS = {
    "contrast": ("contrast", ".3f"),
    "image": ("R2 with detail", ".3f"),
    "muscles": ("muscles alone", ".3f"),
    "space": ("in space", ".3f"),
}
Figures = dict[str, float]


def encodings(clip: Path, factors: list[int], folder: Path) -> Iterator[tuple[str, Path]]:
    """The clip by how it is encoded: as it was drawn, then by each factor."""
    yield "as drawn", clip
    source = Footage(clip)
    frames = np.stack([image for _, image in source])
    for factor in factors:
        path = folder / f"crf-{factor}.mp4"
        footage.encode(frames, path, replace(TEST, fps=round(source.fps), crf=factor))
        yield f"crf {factor}", path


def figures(take: Take, clip: Path, variants: dict[str, Variant]) -> dict[str, Figures]:
    """By variant, of one encoding of a take."""
    truth = seen_at_start(Truth.load(take.clip.truth))
    fit, template = clip_capture.find_face(clip), load_template()
    source = Footage(clip)
    of_fit = (source, fit, fit.neutral_vertices(template), template)
    contrast = fine_contrast(source.read(fit.frame), *of_fit)
    rows = {}
    for name, variant in variants.items():
        performance = capture_varied(clip, fit, variant)
        motions = {
            OURS: of_performance(performance, truth.tracks[0]),
            MUSCLES: of_performance(performance.without_detail(), truth.tracks[0]),
        }
        shown = shown_expressions(take, truth, motions)
        rows[name] = {
            "contrast": contrast,
            "image": Explained.all_of(one.image[OURS] for one in shown).r2,
            "muscles": Explained.all_of(one.image[MUSCLES] for one in shown).r2,
            "space": Explained.all_of(one.space[OURS] for one in shown).r2,
        }
    return rows


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="evaluation.runs.compressed", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--set", choices=SETS, default=SETS[0])
    parser.add_argument("--people", type=int, help="the first people of the set alone")
    parser.add_argument(
        "--crf", type=int, nargs="+", default=[26, 30], choices=range(52), metavar="FACTOR"
    )
    parser.add_argument(
        "--tracker", nargs="+", action="append", default=[], metavar="NAME=VALUE", help="a row more"
    )
    parser.add_argument("--json", action="store_true", help="figures as JSON")
    options = parser.parse_args(arguments)
    rows: dict[str, Figures] = {}
    try:
        variants = {AS_IT_IS: Variant()}
        variants |= {" ".join(words): variant_of(words) for words in options.tracker}
        for take in takes(options.set, options.people, to_stderr)[0]:
            with TemporaryDirectory() as folder:
                for how, clip in encodings(take.clip.footage, options.crf, Path(folder)):
                    to_stderr(f"{take.clip.name}, {how}")
                    for name, row in figures(take, clip, variants).items():
                        rows[f"{take.clip.name}, {how}: {name}"] = row
    except (InvalidInput, OSError) as error:
        print(f"compressed: {error}", file=sys.stderr)
        return 2
    print(json_text(rows) if options.json else text_table("encoded again", COLUMNS, rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
