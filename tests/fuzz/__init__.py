# SPDX-License-Identifier: GPL-3.0-or-later
"""Every reader of files against damaged and hostile ones: `scripts/fuzz`, and shortly in the tests.

Files are the tests' own samples, changed where their format can hurt (what an array's header
claims, numbers in JSON, an index of a face) and byte by byte. A case ends in one of three ways:
right, refused in one line, or a bug.
"""
