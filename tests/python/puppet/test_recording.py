# SPDX-License-Identifier: GPL-3.0-or-later
"""A rendered clip recorded as if it were live."""

import json
import os
import signal
import socket
import wave
from dataclasses import replace

import numpy as np
import pytest
from clips import ffmpeg, make_clip, make_numbered_clip
from mimetic.commands.cli import main
from mimetic.fit.face_fit import FaceFit
from mimetic.fit.fitting import find_face
from mimetic.media.footage import Footage
from mimetic.performance.document import HELD_QUALITY, Performance
from mimetic.puppet import receiver
from mimetic.puppet.channels import CHANNELS, Freezer, channel_of
from mimetic.puppet.live_filter import LiveFilter
from mimetic.puppet.live_session import LiveSession
from mimetic.puppet.pictures import Picture
from mimetic.puppet.take import Take
from mimetic.score.truth import Truth
from mimetic.template.face_template import load_template


def record(footage, out, *options):
    return main(["puppet", "record", str(footage), "--out", str(out), *options])


@pytest.fixture(scope="module")
def recorded(rendered_clip, tmp_path_factory):
    out = tmp_path_factory.mktemp("recorded")
    assert (
        main(["puppet", "record", str(rendered_clip.footage), "--out", str(out), "--every-frame"])
        == 0
    )
    return out


@pytest.fixture(scope="module")
def performance(recorded):
    return Performance.load(recorded / "performance.npz")


def test_a_recording_is_a_performance_of_every_frame(performance):
    assert performance.frame.tolist() == list(range(1, 51))
    assert (performance.quality >= HELD_QUALITY).all()
    assert any("recorded live" in note for note in performance.notes)


def test_the_head_is_where_it_is(rendered_clip, performance):
    truth = Truth.load(rendered_clip.truth)
    away = np.linalg.norm(performance.head_pose[:, :3, 3] - truth.head_pose[:, :3, 3], axis=1)
    turn = performance.head_pose[:, :3, :3] @ truth.head_pose[0, :3, :3].T
    moved = truth.head_pose[:, :3, :3] @ truth.head_pose[0, :3, :3].T
    cosine = (np.einsum("nij,nij->n", turn, moved) - 1) / 2
    assert np.median(away) < 0.05
    assert np.degrees(np.arccos(np.clip(cosine, -1, 1))).max() < 8


def test_what_moves_is_what_a_capture_says_moves(captured_clip, performance):
    offline = captured_clip
    jaw = offline.articulators.index("jaw_open")
    live = performance.articulator_values[:, performance.articulators.index("jaw_open")]
    assert np.corrcoef(live, offline.articulator_values[:, jaw])[0, 1] > 0.9
    brows = [i for i, group in enumerate(offline.groups) if group == 5]
    assert (
        np.corrcoef(performance.activations[:, brows].sum(1), offline.activations[:, brows].sum(1))[
            0, 1
        ]
        > 0.9
    )


@pytest.mark.parametrize("word", ["--fit", "--person"])
def test_a_known_head_is_recorded_on(rendered_clip, tmp_path, word):
    fit = find_face(Footage(rendered_clip.footage).read(1))
    fit.save(tmp_path / "fit.json")
    words = [word, str(tmp_path / "fit.json"), "--every-frame", "--seconds", "0.5"]
    assert record(rendered_clip.footage, tmp_path / "out", *words) == 0
    take = Performance.load(tmp_path / "out" / "performance.npz")
    neutral = FaceFit.load(tmp_path / "fit.json").neutral_vertices(load_template())
    np.testing.assert_allclose(take.neutral_vertices, neutral, atol=1e-9)
    assert not any("fitted anew" in note for note in take.notes)


def test_takes_replace_no_earlier_one(recorded, rendered_clip):
    before = (recorded / "performance.npz").read_bytes()
    assert record(rendered_clip.footage, recorded, "--every-frame", "--seconds", "0.4") == 0
    assert (recorded / "performance.npz").read_bytes() == before
    assert Performance.load(recorded / "take-2" / "performance.npz").num_frames == 13


