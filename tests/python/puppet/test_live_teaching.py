# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks shown to a camera, which a rendered clip stands in for, there and back again."""

import numpy as np
import pytest
from clips import ffmpeg
from mimetic import InvalidInput
from mimetic.commands.cli import main
from mimetic.media.footage import Footage
from mimetic.performance.document import Performance
from mimetic.puppet.live_filter import LiveFilter
from mimetic.puppet.live_teaching import LiveTeaching, LiveTeachingOptions
from mimetic.puppet.pictures import Picture
from mimetic.puppet.taught_look import Look
from mimetic.puppet.templates import TaughtSet
from mimetic.score.truth import Truth

FPS, SETTLED = 25, 110  # pictures until the person's head is known
ORDER = [*range(50), *range(48, 0, -1)]


class Sitting:
    """Somebody in front of a camera who presses the key at these frames of the clip."""

    def __init__(self, footage):
        self.images = [image.copy() for _, image in Footage(footage).frames()]
        self.live = LiveFilter(stillness=0, in_background=False)
        self.number, self.lines = 0, []

    def teach(self, looks, frames, num_pictures, is_hidden=lambda number: False, **options):
        settings = LiveTeachingOptions(countdown=0, **options.pop("settings", {}))
        teaching = LiveTeaching(
            *(self.live, looks, self.lines.append, settings),
            is_asked=lambda: frame == frames[min(len(looks) - len(teaching.left), len(frames) - 1)],
            **options,
        )
        for _ in range(num_pictures):
            frame = ORDER[self.number % len(ORDER)]
            image = self.images[frame]
            if is_hidden(self.number):
                image = np.zeros_like(image)
            state = self.live.advance(image, self.number / FPS)
            picture = Picture(image, self.number / FPS, 0.0)
            self.number += 1
            if not teaching.see(picture, state):
                break
        return teaching


def jaw_of(rendered_clip):
    truth = Truth.load(rendered_clip.truth)
    return truth.unit_values[:, truth.units.index("jawOpen")]


@pytest.fixture(scope="module")
def widest(rendered_clip):
    """The frame in which the mouth is widest open, from 0."""
    return int(jaw_of(rendered_clip).argmax())


@pytest.fixture(scope="module")
def sitting(rendered_clip):
    return Sitting(rendered_clip.footage)


@pytest.fixture(scope="module")
def taught(sitting, widest):
    looks = [Look("neutral", 0), Look("open", 0)]
    return sitting.teach(looks, [0, widest], SETTLED + 2 * len(ORDER)).taught()


def channel(taught, name):
    return taught.channels.index(name)


def test_looks_are_kept_when_the_key_is_pressed(sitting, taught):
    assert taught.looks == ["neutral", "open"] and taught.neutral == 0
    jaw = taught.look_values[:, channel(taught, "jaw_open")]
    assert jaw[0] < 0.1 and jaw[1] > jaw[0] + 0.15
    assert {0, 1} == {
        int(look)
        for look, part in zip(taught.template_looks, taught.template_parts, strict=True)
        if part == "mouth"
    }
    assert (taught.example_looks == -1).any() and len(taught.example_pictures) > 60
    assert sitting.lines[1].endswith("neutral, the face at rest; press Enter")
    assert sitting.lines[-1] == "open: kept"


def test_what_a_camera_taught_drives_a_face(taught, rendered_clip, tmp_path, widest):
    taught.save(tmp_path / "set.npz")
    words = ["--templates", str(tmp_path / "set.npz"), "--out", str(tmp_path / "run"), "--lag", "0"]
    assert main(["puppet", "run", str(rendered_clip.footage), *words]) == 0
    driven = Performance.load(tmp_path / "run" / "performance.npz")
    jaw = driven.articulator_values[:, driven.articulators.index("jaw_open")]
    assert np.corrcoef(jaw, jaw_of(rendered_clip))[0, 1] > 0.9


def test_one_look_is_taught_again_and_the_others_stay(sitting, taught, widest):
    look = Look("open", 0, values={"jaw_open": 0.7})
    again = sitting.teach([look], [widest], 2 * len(ORDER), old=taught).taught()
    assert again.looks == taught.looks
    assert again.look_values[1, channel(again, "jaw_open")] == 0.7
    np.testing.assert_array_equal(again.look_values[0], taught.look_values[0])
    first, second = (
        [p for p, i in zip(one.pictures, one.template_looks, strict=True) if i == 0]
        for one in (taught, again)
    )
    assert len(first) == len(second)
    for before, after in zip(first, second, strict=True):
        np.testing.assert_array_equal(before, after)
    # Pictures in which the mouth opened on the way to the look would say other than .7
    assert (again.example_looks >= 0).all()
    opened = again.example_values[again.example_looks == 1]
    assert (opened[:, channel(again, "jaw_open")] == 0.7).all()


