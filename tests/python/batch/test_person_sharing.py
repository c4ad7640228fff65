# SPDX-License-Identifier: GPL-3.0-or-later
"""Clips of one person share that person's fit, with a stand-in for the commands."""

import json
import shutil
import threading
from dataclasses import replace

import pytest
from clips import make_clip
from mimetic.batch import plan
from mimetic.batch.clip_list import Row
from mimetic.batch.person import MARK
from mimetic.batch.steps import Settings
from mimetic.batch.task import Task, run_task
from stand_in import Commands


@pytest.fixture(scope="module")
def clips(tmp_path_factory):
    """Three clips of other content."""
    folder = tmp_path_factory.mktemp("clips")
    return [
        make_clip(folder / f"{number}.mp4", size="320x240", frames=12 + number)
        for number in range(3)
    ]


@pytest.fixture
def commands():
    return Commands()


@pytest.fixture
def out(tmp_path):
    folder = tmp_path / "out"
    folder.mkdir()
    return folder


def folders(out, *rows):
    return [task.folder for task in plan.prepare(out, rows, Settings()).tasks]


def fit_option(words):
    return next(
        (
            (option, words[words.index(option) + 1])
            for option in ("--fit", "--person")
            if option in words
        ),
        None,
    )


def test_the_fit_is_found_once_in_the_first_clip_whoever_comes_first(clips, out, commands):
    one, two, _ = folders(out, *(Row(str(clip), person="Anna") for clip in clips))
    assert run_task(two, commands) == (0, "") and run_task(one, commands) == (0, "")
    assert commands.names == ["fit", "capture", "capture"]
    fit = str(out / "people" / "anna" / "fit.json")
    assert commands.words[0][1] == str(clips[0])
    assert fit_option(commands.words[1]) == ("--person", fit)
    assert fit_option(commands.words[2]) == ("--fit", fit)
    assert Task.load(one).is_all_done() and Task.load(two).is_all_done()


def test_ranges_of_one_footage_share_the_fit_as_it_is(clips, out, commands):
    rows = [Row(str(clips[0]), frames, person="anna") for frames in ("1:5", "6:12")]
    for folder in folders(out, *rows):
        run_task(folder, commands)
    assert "--frames=1:5" in commands.words[0]
    assert [fit_option(words)[0] for words in commands.words[1:]] == ["--fit", "--fit"]


def test_each_face_is_found_with_its_own_clips_lens(clips, out, commands):
    lenses = ({"focal": "35", "sensor": "23.5"}, {"focal": "50"}, {})
    rows = [Row(str(c), person="anna", **lens) for c, lens in zip(clips, lenses, strict=True)]
    for folder in folders(out, *rows):
        run_task(folder, commands)
    given = [
        [word for word in words if "--focal" in word or "--sensor" in word]
        for words in commands.words
    ]
    # The fit, the clip that it is of, and clips that take the person from it
    assert given == [["--focal=35", "--sensor=23.5"], [], ["--focal=50"], []]


def test_another_lens_is_another_fit(clips, out, commands):
    for focal in ("35", "35", "50"):
        (folder,) = folders(out, Row(str(clips[0]), person="anna", focal=focal))
        run_task(folder, commands)
    assert [words[-1] for words in commands.words if words[0] == "fit"] == [
        "--focal=35",
        "--focal=50",
    ]


def test_where_the_first_clip_shows_no_face_the_next_gives_the_fit(clips, out, commands):
    commands.answers["0.mp4"] = (2, "no face")
    one, two, _ = folders(out, *(Row(str(clip), person="anna") for clip in clips))
    assert run_task(two, commands) == (0, "") and run_task(one, commands)[0] == 2
    assert commands.names == ["fit", "fit", "capture", "capture"]
    assert fit_option(commands.words[2])[0] == "--fit"


def test_a_person_in_no_clip_fails_each_of_them_with_the_reason(clips, out, commands):
    commands.answers["fit"] = (2, "no face")
    for folder in folders(out, *(Row(str(clip), person="anna") for clip in clips)):
        assert run_task(folder, commands) == (2, "no fit of anna: no face")
    assert [words[1] for words in commands.words] == list(map(str, clips))  # once


def test_a_person_in_no_clip_is_looked_for_again_where_one_changed(clips, out, commands, tmp_path):
    copies = [shutil.copy(clip, tmp_path) for clip in clips[:2]]
    (one, _) = folders(out, *(Row(copy, person="anna") for copy in copies))
    commands.answers["fit"] = (2, "no face")
    run_task(one, commands)
    run_task(one, commands)
    assert commands.names == ["fit", "fit"]
    del commands.answers["fit"]
    commands.answers["0.mp4"] = (2, "no face")
    shutil.copy(clips[2], copies[1])
    assert run_task(one, commands) == (2, "no face")  # of its capture
    assert commands.names[2:] == ["fit", "fit", "capture"]


def test_a_person_in_no_clip_is_looked_for_again_when_the_batch_is_begun_again(
    clips, out, commands
):
    rows = [Row(str(clip), person="anna") for clip in clips[:2]]
    commands.answers["fit"] = (2, "no networks")
    for folder in folders(out, *rows):
        run_task(folder, commands)
    del commands.answers["fit"]
    for folder in folders(out, *rows):
        assert run_task(folder, commands) == (0, "")
    assert commands.names == ["fit", "fit", "fit", "capture", "capture"]


