# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's own loop on a clip: python -m evaluation.baselines FOOTAGE --out DIR

Writes what `mimetic capture` writes, to be laid beside it.
"""

from __future__ import annotations

import argparse
import sys

from mimetic import InvalidInput, UnreadableMedia
from mimetic.commands.capture import COSTS, write_pictures
from mimetic.commands.on_clip import add_clip_arguments, run_on_clip

from .paper_loop import capture_by_loop


def main() -> int:
    parser = argparse.ArgumentParser(prog="evaluation.baselines", description=__doc__)
    add_clip_arguments(parser, "face")
    arguments = parser.parse_args()

    def follow(fit, progress, summary):
        return capture_by_loop(arguments.footage, arguments.frames, fit, progress, summary)

    try:
        return run_on_clip(arguments, COSTS, follow, write_pictures)
    except (InvalidInput, UnreadableMedia) as error:
        print(f"evaluation.baselines: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
