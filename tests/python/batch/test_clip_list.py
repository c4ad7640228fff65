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


def test_results_of_a_batch_in_the_folder_are_no_clips(clips):
    results = clips / "out" / "one"
    results.mkdir(parents=True)
    (results / "overlay.mp4").write_bytes(b"result")
    (results / "task.json").write_text("{}")
    assert names(rows_of([clips])) == ["one.mp4", "three.mkv", "two.MOV"]


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
