# SPDX-License-Identifier: GPL-3.0-or-later
"""What a task does and leaves, with a stand-in for the commands that it runs."""

import json
import os
import shutil
import subprocess
import sys
import threading
from pathlib import Path

import pytest
from clips import make_clip
from mimetic.batch import plan
from mimetic.batch.clip_list import Row
from mimetic.batch.standing import Standing
from mimetic.batch.steps import Settings
from mimetic.batch.task import Task, run_task
from mimetic.shared.results import staging
from mimetic.shared.whole_file import whole_file
from stand_in import Commands


@pytest.fixture(scope="module")
def clip(tmp_path_factory):
    return make_clip(tmp_path_factory.mktemp("clip") / "clip.mp4", size="320x240", frames=12)


GLB = Settings(("glb",))


@pytest.fixture
def commands():
    return Commands()


@pytest.fixture
def prepare(tmp_path, clip):
    """Prepares a task of a copy of the clip, which may then be changed."""
    copy = Path(shutil.copy(clip, tmp_path / "clip.mp4"))
    (tmp_path / "out").mkdir()

    def prepared(settings=GLB, **row) -> Path:
        batch = plan.prepare(tmp_path / "out", [Row(str(copy), **row)], settings)
        return batch.tasks[0].folder

    prepared.clip = copy
    return prepared


def test_what_is_done_is_not_done_again(prepare, commands):
    folder = prepare()
    assert run_task(folder, commands) == (0, "")
    assert commands.names == ["capture", "face.glb"]
    assert run_task(folder, commands) == (0, "") and run_task(prepare(), commands) == (0, "")
    assert commands.names == ["capture", "face.glb"]
    assert Task.load(folder).is_all_done()
    assert (folder / "picture.jpg").read_bytes()[:2] == b"\xff\xd8"
    assert Task.load(folder).take["num_held"] == 2


def test_what_changed_is_done_again_and_nothing_else(prepare, commands):
    folder = prepare()
    run_task(folder, commands)
    run_task(prepare(Settings(("glb",), with_detail=True)), commands)
    assert commands.names[2:] == ["face.glb"]
    run_task(prepare(Settings(("blend", "glb"), with_detail=True)), commands)
    assert commands.names[3:] == ["face.blend"]
    (folder / "face.glb").unlink()
    run_task(folder, commands)
    assert commands.names[4:] == ["face.glb"]


def test_another_content_of_the_clip_is_captured_anew(prepare, commands):
    folder = prepare()
    run_task(folder, commands)
    make_clip(prepare.clip, size="320x240", frames=13)
    run_task(folder, commands)
    assert commands.names == ["capture", "face.glb"] * 2
    os.utime(prepare.clip, (1, 1))
    run_task(folder, commands)
    assert len(commands.names) == 4


def test_a_clip_elsewhere_with_its_content_is_done(prepare, commands, tmp_path):
    folder = prepare()
    run_task(folder, commands)
    moved = shutil.move(prepare.clip, tmp_path / "moved.mp4")
    task = Task.load(folder)
    task.row = Row(str(moved))
    assert task.is_all_done()


def test_results_that_were_changed_by_hand_are_kept(prepare, commands):
    folder = prepare()
    run_task(folder, commands)
    (folder / "face.glb").write_text("polished for hours")
    run_task(folder, commands)
    assert len(commands.names) == 2
    run_task(prepare(Settings(("glb",), with_detail=True)), commands)
    assert (folder / "face.kept.glb").read_text() == "polished for hours"
    assert "--detail" in (folder / "face.glb").read_text()
    assert "face.kept.glb" in Task.load(folder).notes[0]


def test_a_copy_that_is_gone_is_no_longer_told_of_and_another_is_told_of_once(prepare, commands):
    folder = prepare()
    run_task(folder, commands)
    for tolerance in (0.05, 0.1):
        (folder / "face.glb").write_text("polished for hours")
        run_task(prepare(Settings(("glb",), tolerance=tolerance)), commands)
        told = ["face.glb was changed by hand and is kept as face.kept.glb"]
        assert Task.load(folder).notes == told
        (folder / "face.kept.glb").unlink()
        assert Task.load(folder).notes == []


