# SPDX-License-Identifier: GPL-3.0-or-later
"""Check the package's types with mypy, the compiled core's by stubs that are made of it.

The stubs are in build/stubs and made again when the core has changed; mypy keeps what it knows in
build/mypy. Exit status 1: a type does not fit, or the core has a signature that cannot be written.
"""

from __future__ import annotations

import hashlib
import importlib.util
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
STUBS = ROOT / "build" / "stubs"
CORE = "mimetic._core"


def core_state() -> str:
    """What the stubs are made of, and with."""
    spec = importlib.util.find_spec(CORE)
    if spec is None or spec.origin is None:
        raise SystemExit("the package is not built: run scripts/setup")
    content = hashlib.sha256(Path(spec.origin).read_bytes())
    return f"{version('pybind11-stubgen')} {version('numpy')} {content.hexdigest()}"


def make_stubs() -> None:
    """The stubs of the installed core, in STUBS."""
    command = [
        *(sys.executable, "-m", "pybind11_stubgen", CORE, "--output-dir", str(STUBS)),
        *("--enum-class-locations", f"TimeScheme:{CORE}"),
        # Defaults that only a constructor makes: the stub says `...`, which is what stubs say
        *("--ignore-invalid-expressions", r"<mimetic\._core\.\w+ object at 0x[0-9a-f]+>"),
        # numpy 1 has no such name, pybind11 writes it all the same
        *("--ignore-unresolved-names", r"numpy\.bool"),
        "--exit-code",
    ]
    ran = subprocess.run(command, capture_output=True, text=True)
    if ran.returncode:
        raise SystemExit(f"no stubs of {CORE}:\n{ran.stdout}{ran.stderr}")
    path = STUBS / Path(*CORE.split(".")).with_suffix(".pyi")
    text = path.read_text(encoding="utf-8").replace("numpy.bool]", "numpy.bool_]")
    path.write_text(text, encoding="utf-8")


def main() -> int:
    state, mark = core_state(), STUBS / "state"
    if not mark.exists() or mark.read_text(encoding="utf-8") != state:
        mark.unlink(missing_ok=True)
        make_stubs()
        mark.write_text(state, encoding="utf-8")
    return subprocess.run([sys.executable, "-m", "mypy", *sys.argv[1:]], cwd=ROOT).returncode


if __name__ == "__main__":
    sys.exit(main())
