# SPDX-License-Identifier: GPL-3.0-or-later
"""Identifies a video file by its content, wherever it is and whatever it is called."""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Iterator
from pathlib import Path

from mimetic import UnreadableMedia
from mimetic.media.image_sequence import ImageSequence, begins_sequence
from mimetic.shared.regular_file import check_input

# Of a large file evenly spaced pieces are read, the first and the last bytes among them: 16 MiB,
# so that a clip of hours is known as soon as one of seconds
NUM_PIECES, PIECE = 64, 1 << 18  # bytes
FINGERPRINT = re.compile(r"\d{1,19}-[0-9a-f]{64}")
MOST_FILES, MOST_DEPTH = 200_000, 16  # of a search, as Blender's own goes no deeper


def fingerprint(path: str | os.PathLike[str]) -> str:
    """`<bytes>-<SHA-256>` of a file: of all of it up to 16 MiB, of 64 pieces of a larger one.

    Two clips of equal size that differ only between the pieces have the same; of compressed video
    that takes a forger. An `ImageSequence` has its own. Raises UnreadableMedia.
    """
    if isinstance(path, ImageSequence):
        return path.fingerprint()
    path = Path(path)
    try:
        check_input(path, "a video file")
        with path.open("rb") as stream:
            size = os.fstat(stream.fileno()).st_size
            digest = hashlib.sha256()
            for start, length in _pieces(size):
                stream.seek(start)
                digest.update(stream.read(length))
    except (OSError, ValueError) as error:
        if isinstance(error, UnreadableMedia):
            raise
        raise UnreadableMedia(f"{path} cannot be read: {error}") from None
    return f"{size}-{digest.hexdigest()}"


def is_fingerprint(text: str) -> bool:
    return FINGERPRINT.fullmatch(text) is not None


def find_content(mark: str, files: Iterator[Path]) -> Path | None:
    """The first of some files that has the fingerprint `mark`, or begins a sequence that has it."""
    size = int(mark.partition("-")[0])
    for path in files:
        try:
            if path.stat().st_size == size and fingerprint(path) == mark:
                return path
            if begins_sequence(path) and fingerprint(ImageSequence(path)) == mark:
                return path
        except (OSError, UnreadableMedia):
            continue
    return None


def files_in(
    folder: str | os.PathLike[str], depth: int = 0, with_dead_links: bool = False
) -> Iterator[Path]:
    """Regular files in a folder and in `depth` levels of folders under it, at most 200,000.

    Links are followed, to a folder once. with_dead_links: those to nothing count as files.
    """
    num_entries = 0
    waiting = [(Path(folder), min(depth, MOST_DEPTH))]
    seen = set()
    while waiting:
        current, levels = waiting.pop()
        try:
            status = os.stat(current)
            if (place := (status.st_dev, status.st_ino)) in seen:
                continue
            seen.add(place)
            entries = sorted(os.scandir(current), key=lambda entry: entry.name)
        except OSError:  # not ours to read
            continue
        for entry in entries:
            num_entries += 1
            if num_entries > MOST_FILES:
                return
            try:
                is_dead = entry.is_symlink() and not os.path.exists(entry.path)
                if (with_dead_links and is_dead) or (not is_dead and entry.is_file()):
                    yield Path(entry.path)
                elif not is_dead and entry.is_dir() and levels:
                    # Links last: a folder that is reached without one too keeps its own path
                    turn = 0 if entry.is_symlink() else len(waiting)
                    waiting.insert(turn, (Path(entry.path), levels - 1))
            except OSError:
                continue


def _pieces(size: int) -> list[tuple[int, int]]:
    """Start and length of what is read of a file."""
    if size <= NUM_PIECES * PIECE:
        return [(0, size)]
    return [(i * (size - PIECE) // (NUM_PIECES - 1), PIECE) for i in range(NUM_PIECES)]
