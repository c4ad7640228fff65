# SPDX-License-Identifier: GPL-3.0-or-later
"""Scores of a performance against footage whose truth is known."""

from mimetic.evaluate.truth import Truth

__all__ = ["Truth"]