def test_a_clips_sound_is_kept_in_step(rendered_clip, tmp_path):
    clip = tmp_path / "sound.mkv"
    ffmpeg(
        *("-i", rendered_clip.footage, "-f", "lavfi", "-i", "sine=frequency=440:sample_rate=44100"),
        *("-map", "0:v", "-map", "1:a", "-c:v", "copy", "-c:a", "pcm_s16le", "-shortest", clip),
    )
    out = tmp_path / "out"
    assert record(clip, out, "--every-frame") == 0
    facts = json.loads((out / "take.json").read_text())
    assert facts["audio"] == "audio.wav" and facts["audio_offset"] == 0
    with wave.open(str(out / "audio.wav")) as sound:
        assert sound.getnframes() / sound.getframerate() == pytest.approx(
            facts["seconds"], abs=0.05
        )


def test_what_could_not_be_sent_is_said(rendered_clip, tmp_path, capsys, monkeypatch):
    class Deaf(socket.socket):
        def sendto(self, *_arguments):
            raise OSError("network is unreachable")

    monkeypatch.setattr(receiver.socket, "socket", Deaf)
    address = "livelink://127.0.0.1:9"
    words = ["--every-frame", "--seconds", "0.2", "--send", address]
    assert record(rendered_clip.footage, tmp_path / "out", *words) == 0
    assert f"{address}: 7 packets were not sent" in capsys.readouterr().err


def test_footage_without_a_face_is_said(tmp_path, capsys):
    clip = make_clip(tmp_path / "no_face.mp4", size="320x240")
    assert record(clip, tmp_path / "o", "--every-frame") == 2
    assert "no face was seen" in capsys.readouterr().err
    assert list((tmp_path / "o").iterdir()) == []


