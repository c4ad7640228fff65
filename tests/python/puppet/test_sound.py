# SPDX-License-Identifier: GPL-3.0-or-later
"""Ten minutes of a microphone that is not there, faster than time."""

import random
import sys
import threading
import wave
from pathlib import Path

import numpy as np
import pytest
from mimetic.puppet import sound
from mimetic.puppet.sample_clock import SampleClock
from mimetic.puppet.sound import RATE, Microphone

STAND_IN = Path(__file__).with_name("stand_in_microphone.py")
STARTED = 5000.0  # seconds of the clock when the first sample was taken
FRAME = 1 / 30


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
