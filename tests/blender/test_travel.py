# SPDX-License-Identifier: GPL-3.0-or-later
"""A .blend, its footage and its takes move, and are found again."""

import os
import shutil
from pathlib import Path

import bpy
import pytest
from test_clips import films, take_of  # noqa: F401 # films is a fixture

pytestmark = pytest.mark.newest


@pytest.fixture
def project(scene, films, sheet, tmp_path):  # noqa: F811
    """A folder with a saved .blend, its clip and the clip's take."""
    folder = tmp_path / "project"
    folder.mkdir()
    shutil.copy(films[0], folder / "anna.mp4")
    take_of(sheet, films[0], folder / "take.npz")
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "shot.blend"))
    bpy.ops.mimetic.load_clip(filepath=str(folder / "anna.mp4"))
    bpy.ops.mimetic.load_performance(filepath=str(folder / "take.npz"))
    bpy.ops.wm.save_mainfile()
    return folder


@pytest.fixture
def take(extension):
    """The clip's take: how the .blend names it, and where it is found."""

    def current() -> tuple[str, str]:
        takes, scene = extension("takes"), bpy.context.scene
        kept = takes.of_clip(scene, scene.mimetic.clip)
        return kept.performance_path, takes.find(kept)

    return current


def reopen(path: Path) -> None:
    bpy.ops.wm.open_mainfile(filepath=str(path))


def test_a_folder_that_was_moved_still_bakes(project, take, tmp_path):
    assert take() == ("//take.npz", str(project / "take.npz"))
    assert bpy.context.scene.mimetic.clip.filepath == "//anna.mp4"
    os.rename(project, tmp_path / "moved")
    reopen(tmp_path / "moved" / "shot.blend")
    assert take()[1] == str(tmp_path / "moved" / "take.npz")
    assert bpy.ops.mimetic.bake() == {"FINISHED"}


def test_the_footage_behind_the_face_moves_along(project, scene, tmp_path):
    """Also as an image, which it is where the scene has another rate than the clip."""
    scene.render.fps = 24
    assert bpy.ops.mimetic.bake(use_contact=False, use_texture=False) == {"FINISHED"}
    bpy.ops.wm.save_mainfile()
    os.rename(project, tmp_path / "moved")
    reopen(tmp_path / "moved" / "shot.blend")
    (behind,) = bpy.context.scene.camera.data.background_images
    assert behind.source == "IMAGE"
    film = Path(bpy.path.abspath(behind.image.filepath))
    assert film.resolve() == (tmp_path / "moved" / "anna.mp4").resolve()
    assert behind.image.size[:] == bpy.context.scene.mimetic.clip.size[:]


def test_saving_elsewhere_keeps_the_way_to_the_take(project, take, tmp_path):
    other = tmp_path / "a" / "b"
    other.mkdir(parents=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(other / "copy.blend"), copy=True)
    assert take() == ("//take.npz", str(project / "take.npz"))  # what is open stayed
    with pytest.raises(RuntimeError):
        bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "nowhere" / "x.blend"))
    assert take() == ("//take.npz", str(project / "take.npz"))
    reopen(other / "copy.blend")
    assert take() == ("//../../project/take.npz", str(project / "take.npz"))
    bpy.ops.wm.save_as_mainfile(filepath=str(project / "back.blend"))
    assert take()[0] == "//take.npz"


def test_a_first_save_names_takes_from_the_blend(
    scene,
    films,  # noqa: F811
    sheet,
    take,
    tmp_path,
):
    bpy.ops.mimetic.load_clip(filepath=str(films[0]))
    path = take_of(sheet, films[0], tmp_path / "take.npz")
    bpy.ops.mimetic.load_performance(filepath=str(path))
    assert take()[0] == str(path)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "first.blend"))
    assert take()[0] == "//take.npz"


def test_a_take_beside_the_blend_is_found(project, take, tmp_path):
    (project / "takes").mkdir()
    os.rename(project / "take.npz", project / "takes" / "take.npz")
    bpy.ops.mimetic.load_performance(filepath=str(project / "takes" / "take.npz"))
    bpy.ops.wm.save_mainfile()
    flat = tmp_path / "flat"
    flat.mkdir()
    for name in ("shot.blend", "takes/take.npz"):
        shutil.move(project / name, flat)
    reopen(flat / "shot.blend")
    assert take() == ("//takes/take.npz", str(flat / "take.npz"))


def test_another_clips_take_beside_the_blend_is_not_it(project, take, tmp_path, films, sheet):  # noqa: F811
    """Each capture from the command line is called alike."""
    away = tmp_path / "away"
    away.mkdir()
    shutil.move(project / "take.npz", away)
    bpy.ops.mimetic.load_performance(filepath=str(away / "take.npz"))
    bpy.ops.wm.save_mainfile()
    take_of(sheet, films[1], project / "take.npz")
    os.rename(away, tmp_path / "not mounted")
    assert take() == ("//../away/take.npz", "")
    bpy.ops.wm.save_mainfile()
    os.rename(tmp_path / "not mounted", away)
    assert take() == ("//../away/take.npz", str(away / "take.npz"))


def test_what_is_missing_is_asked_for(extension, project, take, tmp_path, films, sheet):  # noqa: F811
    """By content: a take of that name of another clip is not taken, a renamed clip is."""
    assert not bpy.ops.mimetic.find_missing.poll()
    deep = tmp_path / "archive" / "2026" / "takes"
    wrong = tmp_path / "archive" / "2025"
    deep.mkdir(parents=True)
    wrong.mkdir()
    take_of(sheet, films[1], wrong / "take.npz")
    shutil.move(project / "take.npz", deep)
    shutil.move(project / "anna.mp4", deep / "renamed.mp4")
    for button in (bpy.ops.mimetic.bake, bpy.ops.mimetic.hold_head_still):
        assert not button.poll()
    no_performance = extension("scene_in").no_performance
    assert no_performance(bpy.context) == ("take.npz is missing: look for it (Find Missing Files)")
    (tmp_path / "empty").mkdir()
    assert bpy.ops.mimetic.find_missing(directory=str(tmp_path / "empty")) == {"CANCELLED"}
    assert bpy.ops.mimetic.find_missing(directory=str(tmp_path / "archive")) == {"FINISHED"}
    assert take()[1] == str(deep / "take.npz")
    assert take()[0].startswith("//")
    clip = bpy.context.scene.mimetic.clip
    assert Path(bpy.path.abspath(clip.filepath)).resolve() == deep / "renamed.mp4"
    assert bpy.ops.mimetic.bake() == {"FINISHED"}


@pytest.mark.parametrize("fps", [25, 24], ids=["the clip's rate", "another rate"])
def test_a_bake_without_the_footage_writes_all_or_nothing(project, scene, fps, sheet):
    scene = bpy.context.scene
    scene.render.fps = fps
    (project / "anna.mp4").unlink()
    with pytest.raises(RuntimeError, match=r"anna\.mp4 is missing: .*untick Footage as Skin"):
        bpy.ops.mimetic.bake()
    assert (len(bpy.data.objects), len(bpy.data.actions), len(bpy.data.images)) == (0, 0, 0)
    assert bpy.ops.mimetic.bake(use_texture=False) == {"FINISHED"}
    (behind,) = scene.camera.data.background_images
    if fps == 25:
        assert behind.clip == scene.mimetic.clip
    else:  # an image that shows once Blender finds the file
        assert behind.image.source == "MOVIE"
        assert Path(bpy.path.abspath(behind.image.filepath)) == project / "anna.mp4"
