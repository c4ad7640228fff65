# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures and pages of what was captured."""
