# SPDX-License-Identifier: GPL-3.0-or-later
import os

import pytest
from mimetic import InvalidInput
from mimetic.batch.clip_list import rows_of


@pytest.fixture
def clips(tmp_path):
    """Four videos, as far as names tell, in a folder of folders."""
    for name in ("one.mp4", "sub/two.MOV", "sub/deep/three.mkv", ".cache/hidden.mp4"):
        path = tmp_path / "clips" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(name.encode())
    (tmp_path / "clips" / "notes.txt").write_text("no clip")
    return tmp_path / "clips"


def names(rows):
    return [os.path.basename(row.clip) for row in rows]


def table(path, text):
    path.write_text(text, encoding="utf-8")
    return path


def test_folders_give_the_clips_in_them_and_below(clips):
    assert names(rows_of([clips])) == ["one.mp4", "three.mkv", "two.MOV"]


def test_clips_in_linked_folders_are_found_once(clips, tmp_path):
    store = tmp_path / "store"
    store.mkdir()
    (store / "four.mp4").write_bytes(b"four")
    (clips / "a link").symlink_to(store)
    (clips / "another link").symlink_to(store)
    (clips / "a loop").symlink_to(clips)
    assert names(rows_of([clips])) == ["four.mp4", "one.mp4", "three.mkv", "two.MOV"]


def test_a_dead_link_in_a_folder_is_a_clip_that_is_gone(clips, tmp_path):
    (clips / "gone.mp4").symlink_to(tmp_path / "unmounted" / "gone.mp4")
    (clips / "itself.mov").symlink_to("itself.mov")
    (clips / "gone.txt").symlink_to(tmp_path / "gone.txt")
    problems = {os.path.basename(row.clip): row.problem for row in rows_of([clips])}
    assert [name for name, problem in problems.items() if problem] == ["gone.mp4", "itself.mov"]
    assert "there is no such file" in problems["gone.mp4"]


def test_results_of_a_batch_in_the_folder_are_no_clips(clips):
    results = clips / "out" / "one"
    results.mkdir(parents=True)
    (results / "overlay.mp4").write_bytes(b"result")
    (results / "task.json").write_text("{}")
    assert names(rows_of([clips])) == ["one.mp4", "three.mkv", "two.MOV"]


def test_results_of_a_capture_in_the_folder_are_no_clips(clips):
    """A clip of that name elsewhere is one."""
    for name in ("one", "one/unfinished-2"):
        results = clips / name
        results.mkdir()
        for file in ("overlay.mp4", "puppet.mp4"):
            (results / file).write_bytes(b"result")
    (clips / "one" / "performance.npz").write_bytes(b"result")
    (clips / "one" / "four.mp4").write_bytes(b"four")
    (clips / "sub" / "overlay.mp4").write_bytes(b"five")
    found = ["four.mp4", "one.mp4", "overlay.mp4", "three.mkv", "two.MOV"]
    assert sorted(names(rows_of([clips]))) == sorted(found)


def test_a_clip_that_is_named_twice_is_done_once(clips):
    assert names(rows_of([clips / "one.mp4", clips])) == ["one.mp4", "three.mkv", "two.MOV"]


def test_a_table_gives_fit_character_range_and_person_beside_itself(clips, tmp_path):
    for name in ("fit.json", "rig.blend"):
        (tmp_path / name).write_bytes(b"x")
    path = table(
        tmp_path / "clips.csv",
        "\ufeffclip,Fit,character,range,person\n"
        "clips/one.mp4,fit.json,rig.blend:Head,10:200,anna\n\n"
        '"clips/sub/two.MOV"\n',
    )
    first, second = rows_of([path], frames="1:9")
    assert first.clip == str(clips / "one.mp4") and first.fit == str(tmp_path / "fit.json")
    assert first.character == f"{tmp_path / 'rig.blend'}:Head"
    assert (first.frames, first.person, first.problem) == ("10:200", "anna", "")
    assert (second.frames, second.fit, second.person) == ("1:9", "", "")


def test_what_is_wrong_with_one_line_is_said_of_that_clip(clips, tmp_path):
    path = table(
        tmp_path / "clips.csv",
        "clip,range,character,fit\n"
        "clips/gone.mp4,,,\n"
        "clips/one.mp4,9:2,,\n"
        "clips/one.mp4,,rig.fbx,\n"
        "clips/one.mp4,,,gone.json\n"
        ",1:2,,\n"
        "clips/one.mp4,,,\n",
    )
    problems = [row.problem for row in rows_of([path])]
    expected = ["no such file", "first before the last", "RIG.blend:OBJECT", "gone.json", "no clip"]
    assert all(part in problem for part, problem in zip(expected, problems, strict=False))
    assert problems[5:] == [""]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "must name the columns"),
        (b"file,fit\na.mp4,\n", "must name the columns"),
        (b"clip,clip\na.mp4,b.mp4\n", "must name the columns"),
        (b"clip,range\na,b.mp4,1:2\n", "line 2: 3 columns"),
        (b"clip\n\xff\xfe.mp4\n", "UTF-8"),
        (b'clip\n"a.mp4\n', "no CSV"),
    ],
)
def test_a_table_that_makes_no_sense_is_refused(tmp_path, content, message):
    path = tmp_path / "clips.csv"
    path.write_bytes(content)
    with pytest.raises(InvalidInput, match=message):
        rows_of([path])


