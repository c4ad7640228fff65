# SPDX-License-Identifier: GPL-3.0-or-later
"""Still images with and without a face, for scoring what finds faces. Not part of the package."""
