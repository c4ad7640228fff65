# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes of any file, byte by byte, and of files of text, word by word."""

from __future__ import annotations

import re
from random import Random

EDGES = (
    0,
    1,
    0x7F,
    0x80,
    0xFF,
    0x7FFF,
    0xFFFF,
    0x7FFFFFFF,
    0x80000000,
    0xFFFFFFFF,
    2**63,
    2**64 - 1,
)
WORDS = (
    *("0", "-1", "1e300", "-1e300", "1e999", "nan", "inf", "1e-320", "2147483648", "1_0", "0x10"),
    *(
        "9" * 30,
        "9" * 400,
        "9" * 5000,
        "True",
        "",
        "'",
        '"',
        "\x00",
        "\x1b[2J",
        "\u202e",
        "٣",
        "-0",
    ),
    *(",", "/", "1/2/3", "#", "\\", "a" * 70_000, "1,2,3", "2**70", "é", "\ufeff"),
)
WORD = re.compile(r"[^\s,;:{}\[\]()'\"]+")


def change_bytes(content: bytes, random: Random) -> bytes:
    """One to eight changes of bits, bytes, numbers, runs or the end."""
    changed = bytearray(content)
    for _ in range(random.choice((1, 1, 1, 2, 4, 8))):
        _change_once(changed, random)
    return bytes(changed)


def _change_once(content: bytearray, random: Random) -> None:
    at = random.randrange(len(content) + 1)
    length = min(random.choice((1, 2, 4, 8, 16, 200, 5000)), len(content) - at)
    kind = random.randrange(7)
    if kind == 0 and length:
        content[at] ^= 1 << random.randrange(8)
    elif kind == 1:
        content[at : at + length] = random.randbytes(length)
    elif kind == 2:
        size = random.choice((1, 2, 4, 8))
        order = random.choice(("little", "big"))
        content[at : at + size] = (random.choice(EDGES) % 256**size).to_bytes(size, order)
    elif kind == 3:
        content[at:at] = random.randbytes(length)
    elif kind == 4:
        del content[at : at + length]
    elif kind == 5:
        source = random.randrange(len(content) + 1)
        content[at:at] = content[source : source + length]
    else:
        del content[at:]


def change_text(content: bytes, random: Random) -> bytes:
    """A word replaced, or a line left out, twice or elsewhere."""
    text = content.decode("utf-8", errors="surrogateescape")
    if random.random() < 0.7 and (words := list(WORD.finditer(text))):
        for match in sorted(
            random.sample(words, min(len(words), random.choice((1, 1, 2)))),
            key=lambda m: -m.start(),
        ):
            text = text[: match.start()] + random.choice(WORDS) + text[match.end() :]
    else:
        lines = text.split("\n")
        at = random.randrange(len(lines))
        line = lines.pop(at)
        for _ in range(random.choice((0, 1, 2, 1000))):
            lines.insert(random.randrange(len(lines) + 1), line)
        text = random.choice(("\n", "\n", "\r\n", "\r")).join(lines)
    return text.encode("utf-8", errors="surrogateescape")
