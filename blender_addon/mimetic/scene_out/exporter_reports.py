# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender's exporters report where they fail, as what to raise."""

from __future__ import annotations

import errno
import os
import re

# What a disk refuses; Windows has no quotas of this kind
OF_DISKS = {errno.ENOSPC, errno.EFBIG, errno.EIO, getattr(errno, "EDQUOT", errno.ENOSPC)}


def reported(error: RuntimeError, path: str | os.PathLike[str]) -> OSError:
    """What to raise for what an exporter reported as it wrote `path`: with a number what the disk
    refused, if a traceback in the report has that, else what it reported, of a traceback the end.
    """
    text = str(error).strip()
    numbers = [int(number) for number in re.findall(r"\[Errno (\d+)\]", text)]
    if refused := [number for number in numbers if number in OF_DISKS]:
        return OSError(refused[-1], os.strerror(refused[-1]), str(path))
    if "Traceback" not in text:
        return OSError(f"{path}: {text}")
    lines = [line for line in text.splitlines() if not line.startswith((" ", "Location:"))]
    return OSError(f"{path}: {lines[-1]}")
