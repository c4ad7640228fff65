# SPDX-License-Identifier: GPL-3.0-or-later
"""Too little memory is known as that, whoever finds it out."""

import subprocess
import sys

FILL_MEMORY = """
import resource
from pathlib import Path
import numpy as np
from mimetic import _core

picture = np.zeros((2048, 2048, 3), np.uint8)
_core.scaled_gray(picture[:64, :64].copy(), 2.0)  # threads start, and take memory of their own
used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + 100_000_000,) * 2)
try:
    _core.scaled_gray(picture, 8.0)  # 268 MB
except MemoryError as error:
    print("MemoryError", error)
"""


def test_opencv_without_memory_is_a_memory_error():
    done = subprocess.run(
        [sys.executable, "-c", FILL_MEMORY], capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("MemoryError")