def test_notes_that_were_kept_as_texts_are_of_the_same_copies(prepare, commands):
    folder = prepare()
    run_task(folder, commands)
    (folder / "face.glb").write_text("polished for hours")
    run_task(prepare(Settings(("glb",), with_detail=True)), commands)
    document = json.loads((folder / "task.json").read_text())
    assert document.pop("kept") == {"face.kept.glb": "face.glb"}
    notes = ["face.glb was changed by hand and is kept as face.kept.glb"]
    (folder / "task.json").write_text(json.dumps(document | {"notes": notes * 2}))
    assert Task.load(folder).notes == notes


def test_why_a_task_failed_is_kept_until_it_is_done(prepare, commands):
    folder = prepare()
    commands.answers["capture"] = (2, "no face")
    assert run_task(folder, commands) == (2, "no face")
    assert Task.load(folder).error == "no face" and commands.names == ["capture"]
    commands.answers.clear()
    assert run_task(folder, commands) == (0, "")
    assert Task.load(folder).error == "" and Task.load(folder).is_all_done()


def test_a_task_that_was_stopped_did_not_fail(prepare, commands):
    folder = prepare()
    commands.answers["capture"] = (143, "stopped")
    assert run_task(folder, commands) == (143, "stopped")
    assert Task.load(folder).error == ""


def test_results_of_the_settings_before_outlive_a_bake_that_fails(prepare, commands):
    folder = prepare()
    run_task(folder, commands)
    commands.answers["face.glb"] = (1, "Blender failed")
    assert run_task(prepare(Settings(("glb",), with_detail=True)), commands)[0] == 1
    assert (folder / "face.glb").exists()
    assert run_task(prepare(), commands) == (0, "")
    assert commands.names == ["capture", "face.glb", "face.glb"]


@pytest.mark.parametrize("status", [1, 130])
def test_what_was_polished_after_a_bake_failed_is_kept_by_the_next(prepare, commands, status):
    folder = prepare()
    run_task(folder, commands)
    commands.answers["face.glb"] = (status, "no end")
    other = Settings(("glb",), tolerance=0.05)
    assert run_task(prepare(other), commands)[0] == status
    (folder / "face.glb").write_text("polished for hours")
    commands.answers.clear()
    assert run_task(prepare(other), commands) == (0, "")
    assert (folder / "face.kept.glb").read_text() == "polished for hours"
    assert "--few-keys" in (folder / "face.glb").read_text()


def killed(commands, name):
    """As a task's process ends in `kill -9`, when a command has written its files."""

    def run_command(words):
        outcome = commands(words)
        if commands.names[-1] == name:
            raise KeyboardInterrupt
        return outcome

    return run_command


def test_what_was_polished_after_a_kill_is_kept_by_the_next(prepare, commands):
    folder = prepare()
    run_task(folder, commands)
    with pytest.raises(KeyboardInterrupt):
        run_task(prepare(Settings(("glb",), with_detail=True)), killed(commands, "face.glb"))
    assert Task.load(folder).begun == "glb"
    (folder / "face.glb").write_text("polished for hours")
    assert run_task(folder, commands) == (0, "")
    assert (folder / "face.kept.glb").read_text() == "polished for hours"


def test_what_a_killed_process_had_written_alike_is_not_kept(prepare, commands):
    folder = prepare()
    for _ in range(2):
        with pytest.raises(KeyboardInterrupt):
            run_task(folder, killed(commands, "capture"))
    assert (folder / "fit.kept.json").exists()  # whoever wrote it
    assert run_task(folder, commands) == (0, "")
    assert list(folder.glob("*.kept*")) == [] and Task.load(folder).notes == []


def test_the_part_of_a_capture_that_was_stopped_is_not_kept(prepare, commands):
    folder = prepare()

    def run_command(words):
        (folder / "performance.npz").write_text("a part")
        return 143, "stopped"

    assert run_task(folder, run_command)[0] == 143
    assert run_task(folder, commands) == (0, "")
    assert list(folder.glob("*.kept*")) == [] and Task.load(folder).notes == []


def test_a_task_that_was_written_before_marks_were_keeps_what_was_polished(prepare, commands):
    folder = prepare()
    run_task(folder, commands)
    document = json.loads((folder / "task.json").read_text())
    del document["written"]
    (folder / "task.json").write_text(json.dumps(document))
    (folder / "face.glb").write_text("polished for hours")
    run_task(prepare(Settings(("glb",), with_detail=True)), commands)
    assert [path.name for path in folder.glob("*.kept*")] == ["face.kept.glb"]


