# SPDX-License-Identifier: GPL-3.0-or-later
import subprocess
import sys

# Matplotlib's font module throws C++ exceptions while this loads.
SCRIPT = "import mimetic, matplotlib.figure; print('alive')"


def test_other_modules_can_still_throw_after_the_core_is_loaded():
    ran = subprocess.run([sys.executable, "-c", SCRIPT], capture_output=True, text=True)
    assert (ran.returncode, ran.stdout) == (0, "alive\n"), ran.stderr
