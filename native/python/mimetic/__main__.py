# SPDX-License-Identifier: GPL-3.0-or-later
import sys

from mimetic.cli import main

sys.exit(main())
