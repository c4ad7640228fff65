# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic bake` before it asks Blender."""

import pytest
from mimetic import InvalidInput, UnreadableMedia
from mimetic.commands.bake import bake
from mimetic.media.clip_fingerprint import fingerprint
from sample_performance import make_performance


@pytest.fixture
def clips(tmp_path):
    """The clip that was captured, and another one of the same size."""
    paths = tmp_path / "own.mp4", tmp_path / "other.mp4"
    for path, content in zip(paths, (b"own", b"fro"), strict=True):
        path.write_bytes(content)
    return paths


def test_footage_of_another_film_is_refused_before_blender_is_asked(clips, tmp_path):
    own, other = clips
    performance = make_performance(footage=["own.mp4", fingerprint(own)])
    performance.save(tmp_path / "p.npz")
    no_blender = tmp_path / "no python"
    with pytest.raises(InvalidInput, match=r"other.mp4 is not the clip that .* \(own.mp4\)"):
        bake(tmp_path / "p.npz", tmp_path / "face.glb", other, no_blender)
    with pytest.raises(UnreadableMedia, match="no python"):
        bake(tmp_path / "p.npz", tmp_path / "face.glb", own, no_blender)


def test_footage_of_a_performance_that_names_none_is_taken(clips, tmp_path):
    make_performance(footage=None).save(tmp_path / "p.npz")
    with pytest.raises(UnreadableMedia, match="no python"):
        bake(tmp_path / "p.npz", tmp_path / "face.glb", clips[1], tmp_path / "no python")
