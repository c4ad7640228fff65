# SPDX-License-Identifier: GPL-3.0-or-later
"""Files whose names are no UTF-8, of another system's disk: read, written and told."""

import os
import shutil
import sys

import bpy
import pytest
from last_result import result
from panel_texts import drawn

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="names are no bytes elsewhere")


@pytest.fixture
def strange(sheet_file, tmp_path) -> str:
    path = os.fsdecode(os.fsencode(tmp_path) + b"/t\xe9te.npz")
    shutil.copy(sheet_file, path)
    return path


def test_what_is_loaded_baked_and_written_is_told(strange):
    assert bpy.ops.mimetic.load_performance(filepath=strange) == {"FINISHED"}
    assert result()["performance"] == strange
    assert bpy.ops.mimetic.bake() == {"FINISHED"}
    texts = drawn("MIMETIC_PT_capture_view")
    assert "t\\udce9te.npz" in texts and texts.encode()
    written = strange.removesuffix("npz") + "glb"
    assert bpy.ops.mimetic.export_gltf(filepath=written) == {"FINISHED"}
    assert os.path.getsize(written) and result()["file"] == written


def test_what_cannot_be_read_is_told(strange):
    with pytest.raises(RuntimeError, match="is not video that can be read"):
        bpy.ops.mimetic.load_clip(filepath=strange)
    assert "t\\udce9te.npz" in result()["message"]
