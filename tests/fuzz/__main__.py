# SPDX-License-Identifier: GPL-3.0-or-later
"""`scripts/fuzz`: all readers in turn for as long as is asked."""

from __future__ import annotations

import argparse
import contextlib
import sys
import time
from collections import Counter
from pathlib import Path

from fuzz.judge import BUG, REFUSED, RIGHT, End, read_file, run
from fuzz.readers import READERS

KEPT = Path(__file__).resolve().parents[2] / "out" / "fuzz"
ROUND = 200  # cases of a reader before the next has its turn
SLOW, SLOWER = ("footage", "footage-name"), 10  # ffmpeg is started for each


def main() -> int:
    parser = argparse.ArgumentParser(prog="scripts/fuzz", description=__doc__)
    parser.add_argument("--seconds", type=float, default=60.0, help="how long (default: 60)")
    parser.add_argument(
        "--cases", type=int, help="so many of each reader, instead; of footage a tenth"
    )
    parser.add_argument("--seed", type=int, default=1, help="of all changes (default: 1)")
    parser.add_argument("--reader", choices=READERS, help="this one alone")
    parser.add_argument("--case", type=int, help="this case alone, of the --reader")
    parser.add_argument(
        "--file", type=Path, help="read this file with the --reader, and say how it ends"
    )
    options = parser.parse_args()
    if (options.case is not None or options.file) and not options.reader:
        parser.error("--case and --file need --reader")
    if options.file:
        end = read_file(options.reader, options.file)
        print(end.kind, end.text)
        return int(end.kind == BUG)
    if options.case is not None:
        ends = run(options.reader, options.seed, options.case, options.case + 1, KEPT)
        return _count(ends, {options.reader: Counter()})
    return _run_for(options)


def _run_for(options: argparse.Namespace) -> int:
    names = [options.reader] if options.reader else list(READERS)
    counts: dict[str, Counter] = {name: Counter() for name in names}
    start, first, bugs = time.monotonic(), dict.fromkeys(names, 0), 0
    is_over = False
    with contextlib.suppress(KeyboardInterrupt):  # the counts so far are told
        while not is_over:
            for name in names:
                last = first[name] + (options.cases or ROUND) // (SLOWER if name in SLOW else 1)
                bugs += _count(run(name, options.seed, first[name], last, KEPT), counts)
                first[name] = last
                if is_over := options.cases is None and time.monotonic() - start >= options.seconds:
                    break
            is_over |= options.cases is not None
    print(f"{'reader':14}{'cases':>8}{RIGHT:>9}{REFUSED:>9}{'bugs':>6}")
    for name, count in counts.items():
        print(f"{name:14}{count.total():8}{count[RIGHT]:9}{count[REFUSED]:9}{count[BUG]:6}")
    return int(bugs > 0)


def _count(ends, counts: dict[str, Counter]) -> int:
    """Counts the ends and tells of bugs as they come; how many there were."""
    bugs = 0
    for end in ends:
        counts[end.reader][end.kind] += 1
        if end.kind == BUG:
            bugs += 1
            print(told(end), flush=True)
    return bugs


def told(end: End) -> str:
    """One line: what went wrong and how to see it again."""
    again = f"scripts/fuzz --reader {end.reader} --seed {end.seed} --case {end.index}"
    return f"{end.reader}: {end.text}\n    {again}{f'   # {end.file}' if end.file else ''}"


if __name__ == "__main__":
    sys.exit(main())