def test_what_is_asked_while_a_task_is_at_work_is_done_by_the_next(prepare, commands):
    folder = prepare()

    def run_command(words):
        if words[0] == "capture":
            prepare(GLB, focal="28")
        return commands(words)

    assert run_task(folder, run_command) == (0, "")
    assert Task.load(folder).row.focal == "28" and not Task.load(folder).is_all_done()
    assert run_task(folder, commands) == (0, "")
    assert "--focal=28" in commands.words[2] and Task.load(folder).is_all_done()


def test_a_task_whose_results_were_removed_is_not_done(prepare, commands):
    folder = prepare()
    run_task(folder, commands)
    assert Task.load(folder).has_all()
    (folder / "performance.npz").unlink()
    assert not Task.load(folder).has_all()


def test_results_of_other_settings_or_another_content_are_not_those_that_are_asked(
    prepare, commands
):
    folder = prepare()
    run_task(folder, commands)
    for settings, row in ((Settings(("glb",), with_detail=True), {}), (GLB, {"focal": "28"})):
        prepare(settings, **row)
        assert not Task.load(folder).has_all()
    prepare()
    assert Task.load(folder).has_all()
    make_clip(prepare.clip, size="320x240", frames=13)
    assert not Task.load(folder).has_all()


def test_results_whose_clip_is_gone_are_enough(prepare, commands):
    folder = prepare()
    run_task(folder, commands)
    prepare.clip.unlink()
    assert Task.load(folder).has_all() and not Task.load(folder).is_all_done()


def test_what_was_done_is_known_until_its_task_changes(prepare, commands):
    folder = prepare()
    standing = Standing()
    assert standing.why_not(Task.load(folder), {}) is None
    run_task(folder, commands)
    assert standing.why_not(Task.load(folder), {}) == ""
    make_clip(prepare.clip, size="320x240", frames=13)
    assert standing.why_not(Task.load(folder), {}) == ""  # though it would be seen by another
    assert Standing().why_not(Task.load(folder), {}) is None
    prepare(GLB, focal="28")
    assert standing.why_not(Task.load(folder), {}) is None
    assert standing.why_not(Task.load(folder), {"clip": "no face"}) == "no face"


def test_one_step_alone_can_be_run(prepare, commands):
    folder = prepare()
    assert run_task(folder, commands, ["capture"]) == (0, "")
    assert commands.names == ["capture"] and not Task.load(folder).is_all_done()
    run_task(folder, commands, ["glb"])
    assert commands.names == ["capture", "face.glb"] and Task.load(folder).is_all_done()


def test_a_clip_that_is_gone_fails_alone(prepare, commands):
    folder = prepare()
    prepare.clip.unlink()
    status, message = run_task(folder, commands)
    assert status == 2 and "no such file" in message and commands.names == []


def test_left_over_files_of_a_killed_process_are_removed(prepare, commands):
    folder = prepare()
    (folder / ".mimetic-abc").mkdir()
    (folder / ".mimetic-abc" / "part").write_text("x")
    (folder / ".mimetic-x.part").write_text("x")
    run_task(folder, commands)
    assert [path.name for path in folder.glob(".mimetic*")] == []


def test_what_a_living_process_writes_beside_a_task_stays(prepare, commands):
    """As of a capture by hand into the clip's folder."""
    folder = prepare()
    with staging(folder) as at_work, whole_file(folder / "mine.json") as stream:
        (at_work / "part").write_text("x")
        run_task(folder, commands)
        assert (at_work / "part").read_text() == "x"
        stream.write(b"{}")
    assert (folder / "mine.json").read_text() == "{}"


def test_of_two_who_run_a_task_one_does_it(prepare, commands):
    folder = prepare()
    others = [threading.Thread(target=run_task, args=(folder, commands)) for _ in range(3)]
    for other in others:
        other.start()
    for other in others:
        other.join()
    assert commands.names == ["capture", "face.glb"]


def test_a_killed_process_lets_go_of_its_task(prepare, commands):
    folder = prepare()
    code = (
        "import sys, time; from pathlib import Path; "
        "from mimetic.batch.task import run_task; "
        "run_task(Path(sys.argv[1]), lambda words: (print('at work', flush=True), time.sleep(60)))"
    )
    child = subprocess.Popen([sys.executable, "-c", code, folder], stdout=subprocess.PIPE)
    assert child.stdout.readline() == b"at work\n"
    child.kill()
    child.wait()
    assert Task.load(folder).begun == "capture"
    assert run_task(folder, commands) == (0, "")
