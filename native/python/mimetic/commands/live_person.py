# SPDX-License-Identifier: GPL-3.0-or-later
"""Whose face is expected live, and by which lens it is filmed."""

from __future__ import annotations

import argparse
from pathlib import Path

from mimetic import InvalidInput
from mimetic.commands.on_clip import lens_of
from mimetic.fit.face_fit import FaceFit
from mimetic.fit.known_lens import KnownLens
from mimetic.puppet.live_heads import lens_of_fit


def add_person_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--fit",
        type=Path,
        metavar="FIT.json",
        help="a fit of this person by this camera, of an earlier capture: head, calibration and "
        "lens are known from the first picture on, where the head is gets found",
    )
    parser.add_argument(
        "--person",
        type=Path,
        metavar="FIT.json",
        help="the same of a fit by another camera, whose lens is left out",
    )


def person_of(arguments: argparse.Namespace) -> tuple[FaceFit | None, KnownLens | None]:
    """The person expected and the lens, each None where it is not known.

    Raises InvalidInput and UnreadableMedia.
    """
    if arguments.fit and arguments.person:
        raise InvalidInput("--fit and --person are both the person's head: give one of them")
    lens = lens_of(arguments)
    path = arguments.fit or arguments.person
    if path is None:
        return None, lens
    person = FaceFit.load(path)
    return person, lens_of_fit(person) if arguments.fit else lens
