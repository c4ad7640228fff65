# SPDX-License-Identifier: GPL-3.0-or-later
"""Check the core with clang-tidy; what was clean and has not changed is not checked again.

A source counts as unchanged while it, every header of the core that it includes, its compile
command, .clang-tidy and the version of clang-tidy are the same; headers of other libraries do not
count. Needs build/release/compile_commands.json (`cmake --preset release`). Exit status 1:
something was reported.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from importlib.metadata import version
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
BUILD = ROOT / "build" / "release"
CHECKED = ROOT / "native"
INCLUDE_FOLDERS = (CHECKED / "include", CHECKED / "src")
INCLUDE = re.compile(rb'^\s*#\s*include\s*[<"]([^">]+)[">]', re.MULTILINE)
TIDY = Path(sys.executable).with_name("clang-tidy")


def commands() -> dict[Path, str]:
    """Source of the core: its compile command, alike in every checkout."""
    try:
        text = (BUILD / "compile_commands.json").read_text(encoding="utf-8")
    except FileNotFoundError:
        raise SystemExit("no compile commands: run cmake --preset release") from None
    entries = ((Path(entry["file"]), entry["command"]) for entry in json.loads(text))
    return {
        path: command.replace(str(ROOT), ".")
        for path, command in entries
        if path.is_relative_to(CHECKED)
    }


@cache
def included(path: Path) -> tuple[Path, ...]:
    """Headers of the core that a file names itself."""
    names = [name.decode() for name in INCLUDE.findall(path.read_bytes())]
    places = (folder / name for name in names for folder in (path.parent, *INCLUDE_FOLDERS))
    return tuple(dict.fromkeys(place.resolve() for place in places if place.is_file()))


def with_headers(source: Path) -> list[Path]:
    """A source and all headers of the core that it includes, by way of others too."""
    files, waiting = {source}, [source]
    while waiting:
        for header in included(waiting.pop()):
            if header not in files:
                files.add(header)
                waiting.append(header)
    return sorted(files)


def state_of(source: Path, command: str) -> str:
    """What the outcome of a check depends on, as a hash."""
    digest = hashlib.sha256(f"{version('clang-tidy')}\n{command}\n".encode())
    for path in (ROOT / ".clang-tidy", *with_headers(source)):
        digest.update(f"{path.relative_to(ROOT)}\n".encode())
        digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()


def check(source: Path) -> str:
    """What clang-tidy reports of a source; empty if all is well."""
    # The compile command is g++'s: its warning options do not apply, and clang does not know all
    command = [TIDY, "-p", BUILD, "--quiet", "--extra-arg=-w", source]
    ran = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    if ran.returncode == 0:
        return ""
    return ran.stdout.strip() or ran.stderr.strip() or f"{source}: clang-tidy failed"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--clean",
        type=Path,
        default=ROOT / "build" / "clang-tidy",
        help="folder that keeps which states were clean (default: %(default)s)",
    )
    clean = parser.parse_args().clean
    clean.mkdir(parents=True, exist_ok=True)
    states = {source: state_of(source, command) for source, command in commands().items()}
    sources = [source for source, state in states.items() if not (clean / state).exists()]
    num_reports = 0
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for source, report in zip(sources, pool.map(check, sources), strict=True):
            if report:
                num_reports += 1
                print(report.replace(f"{ROOT}/", ""))
            else:
                (clean / states[source]).touch()
    print(f"clang-tidy: {len(states)} sources, {len(sources)} checked, {num_reports} with findings")
    return 1 if num_reports else 0


if __name__ == "__main__":
    sys.exit(main())
