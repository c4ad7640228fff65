# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's own loop, to compare with."""
