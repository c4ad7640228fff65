# SPDX-License-Identifier: GPL-3.0-or-later
"""The document that passes between the halves: what was captured, and places on its surface."""

from mimetic.performance.document import Performance

__all__ = ["Performance"]
