#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""An ffmpeg that reads a camera which is not there: the device's name says how it behaves.

Each opening of a device is counted in the file that STAND_IN_COUNT names, so that a camera can be
gone at the second one and back at the third.
"""

import os
import re
import sys
import time

arguments = sys.argv[1:]
device = arguments[arguments.index("-i") + 1]
behaviour = device.rsplit("/", 1)[-1]
width, height = map(
    int, re.search(r"scale=(\d+):(\d+)", arguments[arguments.index("-vf") + 1]).groups()
)
counter = os.environ["STAND_IN_COUNT"]
with open(counter, "a") as stream:
    stream.write(".")
opening = os.path.getsize(counter)


def say(text):
    sys.stderr.write(text + "\n")
    sys.stderr.flush()


def show(number, size=(640, 480)):
    """A grey frame of this brightness, and showinfo's line about it."""
    say(f"[Parsed_showinfo_0 @ 0x1] n: {number} pts: {number} sar:1/1 s:{size[0]}x{size[1]} i:P ")
    sys.stdout.buffer.write(bytes([number]) * (width * height * 3))
    sys.stdout.buffer.flush()
    time.sleep(0.02)


if behaviour == "forbidden":
    say(f"[in#0 @ 0x1] Error opening input: Permission denied\n{device}: Permission denied")
    sys.exit(1)
if behaviour == "busy":
    say(f"{device}: Device or resource busy")
    sys.exit(1)
if behaviour in ("unplugged", "replugged") and opening == 2:
    say(f"{device}: No such file or directory")
    sys.exit(1)
if behaviour == "unplugged" and opening > 2:
    say(f"{device}: No such file or directory")
    sys.exit(1)
for number in range(1, 11):
    show(number)
if behaviour in ("unplugged", "replugged") and opening == 1:
    say(f"[video4linux2 @ 0x1] ioctl(VIDIOC_DQBUF): No such device\n{device}: No such device")
    sys.exit(1)
if behaviour == "stalled":
    time.sleep(1.5)
size = (320, 240) if behaviour == "resized" else (640, 480)
for number in range(11, 21):
    show(number, size)
if behaviour == "silent":
    time.sleep(60)
# Cameras do not end: this one waits until it is not wanted any more
time.sleep(60)
