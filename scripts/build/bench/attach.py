# SPDX-License-Identifier: GPL-3.0-or-later
"""What attaching muscles to a person's head costs, in seconds of wall clock and of processor."""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import numpy as np
from mimetic.muscles.anatomy import attach, attach_skin, modes_of
from mimetic.muscles.extras import attach_extras
from mimetic.template.face_template import load_template


def measure(work: Callable[[], object], repeats: int) -> tuple[float, float]:
    """Medians of wall clock and processor time, seconds."""
    times = []
    for _ in range(repeats):
        wall, processor = time.perf_counter(), time.process_time()
        work()
        times.append((time.perf_counter() - wall, time.process_time() - processor))
    clock, processor = np.median(times, axis=0)
    return float(clock), float(processor)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=5, help="of which the median counts")
    repeats = max(1, parser.parse_args().repeats)
    template = load_template()
    # A person is no copy of the template: every second identity a little to one side
    limits = template.identity_limits[::2]
    neutral = template.neutral(
        dict(zip(template.identity_names[::2], 0.1 * limits[:, 1], strict=True))
    )
    attach(neutral, template)  # what is made once for all heads
    skin = attach_skin(neutral, template)
    steps = {
        "check the head, refine its skin": lambda: attach_skin(neutral, template),
        "factor the skin": lambda: attach_skin(neutral, template).model,
        "attach: all of it, muscles, jaw and lids": lambda: attach(neutral, template),
        "muscles, jaw and lids on a factored skin": lambda: modes_of(skin),
        "extras on a factored skin": lambda: attach_extras(skin),
    }
    print(f"{'':44s} wall clock  processor, s (median of {repeats})")
    for name, work in steps.items():
        clock, processor = measure(work, repeats)
        print(f"{name:44s} {clock:10.3f} {processor:10.3f}")


main()
