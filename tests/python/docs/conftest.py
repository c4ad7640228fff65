# SPDX-License-Identifier: GPL-3.0-or-later
import sys
from pathlib import Path

# The writers of the manual's pages are no package: they lie beside the script that runs them
sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "scripts" / "build" / "manual"))
