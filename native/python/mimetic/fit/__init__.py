# SPDX-License-Identifier: GPL-3.0-or-later
"""The person: neutral surface, pose and camera fitted to images."""
