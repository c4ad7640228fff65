# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes of JSON: values, keys and what is nested in what; alone and inside a .glb."""

from __future__ import annotations

import json
import struct
from random import Random

MARK = "\x01value %d\x01"
# As text, since most are not what json writes
VALUES = (
    *(
        "0",
        "-1",
        "1",
        "2",
        "true",
        "null",
        '""',
        '"x"',
        "[]",
        "{}",
        "[[]]",
        "1e300",
        "-1e300",
        "1e-320",
    ),
    *(
        "1e999",
        "-1e999",
        "NaN",
        "Infinity",
        "2147483648",
        "9007199254740993",
        "18446744073709551616",
    ),
    *(
        "9" * 30,
        "1" + "0" * 400,
        "9" * 5000,
        "[1, [2, 3]]",
        "[[1], [1, 2]]",
        '["1", "2"]',
        "[true]",
    ),
    *(
        "[" * 70 + "]" * 70,
        "[" * 5000 + "]" * 5000,
        '"\\ud800"',
        '"\\u0000"',
        '"\\u001b[2J\\u202e"',
    ),
    *(
        "[" + "0," * 5000 + "0]",
        '{"a": 1}',
        '{"chin": [1, 2]}',
        '"' + "n" * 5000 + '"',
        "1.5",
        "[null]",
    ),
)


def change_json(content: bytes, random: Random) -> bytes:
    """One to three values or keys of the document changed."""
    document = json.loads(content)
    marked: list[str] = []
    for _ in range(random.choice((1, 1, 1, 2, 3))):
        document = _change_once(document, random, marked)
    text = json.dumps(document)
    for number, value in enumerate(marked):
        text = text.replace(json.dumps(MARK % number), value)
    return text.encode("utf-8", errors="surrogatepass")


def _change_once(document, random: Random, marked: list[str]):
    # Down from the root, so that what is near it is as likely as the many numbers at the ends
    holder, key, value = None, None, document
    while isinstance(value, dict | list) and value and (holder is None or random.random() < 0.75):
        holder = value
        key = (
            random.choice(list(value)) if isinstance(value, dict) else random.randrange(len(value))
        )
        value = holder[key]
    kind = random.randrange(8)
    if kind < 4 or holder is None:
        marked.append(random.choice(VALUES))
        new = MARK % (len(marked) - 1)
    elif kind == 4:
        del holder[key]
        return document
    elif kind == 5:
        new = [value, value]
    elif kind == 6 and isinstance(holder, dict):
        del holder[key]
        key, new = random.choice(("", "x", "\x1b[2J", "a" * 300, "é")), value
    else:
        new = value * 3 if isinstance(value, list) else {"x": value}
    if holder is None:
        return new
    holder[key] = new
    return document


def change_glb(content: bytes, random: Random) -> bytes:
    """The JSON inside a .glb changed, and its lengths made to fit."""
    (length,) = struct.unpack_from("<I", content, 12)
    text = change_json(content[20 : 20 + length], random)
    text += b" " * (-len(text) % 4)
    rest = content[20 + length :]
    return (
        content[:8]
        + struct.pack("<3I", 20 + len(text) + len(rest), len(text), 0x4E4F534A)
        + text
        + rest
    )
