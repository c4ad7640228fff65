# SPDX-License-Identifier: GPL-3.0-or-later
"""Which muscles act together, learned on many heads: `scripts/learn_co_contraction`."""
