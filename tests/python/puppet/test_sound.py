# SPDX-License-Identifier: GPL-3.0-or-later
"""The sound of a clip; and ten minutes of a microphone that is not there, faster than time."""

import random
import sys
import threading
import wave
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from clips import ffmpeg
from mimetic.media.footage import Footage
from mimetic.puppet import live_thread, sound
from mimetic.puppet.live_thread import LiveThread
from mimetic.puppet.sample_clock import SampleClock
from mimetic.puppet.sound import RATE, Microphone, clip_sound

STAND_IN = Path(__file__).with_name("stand_in_microphone.py")
STARTED = 5000.0  # seconds of the clock when the first sample was taken
FRAME = 1 / 30


@pytest.mark.parametrize("later", [-0.5, 0.5])
@pytest.mark.parametrize("name", ["a.mkv", "a.mp4"])
def test_a_clips_sound_is_in_step_whichever_begins_first(tmp_path, name, later):
    source, clip = tmp_path / "source.mkv", tmp_path / name
    ffmpeg(
        *("-f", "lavfi", "-i", "testsrc=size=64x48:rate=25"),
        *("-f", "lavfi", "-i", "sine=frequency=1000:sample_rate=48000", "-t", "2"),
        *("-af", "volume=0:enable='lt(t,1)'", "-c:a", "pcm_s16le", source),
    )
    streams = ("0:v", "1:a") if later > 0 else ("1:v", "0:a")
    ffmpeg(
        *("-i", source, "-itsoffset", "0.5", "-i", source),
        *("-map", streams[0], "-map", streams[1], "-c:a", "aac", clip),
    )
    footage, path = Footage(clip), tmp_path / "audio.wav"
    assert footage.start == pytest.approx(max(0.0, -later), abs=0.03)
    assert clip_sound(footage, 0.2, 1.8, path)
    with wave.open(str(path)) as stream:
        samples = np.frombuffer(stream.readframes(stream.getnframes()), "<i2")
    begins = np.flatnonzero(np.abs(samples) > 1000)[0] / RATE
    assert begins == pytest.approx(1 + later - 0.2, abs=FRAME)


def heard(path, card, monkeypatch):
    """The microphone after ten minutes; card: millionths by which it is too fast."""
    true_rate = RATE * (1 + 1e-6 * card)
    late = random.Random(2)
    all_heard = threading.Event()

    class Clock(SampleClock):
        """As if time had passed: a chunk comes when its last sample was taken, or later."""

        def arrive(self, _at, num_samples):
            super().arrive(
                STARTED + num_samples / true_rate + late.expovariate(1 / 0.01), num_samples
            )
            if num_samples >= round(600 * true_rate):
                all_heard.set()

    monkeypatch.setattr(sound, "SampleClock", Clock)
    microphone = Microphone("default", path)
    microphone._command = [sys.executable, str(STAND_IN), str(card)]
    microphone.start()
    assert all_heard.wait(60)
    microphone.stop()
    assert not microphone.failure
    return microphone


@pytest.mark.parametrize("card", [0, 90, -90])
def test_after_ten_minutes_sound_is_in_step_within_a_frame(tmp_path, monkeypatch, card):
    path = tmp_path / "audio.wav"
    microphone = heard(path, card, monkeypatch)
    with wave.open(str(path)) as stream:
        assert (stream.getframerate(), stream.getnchannels(), stream.getsampwidth()) == (RATE, 1, 2)
        samples = np.frombuffer(stream.readframes(stream.getnframes()), "<i2")
    assert len(samples) / RATE == pytest.approx(600, abs=FRAME / 2)
    assert microphone.first_sample == pytest.approx(STARTED, abs=FRAME / 4)
    for second in (0, 299, 599):
        part = samples[second * RATE : (second + 1) * RATE]
        click = second + np.abs(part).argmax() / RATE + microphone.first_sample - STARTED
        assert click == pytest.approx(second + 0.5, abs=FRAME / 2)
    assert list(tmp_path.iterdir()) == [path]


def test_a_microphone_that_gives_nothing_is_told_and_leaves_no_file(tmp_path, monkeypatch):
    class Unplugged(Microphone):
        def start(self):
            self._command = [sys.executable, "-c", "raise SystemExit(1)"]
            super().start()
            self._thread.join()

    monkeypatch.setattr(live_thread, "Microphone", Unplugged)
    thread = LiveThread(SimpleNamespace(fps=30.0), 0.5)
    thread.begin_take("headset", tmp_path / "take.wav")
    assert thread.end_take() == (None, None)
    assert len(thread.told) == 1 and thread.told[0].startswith("microphone headset: ")
    assert list(tmp_path.iterdir()) == []


def test_a_few_seconds_tell_no_drift():
    clock = SampleClock(RATE)
    for chunk in range(1, 100):
        clock.arrive(10 + 0.1 * chunk + (0.02 if chunk > 50 else 0), 4800 * chunk)
    assert clock.drift == 0 and clock.first_sample == pytest.approx(10)


def test_sound_that_was_lost_is_no_drift():
    clock = SampleClock(RATE)
    for chunk in range(1, 1000):
        clock.arrive(10 + 0.1 * chunk + (0.5 if chunk > 500 else 0), 4800 * chunk)
    assert clock.drift == 0 and clock.first_sample == pytest.approx(10)
