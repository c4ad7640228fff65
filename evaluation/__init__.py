# SPDX-License-Identifier: GPL-3.0-or-later
"""Clips with known truth: heads drawn by Blender, moved by what the estimator lacks."""
