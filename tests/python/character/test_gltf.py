# SPDX-License-Identifier: GPL-3.0-or-later
"""Times of an exported animation, whatever the exporter took a frame for."""

import numpy as np
import pytest
from mimetic import InvalidInput
from mimetic.character.gltf import FLOAT, Chunks, retime, write_chunks


def animated(*times: np.ndarray) -> bytes:
    """A file of motions, each with keys at these seconds."""
    contents = [np.asarray(seconds, np.float32).tobytes() for seconds in times]
    starts = np.cumsum([0, *map(len, contents)])
    view = [
        {"buffer": 0, "byteOffset": int(start), "byteLength": len(content)}
        for start, content in zip(starts, contents, strict=False)
    ]
    accessor = [
        {"bufferView": i, "componentType": FLOAT, "count": len(seconds), "type": "SCALAR"}
        for i, seconds in enumerate(times)
    ]
    document = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": int(starts[-1])}],
        "bufferViews": view,
        "accessors": accessor,
        "animations": [{"channels": [], "samplers": [{"input": i} for i in range(len(times))]}],
    }
    return write_chunks(document, b"".join(contents))


def seconds_of(glb: bytes, count: int) -> list[np.ndarray]:
    chunks = Chunks(glb)
    return [chunks.accessor(i)[:, 0] for i in range(count)]


@pytest.mark.parametrize("frames_a_second", [24.024, 30.0])
def test_motions_keep_when_they_begin(frames_a_second):
    """A walk that starts half a minute into the talk, and a pose of one key."""
    first = np.array([0, 720, 31])
    lengths = (69, 30, 1)
    frames = [start + np.arange(n) for start, n in zip(first, lengths, strict=True)]
    glb = retime(animated(*(at / frames_a_second for at in frames)), 23.976)
    for seconds, at in zip(seconds_of(glb, 3), frames, strict=True):
        np.testing.assert_allclose(seconds, at / 23.976, atol=1e-5)
    for entry, at in zip(Chunks(glb).document["accessors"], frames, strict=True):
        ends = [*entry["min"], *entry["max"]]
        np.testing.assert_allclose(ends, at[[0, -1]] / 23.976, atol=1e-5)


def test_a_pose_alone_is_at_the_start():
    (seconds,) = seconds_of(retime(animated(np.zeros(1)), 30.0), 1)
    assert seconds == [0]


def test_keys_that_are_not_a_frame_apart_are_refused():
    with pytest.raises(InvalidInput, match="not evenly spaced"):
        retime(animated([0, 0.1, 0.5]), 30.0)
