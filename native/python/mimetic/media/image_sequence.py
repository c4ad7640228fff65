# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbered pictures in a folder, one a frame: footage as renderers and film scanners write it."""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

from mimetic import InvalidInput, UnreadableMedia
from mimetic.media.timing import FASTEST, SLOWEST
from mimetic.shared.regular_file import check_input

SUFFIXES = (".png", ".jpg", ".jpeg", ".exr", ".tif", ".tiff", ".dpx", ".bmp", ".tga")
USUAL_FPS = Fraction(24)  # of pictures that nothing more is said of
NUM_READ, READ = 64, 1 << 18  # pictures, and bytes of each, that a fingerprint is of
NUMBERED = re.compile(r"(.*?)(\d{1,9})", re.DOTALL)  # a name before its suffix
PATTERN = re.compile(r"%(?:0(\d))?d|(#+)")
EXAMPLE = "such as frame_0001.png, frame_0002.png"


@dataclass(frozen=True)
class Naming:
    """How the pictures of a sequence are called: all of a name but its number."""

    before: str
    after: str  # with the suffix
    digits: int  # at least so many, with zeros in front

    def name(self, number: int) -> str:
        return f"{self.before}{number:0{self.digits}d}{self.after}"

    def number_of(self, name: str) -> int | None:
        """None for a name that is not of these."""
        if not (name.startswith(self.before) and name.endswith(self.after)):
            return None
        middle = name[len(self.before) : len(name) - len(self.after)]
        if not re.fullmatch(r"[0-9]{1,9}", middle) or self.name(int(middle)) != name:
            return None
        return int(middle)

    def text(self) -> str:
        return f"{self.before}{'#' * self.digits}{self.after}"


class ImageSequence(os.PathLike[str]):
    """Pictures with numbers on end, of one name; frame 1 is the first of them.

    path: a folder that holds one such sequence, a pattern (`frame_%04d.png`, `frame_####.png`), or
    the picture to begin with; fps: frames a second, which no picture says. As a path it is that of
    its first picture. Raises UnreadableMedia, and InvalidInput for a rate that cannot be.
    """

    def __init__(self, path: str | os.PathLike[str], fps: Fraction | float | None = None) -> None:
        path = Path(os.fspath(path))
        is_folder = os.path.isdir(path)
        self.folder = path if is_folder else path.parent
        naming, start = _one_in(path) if is_folder else _named(path)
        numbers = sorted(_numbers_of(self.folder, naming, start))
        if not numbers:
            raise UnreadableMedia(f"{path}: there are no such pictures; give a folder of them")
        self.naming, self.first = naming, numbers[0]
        self.num_frames = next(
            (i for i, number in enumerate(numbers) if number != self.first + i), len(numbers)
        )
        self.num_after_gap = len(numbers) - self.num_frames
        if os.path.lexists(after := self.frame_path(1 + self.num_frames)):
            raise UnreadableMedia(f"{after} is no file that can be read; remove it")  # a pipe, say
        self.is_rate_given = fps is not None
        if fps is not None and not SLOWEST <= fps <= FASTEST:
            raise InvalidInput(f"a rate of {float(fps):g} frames a second cannot be; give another")
        self.fps = USUAL_FPS if fps is None else Fraction(fps).limit_denominator(1_000_000)
        check_input(self, "pictures")

    def __fspath__(self) -> str:
        return str(self.folder / self.naming.name(self.first))

    def __str__(self) -> str:
        return str(self.folder / self.name)

    @property
    def name(self) -> str:
        """`frame_####.png`"""
        return self.naming.text()

    def frame_path(self, frame: int) -> Path:
        return self.folder / self.naming.name(self.first + frame - 1)

    def input_options(self, frame: int = 1) -> list[str]:
        """What ffmpeg must be told to read the pictures from one frame on."""
        folder = str(self.folder.absolute())
        before, after = (
            part.replace("%", "%%") for part in (self.naming.before, self.naming.after)
        )
        pattern = f"{before}%0{self.naming.digits}d{after}"
        return [
            *("-protocol_whitelist", "file", "-format_whitelist", "image2"),
            # As Blender, which does not read which way is up; a picture that is damaged ends it,
            # or all later ones would be taken for the frames before them
            *("-noautorotate", "-xerror"),
            *("-f", "image2", "-pattern_type", "sequence", "-framerate", str(self.fps)),
            # That picture alone: where it is gone, the next would be taken for it
            *("-start_number", str(self.first + frame - 1), "-start_number_range", "1"),
            *("-i", "file:" + os.path.join(folder.replace("%", "%%"), pattern)),
        ]

    @property
    def filter(self) -> str:
        """What ffmpeg must do to its pictures: OpenEXR's are of light as it is, no screen's."""
        is_linear = self.naming.after.lower().endswith(".exr")
        return "zscale=tin=linear:t=iec61966-2-1," if is_linear else ""

    def warnings(self) -> list[str]:
        """What is odd about the pictures."""
        found = []
        if not self.is_rate_given:
            found.append(
                f"{self.name}: pictures have no rate; {float(self.fps):g} frames/s are taken "
                "(--fps)"
            )
        if self.num_after_gap:
            missing = self.naming.name(self.first + self.num_frames)
            found.append(
                f"{self.name}: {missing} is missing; the sequence ends before it, and "
                f"{self.num_after_gap} later pictures are left out"
            )
        return found

    def fingerprint(self) -> str:
        """As of a file (`clip_fingerprint`): `<bytes>-<SHA-256>`, of the sizes of all pictures and
        of the ends of 64 of them. Names do not count. Raises UnreadableMedia."""
        try:
            sizes = [os.stat(self.frame_path(f)).st_size for f in range(1, 1 + self.num_frames)]
            digest = hashlib.sha256(repr(sizes).encode())
            chosen = min(NUM_READ, self.num_frames)
            for i in range(chosen):
                frame = i * (self.num_frames - 1) // max(chosen - 1, 1)
                digest.update(_ends_of(self.frame_path(1 + frame), sizes[frame]))
        except OSError as error:
            raise UnreadableMedia(f"{self} cannot be read: {error}") from None
        return f"{sum(sizes)}-{digest.hexdigest()}"


