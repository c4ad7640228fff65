# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces in scenes: the canonical one, any head, rigs, controls, glTF."""
