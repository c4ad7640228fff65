# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes that came from another .blend: their files are where that says, and another capture in a
file of the same name beside this one is not taken for theirs."""

import dataclasses
import os
import shutil

import bpy
import pytest
from conftest import make_performance

FILE = "hero.npz"


@pytest.fixture
def cast(scene, footage, performance, extension, tmp_path):
    """Saves a clip with a captured take and a face with it baked, and opens an empty file in
    another folder, in which a file of that name holds another capture; the two folders."""
    cast, shots = tmp_path / "cast", tmp_path / "shots"
    mark = extension("native").clip_fingerprint().fingerprint(str(footage))
    for folder, made in ((cast, performance), (shots, make_performance(40, seed=9))):
        folder.mkdir()
        dataclasses.replace(made, footage=[footage.name, mark]).save(folder / FILE)
    shutil.copy(footage, cast / "film.mp4")
    bpy.ops.wm.save_as_mainfile(filepath=str(cast / "cast.blend"))
    scene.render.fps = 25
    bpy.ops.mimetic.load_clip(filepath=str(cast / "film.mp4"))
    bpy.ops.mimetic.load_performance(filepath=str(cast / FILE))
    assert bpy.ops.mimetic.bake(use_texture=False, use_contact=False) == {"FINISHED"}
    bpy.context.scene.mimetic.face.name = "Hero"
    bpy.ops.wm.save_mainfile()
    empty(shots)
    return cast, shots


def empty(folder) -> None:
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "shot.blend"))


@pytest.fixture(params=["called", "not called"])
def told(request, extension):
    """Whether Blender tells of what is linked and appended, as 4.2 does not."""
    takes = extension("takes")
    ours = [pair for pair in takes.HANDLERS if pair[1] == takes.name_imported]
    if request.param == "not called":
        extension("handlers").remove(ours)
    yield
    if request.param == "not called":
        extension("handlers").add(ours)


def bring(cast, link: bool) -> bpy.types.Object:
    """Links or appends the face and the clip."""
    with bpy.data.libraries.load(str(cast / "cast.blend"), link=link) as (there, here):
        here.objects, here.movieclips = ["Hero"], there.movieclips
    bpy.context.scene.mimetic.clip = here.movieclips[0]
    bpy.context.scene.collection.objects.link(here.objects[0])
    bpy.context.view_layer.objects.active = here.objects[0]
    return here.objects[0]


def named(extension, obj) -> set[str]:
    """The files of all that names one: the take that is used, its row and the baked take's."""
    takes, (clip,) = extension("takes"), bpy.data.movieclips
    (record,) = clip.mimetic.footage
    (row,) = obj.mimetic.takes
    of_baked = takes.of_baked(row)
    return {takes.find(record), takes.find(record.captured[0]), of_baked and of_baked.path}


def saved() -> bpy.types.Object:
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.open_mainfile(filepath=bpy.data.filepath)
    return bpy.context.scene.objects["Hero"]


def test_appended_takes_have_their_own_files(extension, told, cast):
    own = {str(cast[0] / FILE)}
    assert named(extension, bring(cast[0], link=False)) == own
    assert named(extension, saved()) == own
    row = bpy.data.movieclips[0].mimetic.footage[0].captured[0]
    assert row.performance_path == bpy.path.native_pathsep(f"//../cast/{FILE}")


@pytest.mark.parametrize("is_reopened", [False, True])
def test_takes_made_local_have_their_own_files(extension, told, cast, is_reopened):
    own, hero = {str(cast[0] / FILE)}, bring(cast[0], link=True)
    assert named(extension, hero) == own
    if is_reopened:
        hero = saved()
        assert named(extension, hero) == own
    hero.make_local()
    bpy.data.movieclips[0].make_local()
    hero = bpy.context.scene.objects["Hero"]
    assert (hero.library, bpy.data.movieclips[0].library) == (None, None)
    assert named(extension, hero) == own
    assert named(extension, saved()) == own


def test_what_an_earlier_version_saved_is_named_on_the_way(extension, cast):
    """It noted no folder, and no capture of a clip's takes."""
    if not extension("compat").imports():
        pytest.skip("Blender does not tell of what was appended")
    for link in (True, False):
        bpy.ops.wm.open_mainfile(filepath=str(cast[0] / "cast.blend"))
        record = bpy.data.movieclips[0].mimetic.footage[0]
        for holder in (record, *record.captured, *bpy.data.objects["Hero"].mimetic.takes):
            holder.performance_folder = holder.capture = ""
        handlers = extension("takes").HANDLERS
        extension("handlers").remove(handlers)  # as that version saved it
        bpy.ops.wm.save_mainfile()
        extension("handlers").add(handlers)
        empty(cast[1])
        hero = bring(cast[0], link)
        if link:
            hero.make_local()
            bpy.data.movieclips[0].make_local()
        assert named(extension, bpy.context.scene.objects["Hero"]) == {str(cast[0] / FILE)}


def test_another_capture_of_that_name_is_not_taken_for_a_missing_one(
    extension, told, cast, tmp_path
):
    (cast[0] / FILE).unlink()
    bring(cast[0], link=False)
    takes = extension("takes")
    for _ in range(2):
        record = bpy.data.movieclips[0].mimetic.footage[0]
        assert [takes.find(holder) for holder in (record, record.captured[0])] == ["", ""]
        saved()
    assert not bpy.ops.mimetic.bake.poll()
    (tmp_path / "found").mkdir()
    found = shutil.move(cast[1] / FILE, tmp_path / "found" / FILE)
    assert bpy.ops.mimetic.find_missing(directory=str(tmp_path / "found")) == {"FINISHED"}
    record = bpy.data.movieclips[0].mimetic.footage[0]
    assert takes.find(record) == str(found)  # the user chose it


def test_an_override_has_the_files_of_the_linked_file(extension, told, cast, tmp_path):
    """Also where that was moved with its files."""
    hero = bring(cast[0], link=True).override_create(remap_local_usages=True)
    bpy.data.movieclips[0].make_local()
    assert named(extension, hero) == {str(cast[0] / FILE)}
    hero = saved()
    assert hero.override_library
    (row,) = hero.mimetic.takes
    takes = extension("takes")
    assert takes.path_of(row) == str(cast[0] / FILE)
    os.rename(cast[0], tmp_path / "moved")
    hero.override_library.reference.library.filepath = str(tmp_path / "moved" / "cast.blend")
    hero = saved()
    (row,) = hero.mimetic.takes
    assert takes.path_of(row) == str(tmp_path / "moved" / FILE)


@pytest.mark.parametrize("is_copy", [False, True])
def test_a_folder_moved_whole_or_copied_has_its_own_files(extension, cast, tmp_path, is_copy):
    moved = tmp_path / "moved"
    shutil.copytree(cast[0], moved)
    if not is_copy:
        shutil.rmtree(cast[0])
    bpy.ops.wm.open_mainfile(filepath=str(moved / "cast.blend"))
    assert named(extension, bpy.data.objects["Hero"]) == {str(moved / FILE)}
    assert named(extension, saved()) == {str(moved / FILE)}
