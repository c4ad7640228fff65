# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables and contact sheets of the anatomy: what each muscle moves, on our head and on others."""
