# SPDX-License-Identifier: GPL-3.0-or-later
import json
import os
import shutil
from dataclasses import replace

import pytest
from mimetic import InvalidInput, UnreadableMedia
from mimetic.batch import plan
from mimetic.batch.clip_list import Row, rows_of
from mimetic.batch.page import write_page
from mimetic.batch.standing import Standing
from mimetic.batch.steps import Settings
from mimetic.batch.task import Task


@pytest.fixture
def rows(tmp_path):
    """Clips of three folders, two of one name, and one whose name differs by case alone."""
    made = []
    for name in ("a/shot.mp4", "b/shot.mp4", "c/SHOT.mov"):
        path = tmp_path / name
        path.parent.mkdir()
        path.write_bytes(name.encode())
        made.append(Row(str(path)))
    return made


@pytest.fixture
def out(tmp_path):
    folder = tmp_path / "out"
    folder.mkdir()
    return folder


def folders(batch):
    return {task.row.clip: task.name for task in batch.tasks}


def test_two_clips_of_one_name_have_folders_of_their_own(rows, out):
    batch = plan.prepare(out, rows, Settings())
    assert [task.name for task in batch.tasks] == ["shot", "shot-2", "SHOT-3"]
    assert all((task.folder / "task.json").is_file() for task in batch.tasks)


def test_a_clip_keeps_its_folder_whatever_others_come_and_go(rows, out):
    before = folders(plan.prepare(out, rows, Settings()))
    after = folders(plan.prepare(out, rows[:0:-1], Settings(("glb",))))
    assert after == {clip: before[clip] for clip in after}
    assert folders(plan.prepare(out, rows, Settings())) == before


def test_ranges_and_characters_of_one_clip_are_takes_of_their_own(rows, out):
    clip = rows[0].clip
    takes = [Row(clip, "1:9"), Row(clip, "10:19"), Row(clip, "1:9", character="/r.blend:Head")]
    assert len({task.name for task in plan.prepare(out, takes, Settings()).tasks}) == 3


def test_one_clip_with_several_fits_has_a_folder_for_each(rows, out, tmp_path):
    takes = [Row(rows[0].clip, fit=str(tmp_path / name)) for name in ("a.json", "b.json")]
    before = plan.prepare(out, takes, Settings())
    assert [task.name for task in before.tasks] == ["shot", "shot-2"]
    assert plan.prepare(out, takes, Settings()) == before


def test_folders_of_something_else_are_left_alone(rows, out):
    (out / "shot").mkdir()
    (out / "shot" / "mine.txt").write_text("mine")
    batch = plan.prepare(out, rows[:1], Settings())
    assert batch.tasks[0].name == "shot-2"
    assert [path.name for path in (out / "shot").iterdir()] == ["mine.txt"]


@pytest.mark.parametrize(
    "name",
    ["batch.json", "index.html", "people", "template.json", "..", "a:b{c}%", "x" * 200, "\u202e"],
)
def test_names_that_would_be_in_the_way_are_changed(tmp_path, out, name):
    path = tmp_path / f"{name}.mp4"
    path.write_bytes(b"")
    (task,) = plan.prepare(out, [Row(str(path))], Settings()).tasks
    assert task.folder.parent == out and task.folder.is_dir()
    assert not set(task.name) & set(":{}%\u202e") and len(task.name) <= 84


def test_a_batch_is_read_as_it_was_prepared(rows, out):
    gone = Row("/gone.mp4", problem="there is no such file")
    batch = plan.prepare(out, [*rows, gone], Settings(("blend",), True, 0.05, "/python"))
    assert plan.load(out) == batch


def names_of(batch):
    return [task.name for task in batch.tasks]


def test_a_batch_that_begins_while_another_is_at_work_joins_its_plan(rows, out):
    gone, lost = (Row(f"/{name}.mp4", problem="there is no such file") for name in ("gone", "lost"))
    with plan.begun(out, [*rows[:2], gone, lost], Settings()) as first:
        with plan.begun(out, [rows[2], rows[1], lost], Settings()) as second:
            assert names_of(first) == ["shot", "shot-2"]
            assert names_of(second) == ["SHOT-3", "shot-2"]
        both = plan.load(out)  # also when one has ended
        assert names_of(both) == ["shot", "SHOT-3", "shot-2"] and both.problems == [gone, lost]
    left_over = out / ".mimetic-batch-killed"
    left_over.mkdir()
    with plan.begun(out, rows[1:2], Settings()):
        assert names_of(plan.load(out)) == ["shot-2"] and not left_over.exists()
    assert not list(out.glob(".mimetic-*"))


@pytest.mark.parametrize("of", ["clip", "character", "table", "fps"])
def test_a_name_that_is_no_text_is_the_same_problem_in_every_run(tmp_path, out, of):
    name = os.fsdecode(b"bad\xe9")
    clip = tmp_path / (f"{name}.mp4" if of == "clip" else "clip.mp4")
    (tmp_path / name).mkdir()
    table = tmp_path / name / "table.csv"
    table.write_text("clip,range\n,1:2\n")
    rig = tmp_path / f"{name}.blend"
    for path in (clip, rig):
        path.write_bytes(b"")
    given = [table.parent / "gone.csv", table] if of == "table" else [clip]
    more = {"character": f"{rig}:Head"} if of == "character" else {}
    more |= {"fps": name} if of == "fps" else {}
    for _ in range(2):
        batch = plan.prepare(out, rows_of(given, **more), Settings())
        assert batch.tasks == [] and len(batch.problems) == len(given)
        assert plan.load(out) == batch and all(row.problem for row in batch.problems)
        assert [path.name for path in out.iterdir()] == ["batch.json"]
    if of == "clip":
        (row,) = batch.problems
        assert row.clip == str(tmp_path / "bad\\udce9.mp4") and "is no text" in row.problem


