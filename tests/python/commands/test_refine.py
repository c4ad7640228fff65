# SPDX-License-Identifier: GPL-3.0-or-later
"""What `mimetic refine` leaves in a folder in which others write, and when it is stopped."""

import os
import signal

import pytest
from clips import make_clip
from mimetic.commands import refine
from mimetic.commands.cli import main
from mimetic.performance.corrections import save_corrections
from mimetic.performance.document import Performance
from mimetic.shared.results import publish, staging
from sample_performance import make_performance


@pytest.fixture
def command(tmp_path, monkeypatch):
    """Refines shot/performance.npz to one of 7 frames, with `meanwhile` before that is saved."""
    clip = make_clip(tmp_path / "clip.mp4", size="320x240", frames=12)
    save_corrections(tmp_path / "corrections.json", ())
    (tmp_path / "shot").mkdir()
    performance = tmp_path / "shot" / "performance.npz"
    make_performance().save(performance)

    def run(meanwhile, *words):
        def refined(_performance, _corrections, _range, _direction, progress):
            meanwhile()
            progress(0.5, "solving")
            return make_performance(num_frames=7)

        monkeypatch.setattr(refine, "refined", refined)
        words = [
            "refine",
            performance,
            clip,
            "--corrections",
            tmp_path / "corrections.json",
            *words,
        ]
        return main(list(map(str, words)))

    run.shot = performance.parent
    return run


def nothing():
    pass


def num_frames(folder):
    return {path.name: Performance.load(path).num_frames for path in sorted(folder.iterdir())}


def capture_into(out, frames):
    with staging(out) as folder:
        make_performance(num_frames=frames).save(folder / "performance.npz")
        publish(folder, out, is_finished=True)


def test_a_refined_performance_takes_the_others_place(command, capsys):
    assert command(nothing) == 0
    assert num_frames(command.shot) == {"performance.npz": 7}
    assert "performance.npz: 0 frames corrected" in capsys.readouterr().err


def test_drawings_of_before_beside_it_are_named(command, capsys):
    assert command(nothing) == 0
    assert "of the performance before" not in capsys.readouterr().err
    (command.shot / "report.html").touch()
    (command.shot / "overlay.mp4").touch()
    assert command(nothing, "--out", command.shot / "mine.npz") == 0
    assert "of the performance before" not in capsys.readouterr().err
    assert command(nothing) == 0
    said = capsys.readouterr().err
    assert f"{command.shot}: report.html and overlay.mp4 are still of the performance" in said


def test_a_capture_that_was_published_meanwhile_stays(command, capsys):
    assert command(lambda: capture_into(command.shot, 5)) == 1
    kept = {"performance.npz": 5, "performance.refined.npz": 7}
    assert num_frames(command.shot) == kept
    message = capsys.readouterr().err
    assert f"{command.shot / 'performance.refined.npz'}: 0 frames corrected" in message
    assert "performance.npz was replaced while this was solved, and stays as it is" in message
    assert command(lambda: capture_into(command.shot, 4)) == 1
    again = {"performance.npz": 4, "performance.refined-2.npz": 7}
    assert num_frames(command.shot) == kept | again


def test_what_others_put_where_nothing_was_stays(command):
    out = command.shot / "mine.npz"
    assert command(lambda: make_performance(num_frames=4).save(out), "--out", out) == 1
    assert num_frames(command.shot) == {"mine.npz": 4, "mine.refined.npz": 7, "performance.npz": 12}


@pytest.mark.parametrize(
    ("number", "name"), [(signal.SIGINT, "Ctrl-C"), (signal.SIGTERM, "SIGTERM")]
)
def test_a_stopped_one_says_once_that_nothing_is_changed(command, capfd, number, name):
    assert command(lambda: os.kill(os.getpid(), number)) == 128 + number
    said = f"\nstopping: nothing is changed ({name} again ends at once)\n"
    assert capfd.readouterr().err == said
    assert num_frames(command.shot) == {"performance.npz": 12}
