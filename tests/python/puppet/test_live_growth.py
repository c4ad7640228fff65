# SPDX-License-Identifier: GPL-3.0-or-later
"""A session that goes on and on keeps nothing of the pictures that it worked on."""

import sys
import tracemalloc
from pathlib import Path

import pytest
from mimetic.puppet.clip_source import ClipSource
from mimetic.puppet.live_filter import LiveFilter
from mimetic.puppet.live_session import LiveSession

WARM, LAST = (
    150,
    300,
)  # pictures: until the person's head is known and buffers are there; to the end
PICTURE = 320 * 240 * 3  # bytes


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="memory as Linux tells it")
def test_memory_of_a_session_does_not_grow_with_its_pictures(rendered_clip):
    times, memory = [], []

    def resident():
        lines = Path("/proc/self/status").read_text().splitlines()
        (kilobytes,) = [line.split()[1] for line in lines if line.startswith("VmRSS")]
        return 1024 * int(kilobytes)

    def listen(picture, _state):
        times.append(picture.time)
        if len(times) == WARM:
            tracemalloc.start()
        if len(times) in (WARM + 5, LAST):
            memory.append((tracemalloc.get_traced_memory()[0], resident()))
        return len(times) < LAST

    source = ClipSource(rendered_clip.footage, is_paced=False, is_looped=True)
    try:
        LiveSession(source, LiveFilter(in_background=False), listen, print).run()
    finally:
        tracemalloc.stop()
    assert times == pytest.approx([number / source.fps for number in range(LAST)])
    (python_before, all_before), (python_after, all_after) = memory
    num_pictures = LAST - WARM - 5
    # A picture is 230 kB: one in a hundred that is kept would show in the first, one in three in
    # the second, which the system's allocator makes uneven
    assert python_after - python_before < num_pictures * PICTURE / 100
    assert all_after - all_before < num_pictures * PICTURE / 3