def test_a_folder_that_is_gone_is_a_problem_of_its_clip_alone(rows, out):
    batch = plan.prepare(out, rows, Settings())
    (batch.tasks[1].folder / "task.json").unlink()
    again = plan.load(out)
    assert [task.name for task in again.tasks] == ["shot", "SHOT-3"]
    assert "there is no such file" in again.problems[0].problem


def test_a_folder_that_vanishes_while_the_batch_runs_is_its_clips_failure(rows, out):
    batch = plan.prepare(out, rows, Settings())
    shutil.rmtree(batch.tasks[0].folder)
    failures = plan.reload(batch)
    assert list(failures) == ["shot"] and "no such file" in failures["shot"]
    write_page(batch, failures, Standing())
    assert "no such file" in (out / "index.html").read_text()


def test_a_clip_that_failed_with_its_last_settings_is_failed_on_the_page_too(rows, out):
    """Though the results of the settings before are there, as `--summary` says."""
    (task,) = plan.prepare(out, rows[:1], Settings()).tasks
    for step in task.steps():
        for name in step.outputs:
            (task.folder / name).touch()
        task.done[step.name] = {"key": "k", "files": {}, "seconds": 1.0}
    task.error = "the face fit is of other footage"
    task.save()
    write_page(plan.load(out), {}, Standing())
    assert "other footage" in (out / "index.html").read_text()


def test_clips_for_which_another_batch_asks_otherwise_are_not_ours(rows, out):
    batch = plan.prepare(out, rows, Settings())
    assert plan.reload(batch) == {}
    plan.prepare(out, [replace(rows[0], focal="28"), *rows[1:]], Settings())
    failures = plan.reload(batch)
    assert list(failures) == ["shot"] and "another batch in this folder" in failures["shot"]


def test_what_is_asked_anew_leaves_what_is_done(rows, out):
    (task,) = plan.prepare(out, rows[:1], Settings()).tasks
    task.done["capture"] = {"key": "k", "files": {}, "seconds": 1.0}
    task.save()
    (again,) = plan.prepare(out, [replace(rows[0], focal="28")], Settings()).tasks
    assert again.done == task.done
    task.save()
    assert Task.load(task.folder).row.focal == "28"


def capture(batch):
    """Notes the clips as captured, as far as plans look."""
    for task in batch.tasks:
        task.done["capture"] = {"key": task.steps()[0].key(), "files": {}, "seconds": 1.0}
        task.save()


def test_clips_that_were_moved_and_renamed_keep_their_folders(rows, out, tmp_path):
    batch = plan.prepare(out, rows, Settings())
    capture(batch)
    moved = []
    for i, row in enumerate(rows[::-1]):
        path = tmp_path / f"moved {i}.mp4"
        os.rename(row.clip, path)
        moved.append(Row(str(path)))
    new = tmp_path / "new.mp4"
    new.write_bytes(b"new")
    after = plan.prepare(out, [*moved, Row(str(new))], Settings())
    assert [task.name for task in after.tasks] == ["SHOT-3", "shot-2", "shot", "new"]
    assert [task.row.clip for task in plan.load(out).tasks] == [row.clip for row in moved] + [
        str(new)
    ]


def test_a_copy_of_a_clip_and_another_content_have_folders_of_their_own(rows, out, tmp_path):
    capture(plan.prepare(out, rows, Settings()))
    copy, other = tmp_path / "copy.mp4", tmp_path / "other.mp4"
    shutil.copy(rows[0].clip, copy)
    os.unlink(rows[1].clip)
    other.write_bytes(b"other")
    names = [
        task.name for task in plan.prepare(out, [Row(str(copy)), Row(str(other))], Settings()).tasks
    ]
    assert names == ["copy", "other"]


def test_files_that_are_no_batch_are_refused(rows, out):
    with pytest.raises(UnreadableMedia, match="no such file"):
        plan.load(out)
    (out / "batch.json").write_text("[]")
    with pytest.raises(InvalidInput, match="not the plan of a batch"):
        plan.load(out)


@pytest.mark.parametrize(
    "change",
    [
        {"schema": 2},
        {"clip": {"clip": 3}},
        {"clip": {"nonsense": "x"}},
        {"settings": {}},
        {"done": {"capture": {"key": 1, "files": {}}}},
        {"written": ["face.blend"]},
        {"written": {"face.blend": 3}},
        {"take": []},
        {"take": {"frames": "x"}},
        {"kept": ["face.kept.blend"]},
        {"kept": {"face.kept.blend": 3}},
        {"kept": None, "notes": [3]},
        {"kept": None, "notes": ["a note of something else"]},
    ],
)
def test_tasks_of_another_make_are_refused_and_prepared_again(rows, out, change):
    (task,) = plan.prepare(out, rows[:1], Settings()).tasks
    path = task.folder / "task.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | change))
    with pytest.raises(InvalidInput, match="not the task of a batch"):
        Task.load(task.folder)
