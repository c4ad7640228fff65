# SPDX-License-Identifier: GPL-3.0-or-later
"""A second family of truth: heads that share no vertex, identity or expression with ours."""
