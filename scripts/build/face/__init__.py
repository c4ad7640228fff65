# SPDX-License-Identifier: GPL-3.0-or-later
"""Modules of `make_face`: the canonical head from its published data files."""