@pytest.mark.parametrize(("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_stop_before_there_is_a_face_is_no_bad_input(
    tmp_path, capfd, monkeypatch, number, status
):
    advance = LiveFilter.advance

    def stopped(self, image, time):
        os.kill(os.getpid(), number)
        return advance(self, image, time)

    monkeypatch.setattr(LiveFilter, "advance", stopped)
    clip = make_clip(tmp_path / "no_face.mp4", size="320x240", frames=1)
    assert record(clip, tmp_path / "o", "--every-frame") == status
    assert capfd.readouterr().err.splitlines()[-1] == "mimetic: stopped"
    teach = ["puppet", "teach", "--camera", str(clip), "--every-frame", "--out"]
    assert main([*teach, str(tmp_path / "set.npz")]) == status
    assert list((tmp_path / "o").iterdir()) == [] and not (tmp_path / "set.npz").exists()


@pytest.mark.parametrize(
    ("option", "message"),
    [
        (["--stillness", "2"], "--stillness is 2"),
        (["--seconds", "0"], "--seconds is 0"),
        (["--countdown", "99"], "--countdown is 99"),
        (["--send", "http://x"], "osc://HOST:PORT"),
        (["--freeze", "nose"], "there is no channel 'nose'"),
        (["--microphone", "default"], "a clip has its own sound"),
        (["--fit", "a.json", "--person", "b.json"], "give one of them"),
        (["--fit", "a.json", "--focal", "50"], "--fit has the lens"),
        (["--person", "none.json"], "none.json"),
    ],
)
def test_bad_options_are_one_line(rendered_clip, tmp_path, capsys, option, message):
    command = [
        "puppet",
        "record",
        str(rendered_clip.footage),
        "--out",
        str(tmp_path / "o"),
        *option,
    ]
    assert main(command) == 2
    error = capsys.readouterr().err
    assert message in error and len(error.strip().splitlines()) == 1
    assert not (tmp_path / "o").exists()  # nothing was begun


class Slow:
    """A clip of which each picture is worked on for longer than the next is away."""

    name, size, fps = "slow", (320, 240), 30.0

    def __init__(self, image):
        self.image = image

    def feed(self, pictures, events):
        for number in range(60):
            pictures.put(Picture(self.image, number / 30, number / 30))
            if events.wait(0.002):
                return


def test_who_is_late_skips_and_does_not_queue(rendered_clip):
    from mimetic.media.footage import Footage

    times = []

    class Filter(LiveFilter):
        def advance(self, image, time):
            times.append(time)
            return None

    def listen(picture, state):
        import time

        time.sleep(0.02)
        return True

    session = LiveSession(Slow(Footage(rendered_clip.footage).read(1)), Filter(), listen, print)
    session.run()
    assert session.figures.num_skipped == 60 - len(times) > 20
    assert times == sorted(times) and times[-1] == 59 / 30


def test_channels_that_are_frozen_stay():
    live = LiveFilter()
    assert {channel_of(name) for name in live.names} == set(CHANNELS) - {
        "head_position",
        "head_rotation",
    }
    freezer = Freezer(live.names, frozenset({"brows", "head_rotation"}))
    rows = np.random.default_rng(3).uniform(0, 1, (3, len(live.names)))
    poses = [np.eye(4) for _ in rows]
    for number, pose in enumerate(poses):
        pose[:2, :2] = [[np.cos(number), -np.sin(number)], [np.sin(number), np.cos(number)]]
        pose[0, 3] = number
    results = [freezer.apply(pose, row) for pose, row in zip(poses, rows, strict=True)]
    brow, jaw = live.names.index("frontalis_medial.L"), live.names.index("jaw_open")
    assert [values[brow] for _, values in results] == [rows[0, brow]] * 3
    assert [values[jaw] for _, values in results] == rows[:, jaw].tolist()
    assert [pose[0, 3] for pose, _ in results] == [0, 1, 2]
    np.testing.assert_array_equal(results[2][0][:3, :3], poses[0][:3, :3])


def test_dropped_pictures_are_bridged_and_long_gaps_held(recorded_states):
    states, face = recorded_states
    take = Take(25.0)
    for number, state in enumerate(states):
        if number not in (5, 6) and not 20 <= number < 32:
            take.add(state, face)
    performance = take.performance()
    assert performance.num_frames == len(states)
    assert (performance.quality[[5, 6]] >= HELD_QUALITY).all()
    assert (performance.quality[20:32] < HELD_QUALITY).all()
    num_muscles, held = performance.activations.shape[1], states[19]
    for row in range(20, 32):
        shown = np.clip(held.values[:num_muscles], 0, 1)
        np.testing.assert_allclose(performance.activations[row], shown, atol=1e-9)
        np.testing.assert_allclose(performance.head_pose[row], held.head_pose, atol=1e-6)
    first, last = (np.array(states[n].values[0]) for n in (4, 7))
    assert performance.activations[5, 0] == pytest.approx(first + (last - first) / 3, abs=1e-9)


def test_states_of_a_variable_rate_lie_on_the_frames_as_stored(recorded_states, tmp_path):
    states, face = recorded_states
    path, every_third = tmp_path / "a.mkv", ("-vf", "select=mod(n\\,3)", "-fps_mode", "passthrough")
    footage = Footage(make_numbered_clip(path, *every_third, "-c:v", "ffv1"))
    assert footage.variable_rate
    take = Take(float(footage.fps))
    for state, time in zip(states, footage.times, strict=False):
        take.add(replace(state, time=float(time)), face)
    performance = take.performance(footage)
    assert performance.frame.tolist() == list(range(1, footage.num_frames + 1))
    jaw = performance.articulators.index("jaw_open")
    values = [state.values[performance.activations.shape[1] + jaw] for state in states]
    stored = values[: footage.num_frames]
    np.testing.assert_allclose(performance.articulator_values[:, jaw], stored, atol=1e-9)
    assert (performance.quality >= HELD_QUALITY).all()


@pytest.fixture(scope="module")
def recorded_states(rendered_clip):
    from mimetic.media.footage import Footage

    live = LiveFilter(in_background=False)
    footage = Footage(rendered_clip.footage)
    return [live.advance(image, (n - 1) / 25) for n, image in footage.frames(1, 40)], live.face
