# SPDX-License-Identifier: GPL-3.0-or-later
"""From footage and a fit to muscle activations: the walk over the frames."""
