# SPDX-License-Identifier: GPL-3.0-or-later
"""JSON in files: what is read is not trusted, its length, depth and numbers are limited."""

from __future__ import annotations

import json
import math
import os
import re
from pathlib import Path

from mimetic import InvalidInput
from mimetic.shared.regular_file import check_input
from mimetic.shared.shown_text import shortened
from mimetic.shared.whole_file import whole_file

MOST_VALUES = 2_000_000  # each takes some hundred bytes
DEEPEST = 64  # of lists and objects in each other
LONGEST_WHOLE = 16  # digits; Python's own whole numbers know no limit, and refuse to be arrays
LONE_SURROGATE = re.compile("[\ud800-\udfff]")


def write_json(path: Path, document: object) -> None:
    """The file whole, or what was there before; raises OSError."""
    with whole_file(path) as stream:
        stream.write(json.dumps(document, indent=1).encode())


def read_json(path: str | os.PathLike, what: str, largest: int) -> object:
    """What `parse_json` makes of a file of at most `largest` bytes; errors name the file.

    what: the file is supposed to be, as in "a face fit". Raises UnreadableMedia where there is
    none, InvalidInput.
    """
    path = Path(path)
    check_input(path, f"{what} (JSON)")
    if path.stat().st_size > largest:
        raise InvalidInput(f"{path}: not {what}: larger than {largest / 1e6:.3g} MB")
    content = path.read_bytes()
    try:
        return parse_json(content)
    except InvalidInput as error:
        raise InvalidInput(f"{path}: not {what}: {shortened(error)}") from None


def parse_json(content: bytes) -> object:
    """The document; whole numbers of more than LONGEST_WHOLE digits are floats.

    Raises InvalidInput, naming the place of what JSON may hold and numbers and texts may not:
    numbers that are not finite, texts that are no Unicode.
    """
    if sum(map(content.count, (b",", b"[", b"{"))) > MOST_VALUES:
        raise InvalidInput(f"not JSON that is read: more than {MOST_VALUES} values")
    try:
        document = json.loads(content.decode("utf-8"), parse_int=_whole)
    except UnicodeDecodeError:
        raise InvalidInput("not JSON: not UTF-8 text") from None
    except (ValueError, RecursionError) as error:
        raise InvalidInput(f"not JSON: {error}") from None
    _check(document)
    return document


def _whole(digits: str) -> int | float:
    return int(digits) if len(digits) <= LONGEST_WHOLE else float(digits)


def _check(document: object) -> None:
    # Each with the one that holds it, for a path if it is wrong
    waiting: list[tuple] = [(document, None, None, 0)]
    while waiting:
        entry = waiting.pop()
        value, depth = entry[0], entry[3]
        if depth > DEEPEST:
            raise InvalidInput(f"not JSON that is read: nested deeper than {DEEPEST}")
        if isinstance(value, float) and not math.isfinite(value):
            raise InvalidInput(f"{_place(entry)} is {value}: numbers must be finite")
        if isinstance(value, str) and LONE_SURROGATE.search(value):
            raise InvalidInput(f"{_place(entry)} is no Unicode text: {value[:40]!r}")
        if isinstance(value, dict):
            waiting += [(key, key, entry, depth + 1) for key in value]
            waiting += [(item, key, entry, depth + 1) for key, item in value.items()]
        elif isinstance(value, list):
            waiting += [(item, i, entry, depth + 1) for i, item in enumerate(value)]


def _place(entry: tuple) -> str:
    """As in views[2].box[1]."""
    keys: list[str] = []
    while entry[2] is not None:
        key = entry[1]
        keys.append(f"[{key}]" if isinstance(key, int) else f".{str(key)[:40]}")
        entry = entry[2]
    return "".join(reversed(keys)).lstrip(".") or "the document"
