# SPDX-License-Identifier: GPL-3.0-or-later
"""Check the core with clang-tidy; what was clean and has not changed is not checked again.

A source counts as unchanged while it, every header of the core that it includes, its compile
command, .clang-tidy and the version of clang-tidy are the same; headers of other libraries do not
count. Needs build/release/compile_commands.json (`cmake --preset release`). Exit status 1:
something was reported.

Most of a check is reading the headers of Eigen and OpenCV, so sources of one folder are read as
one: ten take little longer than two. Kept apart are those that give the same name to something of
their own; should a batch fail nevertheless, or have findings, it is halved until each source stands
for itself.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
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
READ_TOGETHER = 10
# What a source keeps to itself: a namespace without a name, and in it the names of types, constants
# and functions, which clang-format lets begin at the margin
OWN = re.compile(r"^namespace \{$(.*?)^\}  // namespace$", re.MULTILINE | re.DOTALL)
TYPE_NAME = re.compile(r"^(?:struct|class|enum(?: class)?|using) (\w+)", re.MULTILINE)
OTHER_NAME = re.compile(r"^\w[^\n(={;]*?\b(\w+)(?:\[[^\]\n]*\])*\s*[(={;]", re.MULTILINE)


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


def own_names(source: Path) -> set[str]:
    """What another source in the same batch must not name so too; too many rather than too few."""
    own = "\n".join(OWN.findall(source.read_text(encoding="utf-8")))
    return {*TYPE_NAME.findall(own), *OTHER_NAME.findall(own)}


def batches(commands: dict[Path, str]) -> list[list[Path]]:
    """The sources that can be read together: of one folder, with the same options."""
    alike: dict[tuple[Path, tuple[str, ...]], list[tuple[list[Path], set[str]]]] = {}
    for source, command in commands.items():
        names = own_names(source)
        begun = alike.setdefault((source.parent, options(command)), [])
        for sources, taken in begun:
            if len(sources) < READ_TOGETHER and taken.isdisjoint(names):
                sources.append(source)
                taken.update(names)
                break
        else:
            begun.append(([source], names))
    return [sources for begun in alike.values() for sources, _ in begun]


def options(command: str) -> tuple[str, ...]:
    """A compile command without the compiler, the source and the object."""
    words = shlex.split(command)
    return tuple(words[1 : words.index("-o")])


def check(sources: list[Path], command: str) -> dict[Path, str]:
    """What clang-tidy reports of each source; empty if all is well."""
    with tempfile.TemporaryDirectory() as folder:
        together = Path(folder) / "together.cpp"
        together.write_text("".join(f'#include "{source}"  // NOLINT\n' for source in sources))
        read = sources[0] if len(sources) == 1 else together
        # The compile command is g++'s: its warning options do not apply; clang does not know all
        tidy = [TIDY, f"--config-file={ROOT / '.clang-tidy'}", "--quiet", "--extra-arg=-w", read]
        ran = subprocess.run(
            [*tidy, "--", *options(command)], capture_output=True, text=True, cwd=ROOT, check=False
        )
    if ran.returncode == 0:
        return dict.fromkeys(sources, "")
    if len(sources) > 1:
        half = len(sources) // 2
        return check(sources[:half], command) | check(sources[half:], command)
    return {read: ran.stdout.strip() or ran.stderr.strip() or f"{read}: clang-tidy failed"}


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
    to_compile = commands()
    states = {source: state_of(source, command) for source, command in to_compile.items()}
    waiting = {
        source: to_compile[source]
        for source, state in states.items()
        if not (clean / state).exists()
    }
    num_reports = 0
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for reports in pool.map(
            lambda sources: check(sources, waiting[sources[0]]), batches(waiting)
        ):
            for source, report in reports.items():
                if report:
                    num_reports += 1
                    print(report.replace(f"{ROOT}/", ""))
                else:
                    (clean / states[source]).touch()
    print(f"clang-tidy: {len(states)} sources, {len(waiting)} checked, {num_reports} with findings")
    return 1 if num_reports else 0


if __name__ == "__main__":
    sys.exit(main())