def test_what_may_not_fail_again_is_looked_for_again(clips, out, commands):
    (folder,) = folders(out, Row(str(clips[0]), person="anna"))
    commands.answers["fit"] = (1, "the disk is full")
    for _ in range(2):
        assert run_task(folder, commands) == (2, "no fit of anna: the disk is full")
    assert commands.names == ["fit", "fit"]


@pytest.mark.parametrize("parts", [3, 4, 6])
def test_a_file_of_other_sources_is_no_person(clips, out, commands, parts):
    (folder,) = folders(out, Row(str(clips[0]), person="anna"))
    mark = out / "people" / "anna" / MARK
    document = json.loads(mark.read_text())
    document["sources"] = [(document["sources"][0] + [""])[:parts]]
    mark.write_text(json.dumps(document))
    status, reason = run_task(folder, commands)
    assert status == 2 and "not a person of a batch" in reason


def test_a_fit_in_the_table_is_the_persons(clips, out, commands, tmp_path):
    (tmp_path / "anna.json").write_text("calibrated")
    fit = str(tmp_path / "anna.json")
    one, two, three = folders(
        out,
        Row(str(clips[0]), person="anna", fit=fit),
        Row(str(clips[1]), person="anna"),
        Row(str(clips[2]), person="ben"),
    )
    for folder in (one, two, three):
        run_task(folder, commands)
    assert commands.names == ["capture", "capture", "fit", "capture"]
    assert fit_option(commands.words[0]) == ("--fit", fit)
    assert fit_option(commands.words[1]) == ("--person", fit)
    assert fit_option(commands.words[3])[1] == str(out / "people" / "ben" / "fit.json")


def test_a_fit_that_a_later_line_names_is_the_persons(clips, out, commands, tmp_path):
    (tmp_path / "anna.json").write_text("calibrated")
    fit = str(tmp_path / "anna.json")
    rows = [Row(str(clip), person="anna") for clip in clips]
    rows[1] = replace(rows[1], fit=fit)
    for folder in folders(out, *rows):
        assert run_task(folder, commands) == (0, "")
    assert [fit_option(words) for words in commands.words] == [
        ("--person", fit),
        ("--fit", fit),
        ("--person", fit),
    ]


def test_what_is_asked_while_a_fit_is_looked_for_is_another_fit(clips, out, commands):
    (folder,) = folders(out, Row(str(clips[0]), person="anna"))

    def run_command(words):
        if words[0] == "fit":
            folders(out, Row(str(clips[0]), person="anna", focal="28"))
        return commands(words)

    assert run_task(folder, run_command) == (0, "")
    assert run_task(folder, commands) == (0, "")
    fits = [words for words in commands.words if words[0] == "fit"]
    assert len(fits) == 2 and fits[1][-1] == "--focal=28"


def test_clips_of_a_person_that_were_moved_are_done(clips, out, commands, tmp_path):
    rows = [Row(shutil.copy(clip, tmp_path), person="anna") for clip in clips]
    before = folders(out, *rows)
    for folder in before:
        run_task(folder, commands)
    moved = tmp_path / "moved"
    moved.mkdir()
    rows = [replace(row, clip=shutil.move(row.clip, moved)) for row in rows]
    assert folders(out, *rows) == before
    assert all(Task.load(folder).is_all_done() for folder in before)


def test_another_first_clip_is_another_fit_and_other_captures(clips, out, commands):
    rows = [Row(str(clip), person="anna") for clip in clips]
    for folder in folders(out, *rows[:2]):
        run_task(folder, commands)
    for folder in folders(out, *rows):
        run_task(folder, commands)
    assert commands.names == ["fit", "capture", "capture", "capture"]
    for folder in folders(out, *rows[::-1]):
        assert not Task.load(folder).is_all_done() and not Task.load(folder).has_all()
        run_task(folder, commands)
    assert commands.names[4:] == ["fit", "capture", "capture", "capture"]


def test_clips_of_a_person_that_are_gone_leave_results_that_are_enough(
    clips, out, commands, tmp_path
):
    rows = [Row(shutil.copy(clip, tmp_path), person="anna") for clip in clips[:2]]
    one, two = folders(out, *rows)
    for folder in (one, two):
        assert not Task.load(folder).has_all()
        run_task(folder, commands)
        assert Task.load(folder).has_all()
    (tmp_path / "0.mp4").unlink()
    assert Task.load(one).has_all() and Task.load(two).has_all()
    (out / "people" / "anna" / "fit.json").write_text("another fit")
    assert Task.load(one).has_all() and not Task.load(two).has_all()  # of which that can be told


def test_of_many_who_need_the_fit_one_finds_it(clips, out, commands):
    works = [
        threading.Thread(target=run_task, args=(folder, commands))
        for folder in folders(out, *(Row(str(clip), person="anna") for clip in clips))
    ]
    for work in works:
        work.start()
    for work in works:
        work.join()
    assert commands.names.count("fit") == 1 and commands.names.count("capture") == 3


@pytest.mark.parametrize("name", ["../x", "Anna / Ben", "x" * 300, "."])
def test_names_of_people_that_are_no_folders_names(clips, out, commands, name):
    (folder,) = folders(out, Row(str(clips[0]), person=name))
    assert run_task(folder, commands) == (0, "")
    (person,) = (out / "people").iterdir()
    assert person.name.isalnum() and len(person.name) <= 80
