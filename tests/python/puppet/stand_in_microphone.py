#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""An ffmpeg that hears ten minutes at once, with a click every second, by a card that is too fast
or too slow by so many millionths (the argument). Then it waits, as microphones do not end."""

import array
import sys
import time

rate = 48000 * (1 + 1e-6 * float(sys.argv[1]))  # what the card takes in a second of the clock
samples = array.array("h", bytes(2 * round(600 * rate)))
for second in range(600):
    start = round((second + 0.5) * rate)
    samples[start : start + 24] = array.array("h", [20000] * 24)
sys.stdout.buffer.write(samples.tobytes())
sys.stdout.buffer.flush()
time.sleep(60)
