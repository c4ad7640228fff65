# SPDX-License-Identifier: GPL-3.0-or-later
"""A screen without a monitor, and a Blender on it that walks by a script and is photographed."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

from close_request import ask_to_close, make_known
from file_drop import drop_file
from lit_button import find_button

HERE = Path(__file__).parent
SIZE = (1280, 800)


class Screen:
    """An Xvfb display of its own, on a free number; size: of it, and of Blender's window on it."""

    def __init__(self, size: tuple[int, int] = SIZE) -> None:
        self.size = size

    def __enter__(self) -> Screen:
        reader, writer = os.pipe()
        geometry = "{}x{}x24".format(*self.size)
        arguments = ["-screen", "0", geometry, "+extension", "GLX", "-nolisten", "tcp", "-noreset"]
        self._process = subprocess.Popen(
            ["Xvfb", "-displayfd", str(writer), *arguments],
            pass_fds=[writer],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(writer)
        with os.fdopen(reader) as stream:
            number = stream.readline().strip()
        if not number:
            raise RuntimeError("Xvfb did not start; is its package xvfb whole?")
        self.display = f":{number}"
        make_known(self.display)
        return self

    def __exit__(self, *_: object) -> None:
        self._process.terminate()
        self._process.wait(timeout=10)

    def photograph(self, path: Path) -> None:
        aside = path.with_suffix(".partial.png")
        command = ["import", "-display", self.display, "-window", "root", str(aside)]
        subprocess.run(command, check=True, timeout=30)
        aside.replace(path)

    def act(self, words: str) -> None:
        """Moves the real mouse, or presses real keys: what xdotool is to do."""
        command = ["env", f"DISPLAY={self.display}", "xdotool", *words.split()]
        subprocess.run(command, check=True, timeout=30)

    def drop(self, words: str) -> None:
        """Drops a file with the real mouse: the place's x and y, and the file's path."""
        x, y, path = words.split(maxsplit=2)
        self.act(f"mousemove {x} {y}")
        drop_file(self.display, "Blender", (int(x), int(y)), Path(path))

    def click_button(self, words: str, picture: Path) -> None:
        """Clicks with the real mouse on what stands out: `find_button`'s colour and box.

        Raises ValueError if nothing does, however long one looks.
        """
        colour, *box = words.split()
        end = time.monotonic() + 15
        while True:
            self.photograph(picture)
            place = find_button(picture, tuple(map(int, box)), colour)
            if place is not None or time.monotonic() > end:
                break
        if place is None:
            raise ValueError(f"no {colour} button is seen in {picture.name}")
        self.act(f"mousemove {place[0]} {place[1]} sleep 0.3 click 1")


@dataclass(frozen=True)
class Findings:
    """What a walk brought home."""

    checks: list[dict]
    arrays: dict[str, list]
    pictures: dict[str, Path]
    log: str

    def failures(self) -> list[str]:
        """Every claim that does not hold: Blender's exit status says nothing about them."""
        failed = [f"{c['claim']}: {c['found']}" for c in self.checks if not c["holds"]]
        if not self.checks:
            failed.append("the walk checked nothing")
        if "Traceback (most recent call last)" in self.log:
            failed.append("Blender's log holds a traceback:\n" + self.log[-4000:])
        return failed


@dataclass(frozen=True)
class BlenderFolder:
    """A Debian folder with Blender, made by `prepare`."""

    root: Path
    blender: str
    python: str

    @classmethod
    def prepared(cls) -> BlenderFolder:
        done = subprocess.run(
            [str(HERE / "prepare")], check=True, stdout=subprocess.PIPE, text=True, timeout=1800
        )
        root = Path(done.stdout.splitlines()[-1])
        facts = json.loads((root / "mimetic-window.json").read_text())
        return cls(root, facts["blender"], facts["python"])

    def walk(
        self,
        screen: Screen,
        script: str,
        work: Path,
        pictures: Path,
        settings: dict,
        seconds: float,
        is_simulated: bool = True,
        beside: tuple[str, ...] = (),
    ) -> Findings:
        """Run a walk in a new Blender. `work` must lie in /tmp, which the folder shares.

        is_simulated: the walk's own events count, and the screen's do not.
        beside: what else the walk imports, as seen from here.
        """
        for source in ("walk.py", script, *beside):
            shutil.copy(HERE / source, work)
        (work / "settings.json").write_text(json.dumps(settings))
        resources = work / "resources"
        resources.mkdir()
        log_path = work / "blender.log"
        with log_path.open("w") as log:
            process = subprocess.Popen(
                [
                    str(HERE / "enter"),
                    str(self.root),
                    *self._command(screen, work, script, is_simulated),
                ],
                env=self._environment(screen, resources),
                stdout=log,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
            taken = _serve(process, screen, work, pictures, seconds)
        text = log_path.read_text(errors="replace")
        shutil.copy(log_path, pictures / f"{Path(script).stem}.log")
        result = work / "result.json"
        if not result.exists():
            raise AssertionError(f"no result within {seconds:g} s; Blender's log:\n{text[-4000:]}")
        record = json.loads(result.read_text())
        return Findings(record["checks"], record["arrays"], taken, text)

    @staticmethod
    def _command(screen: Screen, work: Path, script: str, is_simulated: bool) -> list[str]:
        geometry = ["--window-geometry", "0", "0", *map(str, screen.size)]
        start = ["blender", "--factory-startup", *geometry]
        start += ["--enable-event-simulate"] if is_simulated else []
        return [*start, "--python-exit-code", "1", "--python", str(work / script), "--", str(work)]

    @staticmethod
    def _environment(screen: Screen, resources: Path) -> dict[str, str]:
        return os.environ | {
            "DISPLAY": screen.display,
            "LIBGL_ALWAYS_SOFTWARE": "1",
            "BLENDER_USER_RESOURCES": str(resources),
            "HOME": str(resources),
            "XDG_RUNTIME_DIR": str(resources),
        }


def _serve(
    process: subprocess.Popen, screen: Screen, work: Path, pictures: Path, seconds: float
) -> dict[str, Path]:
    """Do what the walk asks for, until Blender ends or its time is over.

    It asks by files: NAME.request, for a picture; NAME.close, to have the window's close button
    pressed; NAME.act, NAME.drop and NAME.click, which hold the words for `Screen.act`, `drop` and
    `click_button`.
    """
    taken: dict[str, Path] = {}
    deadline = time.monotonic() + seconds
    while process.poll() is None and time.monotonic() < deadline:
        for request in work.glob("*.request"):
            picture = pictures / f"{request.stem}.png"
            screen.photograph(picture)
            taken[request.stem] = picture
            request.unlink()
        for request in work.glob("*.close"):
            ask_to_close(screen.display, "Blender")
            request.unlink()
        for request in work.glob("*.act"):
            screen.act(request.read_text())
            request.unlink()
        for request in work.glob("*.drop"):
            screen.drop(request.read_text())
            request.unlink()
        for request in work.glob("*.click"):
            picture = pictures / f"{request.stem}.png"
            screen.click_button(request.read_text(), picture)
            taken[request.stem] = picture
            request.unlink()
        time.sleep(0.1)
    if process.poll() is None:
        screen.photograph(pictures / "out-of-time.png")
        process.terminate()
    process.wait(timeout=30)
    return taken