def test_a_look_in_which_no_face_is_seen_is_asked_for_again(sitting):
    start = sitting.number
    teaching = sitting.teach(
        *([Look("neutral", 0)], range(99), 40),
        is_hidden=lambda number: start <= number < start + 20,
    )
    assert teaching.left == ["neutral"] or "once more" in "".join(sitting.lines)
    with pytest.raises(InvalidInput, match="nothing is written"):
        teaching.taught()


def test_a_set_of_a_clip_is_not_taught_again_by_a_camera(sitting):
    from sample_taught import make_taught

    with pytest.raises(InvalidInput, match="taught from a clip"):
        LiveTeaching(sitting.live, [Look("smile", 0)], print, old=make_taught())


@pytest.fixture(scope="module")
def there_and_back(rendered_clip, tmp_path_factory):
    """5 seconds, of which 3.6 go by until the head is known."""
    path = tmp_path_factory.mktemp("clip") / "back.mkv"
    ffmpeg(
        *("-i", rendered_clip.footage, "-filter_complex"),
        "[0]split[a][b];[b]reverse[r];[a][r]concat,loop=1:100:0,trim=duration=5.0",
        *("-c:v", "ffv1", path),
    )
    return path


def test_a_clip_in_a_cameras_place_that_ends_keeps_what_was_shown(there_and_back, tmp_path, capsys):
    out = tmp_path / "set.npz"
    words = ["--every-frame", "--countdown", "0", "--look", "one", "--look", "two"]
    command = ["puppet", "teach", "--camera", str(there_and_back), "--out", str(out), *words]
    assert main(command) == 2
    error = capsys.readouterr().err
    assert "look 1 of 3: neutral, the face at rest" in error
    assert error.strip().splitlines()[-1].endswith("ended before these looks were kept: two")
    assert TaughtSet.load(out).looks == ["neutral", "one"]
    assert "data:image/png" in out.with_suffix(".html").read_text(encoding="utf-8")


def test_a_known_lens_is_the_cameras(rendered_clip, tmp_path, capsys, monkeypatch):
    """The head that looks are taught on is fitted by it, from the first picture on."""
    widths = []

    def advance(self, image, time):
        state = live_advance(self, image, time)
        widths.extend([] if self.face is None else [self.face.camera.fx / image.shape[1]])
        return state

    live_advance = LiveFilter.advance
    monkeypatch.setattr(LiveFilter, "advance", advance)
    words = [
        "--camera",
        str(rendered_clip.footage),
        "--every-frame",
        "--out",
        str(tmp_path / "a.npz"),
    ]
    assert main(["puppet", "teach", *words, "--focal", "50", "--sensor", "24"]) == 2
    assert "no look was kept" in capsys.readouterr().err
    assert len(widths) > 20 and widths == pytest.approx([50 / 24] * len(widths))


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "give a video and its --performance, or --camera"),
        (["clip.mp4"], "--performance is missing"),
        (["clip.mp4", "--camera", "camera:0"], "footage does not go with --camera"),
        (["--camera", "camera:0", "--choose", "3"], "--choose does not go with --camera"),
        (["--camera", "camera:0", "--countdown", "99"], "--countdown is 99"),
        (["clip.mp4", "--performance", "p.npz", "--countdown", "1"], "goes with --camera"),
        (["clip.mp4", "--performance", "p.npz", "--focal", "50"], "--focal goes with --camera"),
        (["--camera", "camera:0", "--sensor", "24"], "--sensor 24 is of a focal length"),
        (["--camera", "camera:0", "--focal", "0"], "0 mm: it must be above 0"),
        (["--camera", "camera:0", "--look", "smile=3"], "a camera has no frames"),
    ],
)
def test_words_that_do_not_go_together_are_one_line(tmp_path, capsys, words, message):
    assert main(["puppet", "teach", *words, "--out", str(tmp_path / "set.npz")]) == 2
    error = capsys.readouterr().err
    assert message in error and len(error.strip().splitlines()) == 1
