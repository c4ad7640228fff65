# SPDX-License-Identifier: GPL-3.0-or-later
"""The sound of a take: a clip's own, or a microphone's beside a camera; audio.wav."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
import wave
from pathlib import Path
from time import monotonic

from mimetic import InvalidInput
from mimetic.media.ffmpeg import ffmpeg_program
from mimetic.media.ffmpeg_process import running
from mimetic.media.footage import CONTAINERS, Footage
from mimetic.puppet.camera_source import reason_of
from mimetic.puppet.sample_clock import SampleClock

RATE, SAMPLE_BYTES = 48000, 2  # mono, 16 bits
READ = 4800 * SAMPLE_BYTES  # a tenth of a second
HEARD = 0.005  # seconds of drift at the end of a take from which on it is taken out
FINER = 10  # times the rate at which it is: ffmpeg knows whole rates alone


def clip_sound(footage: Footage, start: float, seconds: float, path: Path) -> bool:
    """Writes the sound of a part of a clip, from `start`; false where the clip has none.

    start, seconds: of the clip's pictures, from the first. Sample 0 belongs to `start`.
    """
    if not isinstance(footage.path, Path):  # numbered pictures
        return False
    begin = max(0.0, footage.start + start)  # times of decoding can begin below 0
    command = [
        *(ffmpeg_program(), "-nostdin", "-hide_banner", "-v", "error", "-y"),
        *("-protocol_whitelist", "file", "-format_whitelist", CONTAINERS),
        *("-i", f"file:{footage.path.absolute()}", "-map", "0:a:0"),
        # Sound that begins late is preceded by silence, so that time 0 is the file's. Of MPEG
        # streams ffmpeg counts it from what is asked for: sound begins with the pictures there
        *("-af", "aresample=async=1:first_pts=0", "-ss", f"{begin:.6f}", "-t", f"{seconds:.6f}"),
        *("-ac", "1", "-ar", str(RATE), "-f", "s16le", "pipe:1"),
    ]
    with running(command) as ffmpeg, _WavFile(path) as wav:
        while samples := ffmpeg.output.read(READ):
            wav.write(samples)
        ffmpeg.process.wait()
    if wav.num_samples == 0:
        path.unlink(missing_ok=True)
    return wav.num_samples > 0


class Microphone:
    """Records while a session runs, and says when its samples were taken.

    name: as the system has it, `default` on Linux; path: the file. Raises InvalidInput.
    """

    def __init__(self, name: str, path: Path) -> None:
        self._command = [
            *(ffmpeg_program(), "-nostdin", "-hide_banner", "-v", "warning", "-nostats"),
            *microphone_input(name, sys.platform),
            *("-map", "0:a:0", "-ac", "1", "-ar", str(RATE), "-f", "s16le", "pipe:1"),
        ]
        self._name, self._path = name, path
        self._stop = threading.Event()
        self._clock = SampleClock(RATE)
        self.failure = ""
        self._thread = threading.Thread(target=self._record, name="microphone", daemon=True)

    def start(self) -> None:
        self._thread.start()

    def stop(self) -> None:
        """Ends the recording; the file is whole then, and keeps time with `monotonic`'s clock.

        Where nothing was heard there is no file, and `failure` says why.
        """
        self._stop.set()
        self._thread.join()
        if self.is_recorded:
            self._take_out_drift()
        else:
            self._path.unlink(missing_ok=True)
            self.failure = self.failure or f"microphone {self._name}: it gave no sound"

    @property
    def is_recorded(self) -> bool:
        return self._clock.has_begun

    @property
    def first_sample(self) -> float:
        """When the first sample was taken, by `monotonic`'s clock, seconds."""
        return self._clock.first_sample

    def _take_out_drift(self) -> None:
        """A card that is a ten-thousandth slow is two frames early after ten minutes."""
        drift = self._clock.drift
        with wave.open(str(self._path)) as sound:
            seconds = sound.getnframes() / RATE
        if abs(drift) * seconds < HEARD:
            return
        even = self._path.with_name(f"even_{self._path.name}")
        rate = round(FINER * RATE / (1 + drift))
        slowed = f"aresample={FINER * RATE},asetrate={rate},aresample={RATE}"
        command = [
            *(ffmpeg_program(), "-nostdin", "-hide_banner", "-v", "error", "-y"),
            *("-i", f"file:{self._path.absolute()}", "-af", slowed, "-c:a", "pcm_s16le"),
            *("-f", "wav", f"file:{even.absolute()}"),
        ]
        with running(command) as ffmpeg:
            ffmpeg.process.wait()
        if ffmpeg.process.returncode == 0:
            os.replace(even, self._path)
        else:
            even.unlink(missing_ok=True)
            off = round(1000 * drift * seconds)
            self.failure = f"microphone {self._name}: its sound is {off} ms off at the end"

    def _record(self) -> None:
        with running(self._command) as ffmpeg, _WavFile(self._path) as wav:
            closer = threading.Thread(target=self._end, args=(ffmpeg.process,), daemon=True)
            closer.start()
            while samples := ffmpeg.output.read1(READ):
                at = monotonic()
                wav.write(samples)
                self._clock.arrive(at, wav.num_samples)
            ffmpeg.process.wait()
        if not self._stop.is_set():
            reason = reason_of(ffmpeg.errors, "microphone")
            self.failure = f"microphone {self._name}: {reason}"

    def _end(self, process: subprocess.Popen[bytes]) -> None:
        self._stop.wait()
        process.kill()


class _WavFile:
    """Mono samples of 16 bits as they come."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self.num_samples = 0
        self._rest = b""

    def __enter__(self) -> _WavFile:
        self._wave = wave.open(str(self._path), "wb")
        self._wave.setnchannels(1)
        self._wave.setsampwidth(SAMPLE_BYTES)
        self._wave.setframerate(RATE)
        return self

    def write(self, samples: bytes) -> None:
        samples = self._rest + samples
        whole = len(samples) - len(samples) % SAMPLE_BYTES
        self._rest = samples[whole:]
        self._wave.writeframes(samples[:whole])
        self.num_samples += whole // SAMPLE_BYTES

    def __exit__(self, *_exception: object) -> None:
        self._wave.close()


def microphone_input(name: str, platform: str) -> list[str]:
    """ffmpeg's words for a microphone; platform: as `sys.platform`. Raises InvalidInput."""
    if not name or name.startswith("-") or any(ord(letter) < 32 for letter in name):
        raise InvalidInput(f"--microphone {name!r} names no microphone; give its name")
    if platform == "darwin":
        return ["-f", "avfoundation", "-i", f":{name}"]
    if platform == "win32":
        return ["-f", "dshow", "-i", f"audio={name}"]
    return ["-f", "pulse", "-i", name]