def test_missing_files_folders_and_tables_are_lines_of_the_summary(tmp_path):
    (tmp_path / "empty").mkdir()
    rows = rows_of([tmp_path / "gone.mp4", tmp_path / "gone.csv", tmp_path / "empty"])
    assert [bool(row.problem) for row in rows] == [True] * 3


def test_a_name_that_is_no_text_is_said_and_not_fatal(tmp_path):
    path = os.fsdecode(os.fsencode(tmp_path) + b"/\xe9.mp4")
    with open(path, "wb"):
        pass
    (row,) = rows_of([tmp_path])
    assert "no text" in row.problem


def pictures(folder, numbers, name="frame_{:04d}.png"):
    folder.mkdir(parents=True, exist_ok=True)
    for number in numbers:
        (folder / name.format(number)).write_bytes(b"picture")
    return folder


def test_numbered_pictures_in_folders_are_clips(clips):
    pictures(clips / "shot", range(1001, 1020))
    pictures(clips / "shot", range(40, 53), "other.{}.exr")
    pictures(clips / "holiday", (1, 2, 3, 20, 21, 22), "IMG_{:04d}.JPG")
    pictures(clips / "lone", [7], "poster{}.png")
    found = names(rows_of([clips], fps="25"))
    assert found == ["one.mp4", "frame_1001.png", "other.40.exr", "three.mkv", "two.MOV"]
    row = next(row for row in rows_of([clips], fps="25") if "1001" in row.clip)
    assert (row.problem, row.fps) == ("", "25")


def test_pictures_of_a_result_are_no_clip(clips):
    results = pictures(clips / "out" / "one", range(20))
    (results / "task.json").write_text("{}")
    assert names(rows_of([clips])) == ["one.mp4", "three.mkv", "two.MOV"]


def test_all_pictures_that_a_shell_names_are_one_clip(tmp_path):
    folder = pictures(tmp_path / "shot", (*range(9, 12), *range(20, 22)))
    given = [path for path in sorted(folder.iterdir()) if path.name != "frame_0009.png"]
    assert names(rows_of(given)) == ["frame_0010.png", "frame_0020.png"]


def test_a_table_gives_the_rate_of_pictures(tmp_path):
    folder = pictures(tmp_path / "shots" / "sh010", range(3))
    path = table(
        tmp_path / "clips.csv",
        "clip,fps\nshots/sh010,23.976\nshots/sh010/frame_####.png,\nshots/none_%04d.png,\n"
        f"{folder / 'frame_0001.png'},fast\n{folder / 'frame_0001.png'},-1\n",
    )
    first, second, missing, word, negative = rows_of([path], fps="30")
    assert (first.clip, first.fps, first.problem) == (str(folder), "23.976", "")
    assert (second.fps, second.problem) == ("30", "")
    assert "no such pictures" in missing.problem
    assert "fps fast: give frames a second" in word.problem
    assert "a rate of -1" in negative.problem


def test_a_folder_of_results_is_named_after_the_pictures_folder(tmp_path):
    from mimetic.batch.plan import prepare
    from mimetic.batch.steps import Settings

    for shot in ("sh010", "sh020"):
        pictures(tmp_path / "shots" / shot, range(1, 14))
    out = tmp_path / "out"
    out.mkdir()
    batch = prepare(out, rows_of([tmp_path / "shots"], fps="25"), Settings())
    assert [task.name for task in batch.tasks] == ["sh010", "sh020"]
    words = batch.tasks[0].steps()[0].words
    assert "--fps=25" in words and words[1].endswith("sh010/frame_0001.png")


def test_a_lens_is_taken_whole_from_the_table_or_from_the_call(clips, tmp_path):
    lines = "clip,focal,sensor\nclips/one.mp4,35,23.5\nclips/sub/two.MOV\nclips/one.mp4,50\n"
    rows = rows_of([table(tmp_path / "clips.csv", lines)], focal="25", sensor="17.3")
    assert [(row.focal, row.sensor) for row in rows] == [("35", "23.5"), ("25", "17.3"), ("50", "")]
    assert not any(row.problem for row in rows)


@pytest.mark.parametrize(
    ("focal", "sensor", "problem"),
    [
        ("wide", "", "focal wide, sensor : give millimetres, such as 35 and 23.5"),
        ("", "24", "sensor 24 is of a focal length: give focal too"),
        ("3", "", "focal length 3 mm: on a sensor 36 mm wide it must be 7.2 to 2160"),
        ("nan", "24", "focal length nan mm: it must be above 0"),
    ],
)
def test_a_lens_that_cannot_be_is_the_clips_problem(clips, tmp_path, focal, sensor, problem):
    path = table(tmp_path / "clips.csv", f"clip,focal,sensor\nclips/one.mp4,{focal},{sensor}\n")
    (row,) = rows_of([path])
    assert row.problem == problem
