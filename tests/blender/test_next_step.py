# SPDX-License-Identifier: GPL-3.0-or-later
"""From a video that is dropped to a corrected, baked face, by the button alone that is lit."""

import bpy
import pytest
from last_result import result
from panel_texts import drawn, lit_buttons
from test_clips import films, take_of  # noqa: F401 # films is a fixture

PANELS = ("MIMETIC_PT_capture_clip", "MIMETIC_PT_capture_view")
MOST_STEPS = 12


def press_what_is_lit() -> list[str]:
    """Until nothing is lit; the names of what was pressed."""
    pressed = []
    while lit := lit_buttons(PANELS[0]):
        assert lit_buttons(PANELS[1]) == lit and len(lit) == 1 and len(pressed) < MOST_STEPS
        operator = getattr(bpy.ops.mimetic, lit[0].removeprefix("mimetic."))
        assert f"Next: {operator.get_rna_type().name}" in drawn(PANELS[0])
        assert operator() == {"FINISHED"}
        pressed.append(lit[0])
    return pressed


@pytest.mark.newest
def test_what_is_lit_leads_from_a_dropped_video_to_a_corrected_baked_face(
    extension, clip_path, tmp_path
):
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    scene = bpy.context.scene
    assert lit_buttons(PANELS[0]) == ["mimetic.load_clip"]
    bpy.ops.mimetic.load_clip(filepath=str(clip_path))
    scene.mimetic.use_frame_range = True  # the clip has 30 frames
    scene.mimetic.frame_first, scene.mimetic.frame_last = 1, 8
    way = ["mimetic.find_face", "mimetic.capture", "mimetic.bake"]
    assert press_what_is_lit() == way
    assert "Baked" in drawn(PANELS[0])
    first_take = result()["take"]
    bpy.ops.mimetic.correct_value(frame=4, value_name="lid_upper.L", value=0.5)
    assert press_what_is_lit() == ["mimetic.refine", "mimetic.bake"]
    assert result()["take"] != first_take
    performance = extension("shown_take").performance(bpy.context)
    correcting = extension("native").correcting()
    assert correcting.value_at(performance, 4, "lid_upper.L") == pytest.approx(0.5, abs=0.1)
    bpy.ops.mimetic.delete_correction(frame=4)
    assert lit_buttons(PANELS[0]) == ["mimetic.refine"]


def test_what_is_missing_is_looked_for_first(scene, footage, performance_file, tmp_path):
    film, take = tmp_path / "film.mp4", tmp_path / "hero.npz"
    film.write_bytes(footage.read_bytes())
    take.write_bytes(performance_file.read_bytes())
    bpy.ops.mimetic.load_clip(filepath=str(film))
    assert lit_buttons(PANELS[0]) == ["mimetic.find_face"]
    film.unlink()
    assert set(lit_buttons(PANELS[0])) == {"mimetic.find_missing"}
    film.write_bytes(footage.read_bytes())
    bpy.ops.mimetic.load_performance(filepath=str(take))
    assert lit_buttons(PANELS[0]) == ["mimetic.bake"]
    take.unlink()
    assert lit_buttons(PANELS[0]) == ["mimetic.find_missing"]


def test_a_take_without_footage_is_baked(scene, performance_file):
    bpy.ops.mimetic.load_performance(filepath=str(performance_file))
    assert lit_buttons(PANELS[0]) == ["mimetic.bake"]
    bpy.ops.mimetic.bake(use_contact=False, use_texture=False)
    assert lit_buttons(PANELS[0]) == [] and "Baked" in drawn(PANELS[0])
    bpy.ops.mimetic.remove_take()
    assert lit_buttons(PANELS[0]) == ["mimetic.bake"]


def test_a_take_of_another_clip_in_a_file_of_that_name_is_not_baked(
    films,  # noqa: F811
    performance,
    tmp_path,
):
    for film, folder in zip(films, "ab", strict=True):
        (tmp_path / folder).mkdir()
        bpy.ops.mimetic.load_clip(filepath=str(film))
        take = take_of(performance, film, tmp_path / folder / "performance.npz")
        bpy.ops.mimetic.load_performance(filepath=str(take))
        assert lit_buttons(PANELS[0]) == ["mimetic.bake"]
        bpy.ops.mimetic.bake(use_contact=False, use_texture=False)
        assert lit_buttons(PANELS[0]) == []
