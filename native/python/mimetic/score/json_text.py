# SPDX-License-Identifier: GPL-3.0-or-later
"""Scores as JSON, which has no number for what is undefined."""

from __future__ import annotations

import json
import math


def json_text(document: object) -> str:
    """The document, numbers that are not finite as null."""
    return json.dumps(_plain(document), indent=1, allow_nan=False)


def _plain(value: object) -> object:
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    return value