def is_sequence(path: str | os.PathLike[str]) -> bool:
    """Whether a path names numbered pictures: a folder, a pattern, or one of them."""
    # os.path here and below: Path's own questions raise where a name is too long
    if isinstance(path, ImageSequence):
        return True
    path = Path(os.fspath(path))
    if path.suffix.lower() not in SUFFIXES:
        return os.path.isdir(path)
    is_pattern = PATTERN.search(path.name) is not None and not os.path.isfile(path)
    return is_pattern or _split(path.name) is not None


def number_of(path: str | os.PathLike[str]) -> int:
    """The number in a picture's name; 1 where it has none."""
    found = _split(Path(os.fspath(path)).name)
    return found[1] if found else 1


def begins_sequence(path: Path) -> bool:
    """Whether a file is the first of numbered pictures, of which there are more."""
    found = _split(path.name) if path.suffix.lower() in SUFFIXES else None
    if found is None:
        return False
    naming, number = found
    return not (number and os.path.exists(path.with_name(naming.name(number - 1)))) and (
        os.path.exists(path.with_name(naming.name(number + 1)))
    )


def picture_before(path: Path) -> Path | None:
    """Where the picture before a numbered one would be; None for other files, and the number 0."""
    found = _split(path.name) if path.suffix.lower() in SUFFIXES else None
    return path.with_name(found[0].name(found[1] - 1)) if found and found[1] else None


def sequences_in(files: Iterable[Path], fewest: int) -> list[Path]:
    """Of some files the first picture of each run of at least `fewest` numbered ones on end."""
    given = set(files)
    found = []
    for path in sorted(given):
        before, split = picture_before(path), _split(path.name)
        if path.suffix.lower() not in SUFFIXES or split is None or before in given:
            continue
        naming, first = split
        if all(path.with_name(naming.name(first + i)) in given for i in range(fewest)):
            found.append(path)
    return found


def opened(path: str | os.PathLike[str]) -> ImageSequence | Path:
    """A path as footage is kept by; raises UnreadableMedia."""
    if isinstance(path, ImageSequence):
        return path
    return ImageSequence(path) if is_sequence(path) else Path(path)


def _split(name: str) -> tuple[Naming, int] | None:
    """The naming and number of one picture; None for a name without a number at its end."""
    stem, suffix = os.path.splitext(name)
    match = NUMBERED.fullmatch(stem)
    return (Naming(match[1], suffix, len(match[2])), int(match[2])) if match else None


def _named(path: Path) -> tuple[Naming, int]:
    """Naming, and the least number, of a pattern or of the picture to begin with."""
    if path.suffix.lower() not in SUFFIXES:
        raise UnreadableMedia(
            f"{path} is no sequence of pictures; give a folder of them ({EXAMPLE})"
        )
    match = None if os.path.isfile(path) else PATTERN.search(path.name)
    if match:
        digits = int(match[1] or 1) if match[2] is None else len(match[2])
        return Naming(path.name[: match.start()], path.name[match.end() :], digits), 0
    found = _split(path.name)
    if found is None:
        raise UnreadableMedia(f"{path} has no number before its suffix; name pictures {EXAMPLE}")
    check_input(path, "pictures")
    return found


def _numbers_of(folder: Path, naming: Naming, start: int) -> Iterator[int]:
    for name in _pictures_in(folder):
        number = naming.number_of(name)
        if number is not None and number >= start:
            yield number


def _pictures_in(folder: Path) -> Iterator[str]:
    """Names of regular files, or links to such, with a picture's suffix."""
    try:
        with os.scandir(folder) as entries:
            for entry in entries:
                if entry.name.lower().endswith(SUFFIXES) and entry.is_file():
                    yield entry.name
    except OSError as error:
        raise UnreadableMedia(f"{folder} cannot be opened: {error.strerror}") from None


def _one_in(folder: Path) -> tuple[Naming, int]:
    """The only sequence in a folder."""
    longest: dict[tuple[str, str], tuple[int, int]] = {}  # by name: least digits, count
    for name in _pictures_in(folder):
        if found := _split(name):
            key = found[0].before, found[0].after
            digits, count = longest.get(key, (found[0].digits, 0))
            longest[key] = min(digits, found[0].digits), count + 1
    sequences = [Naming(*key, digits) for key, (digits, count) in longest.items() if count > 1]
    if not sequences:
        raise UnreadableMedia(
            f"{folder} is a folder, not a file, and holds no numbered pictures ({EXAMPLE}); give a "
            "video file, or a folder of pictures"
        )
    if len(sequences) > 1:
        names = ", ".join(sorted(naming.text() for naming in sequences)[:3])
        raise UnreadableMedia(f"{folder} holds several sequences: {names}; name one of them")
    return sequences[0], 0


def _ends_of(path: Path, size: int) -> bytes:
    with path.open("rb") as stream:
        if size <= READ:
            return stream.read(READ)
        start = stream.read(READ // 2)
        stream.seek(size - READ // 2)
        return start + stream.read(READ // 2)
