# SPDX-License-Identifier: GPL-3.0-or-later
"""A button is a function call: the same arrays come out of both."""

import threading
from pathlib import Path
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from live_clip import ffmpeg
from panel_texts import drawn
from test_exports import cut


def curve_values(extension, face) -> dict[str, np.ndarray]:
    values = {}
    for block in (face, face.data.shape_keys):
        for curve in extension("compat").curves(block).fcurves:
            keys = np.array([point.co[:] for point in curve.keyframe_points])
            values[f"{curve.data_path}[{curve.array_index}]"] = keys
    return values


def test_load_clip_shows_what_it_loaded(scene, footage):
    assert bpy.ops.mimetic.load_clip(filepath=str(footage)) == {"FINISHED"}
    assert scene.mimetic.clip.size[:] == (400, 300)
    assert scene.active_clip == scene.mimetic.clip
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    assert len(bpy.data.movieclips) == 1


def test_a_dropped_film_is_loaded_without_a_file_browser(scene, footage):
    """What Blender does with the path of a file that is dropped."""
    handler = bpy.types.MIMETIC_FH_clip
    assert footage.suffix in handler.bl_file_extensions.split(";")
    for kind, is_taken in (("CLIP_EDITOR", True), ("VIEW_3D", True), ("TEXT_EDITOR", False)):
        assert handler.poll_drop(SimpleNamespace(area=SimpleNamespace(type=kind))) == is_taken
    assert handler.bl_import_operator == "mimetic.load_clip"
    bpy.ops.mimetic.load_clip("INVOKE_DEFAULT", filepath=str(footage))
    assert scene.mimetic.clip.size[:] == (400, 300)


def test_a_dropped_take_is_loaded(scene, performance_file):
    handler = bpy.types.MIMETIC_FH_performance
    assert performance_file.suffix in handler.bl_file_extensions.split(";")
    assert handler.bl_import_operator == "mimetic.load_performance"
    bpy.ops.mimetic.load_performance("INVOKE_DEFAULT", filepath=str(performance_file))
    assert scene.mimetic.performance_path == str(performance_file)


@pytest.mark.parametrize("content", [b"", b"no film at all" * 100], ids=["empty", "text"])
def test_what_is_no_film_changes_nothing(scene, tmp_path, content):
    path = tmp_path / "film.mp4"
    path.write_bytes(content)
    with pytest.raises(RuntimeError, match=r"film\.mp4"):
        bpy.ops.mimetic.load_clip(filepath=str(path))
    assert scene.mimetic.clip is None
    assert len(bpy.data.movieclips) == 0


def test_a_damaged_performance_changes_nothing(scene, tmp_path, sheet_file):
    damaged = tmp_path / "cut.npz"
    damaged.write_bytes(sheet_file.read_bytes()[:5000])
    with pytest.raises(RuntimeError, match="damaged"):
        bpy.ops.mimetic.load_performance(filepath=str(damaged))
    assert scene.mimetic.performance_path == ""


@pytest.mark.oldest_and_newest
def test_bake_by_operator_is_bake_by_function(
    extension, scene, performance, performance_file, footage
):
    scene.render.fps = 25
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    bpy.ops.mimetic.load_performance(filepath=str(performance_file))
    assert bpy.ops.mimetic.bake() == {"FINISHED"}
    by_operator = curve_values(extension, scene.mimetic.face)
    lens = scene.camera.data.lens
    image = np.array(bpy.data.images["Face Skin"].pixels)

    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    scene = bpy.context.scene
    scene.render.fps = 25
    from mimetic.character.appearance import appearance_of
    from mimetic.character.contact_shapes import contact_shapes

    clip = extension("scene_out").clip.load(scene, str(footage))
    appearance = appearance_of(performance, footage)
    extension("scene_out").bake(
        scene,
        performance,
        "stripes",
        appearance,
        clip,
        contact_shapes=contact_shapes(performance),
    )
    by_function = curve_values(extension, scene.mimetic.face)
    assert by_operator.keys() == by_function.keys()
    for name, keys in by_operator.items():
        np.testing.assert_array_equal(keys, by_function[name])
    assert scene.camera.data.lens == lens
    np.testing.assert_array_equal(image, np.array(bpy.data.images["Face Skin"].pixels))


def test_a_clip_of_another_size_is_refused(scene, performance_file, tmp_path):
    from imageio_ffmpeg import write_frames

    other = tmp_path / "other.mp4"
    writer = write_frames(str(other), (320, 240), fps=25, macro_block_size=1)
    writer.send(None)
    for _ in range(40):
        writer.send(np.zeros((240, 320, 3), np.uint8).tobytes())
    writer.close()
    bpy.ops.mimetic.load_clip(filepath=str(other))
    bpy.ops.mimetic.load_performance(filepath=str(performance_file))
    with pytest.raises(RuntimeError, match="another clip"):
        bpy.ops.mimetic.bake()
    assert scene.mimetic.face is None
    assert len(scene.objects) == 0


def test_the_users_materials_stay_when_baking_again(scene, performance_file):
    bpy.ops.mimetic.load_performance(filepath=str(performance_file))
    bpy.ops.mimetic.bake()
    mine = bpy.data.materials.new("mine")
    scene.mimetic.face.data.materials[0] = mine
    bpy.ops.mimetic.bake()
    assert scene.mimetic.face.data.materials[0] == mine


@pytest.mark.oldest_and_newest
def test_export_writes_what_the_function_writes(extension, scene, bake, performance, tmp_path):
    bake(cut(performance, range(4)), use_texture=True, use_contact=True)
    assert bpy.ops.mimetic.export_gltf(filepath=str(tmp_path / "a")) == {"FINISHED"}
    extension("scene_out.gltf").export(scene, tmp_path / "b.glb")
    assert (tmp_path / "a.glb").read_bytes() == (tmp_path / "b.glb").read_bytes()


def test_export_into_a_missing_folder_or_without_a_name_says_so(sheet_file, tmp_path):
    bpy.ops.mimetic.load_performance(filepath=str(sheet_file))
    bpy.ops.mimetic.bake()
    with pytest.raises(RuntimeError, match="nowhere"):
        bpy.ops.mimetic.export_gltf(filepath=str(tmp_path / "nowhere" / "a.glb"))
    for export in (bpy.ops.mimetic.export_gltf, bpy.ops.mimetic.export_character):
        with pytest.raises(RuntimeError, match="the file has no name"):
            export(filepath=f"{tmp_path}/")
    assert [path.name for path in tmp_path.iterdir() if path.name.startswith(".")] == []


@pytest.mark.newest
def test_stripes_have_no_face(extension, scene, footage, tmp_path):
    brief = tmp_path / "brief.mp4"  # a face is looked for in many frames, in every direction
    ffmpeg("-i", str(footage), "-frames:v", "3", "-c", "copy", str(brief))
    bpy.ops.mimetic.load_clip(filepath=str(brief))
    with pytest.raises(RuntimeError, match="face"):
        bpy.ops.mimetic.find_face()
    assert not extension("scene_in").has_fit(scene.mimetic.clip)


def test_a_run_stops_where_its_work_asks(extension):
    """What the modal operator drives, without its window: progress, a stop, the finished part."""
    jobs = extension("jobs")
    go_on = threading.Event()

    def work(inputs, progress):
        calls = []
        for i in range(inputs):
            go_on.wait(5)
            if not progress(i / inputs, f"frame {i}"):
                break
            calls.append(i)
        return calls

    run = jobs.Run("Capture")
    run.start(work, 1_000_000)
    go_on.set()
    while run.fraction == 0 and not run.is_done():
        pass
    assert "%" in run.text() and "frame" in run.text()
    assert "%" in run.short_text() and "frame" not in run.short_text()
    run.stop.set()
    run.thread.join(5)
    assert run.is_done()
    assert run.error is None
    assert 0 < len(run.result) < 1_000_000


def test_a_run_hands_over_what_went_wrong(extension):
    def work(inputs, progress):
        raise ValueError("bad")

    run = extension("jobs").Run("Capture")
    run.start(work, None)
    run.thread.join(5)
    assert run.is_done()
    assert isinstance(run.error, ValueError)


@pytest.fixture
def pressed(extension, scene):
    """Makes buttons as the window presses them, which is a stand-in, and their context."""
    jobs = extension("jobs")
    manager = SimpleNamespace(
        event_timer_add=lambda *_args, **_kwargs: object(),
        event_timer_remove=lambda _timer: None,
        modal_handler_add=lambda _operator: None,
        mimetic_result="",
    )
    context = SimpleNamespace(
        window=SimpleNamespace(as_pointer=lambda: 1),
        scene=scene,
        mode="OBJECT",
        window_manager=manager,
        workspace=None,
    )
    context.workspace = SimpleNamespace(status_text_set=lambda _text: None)

    class Pressed(jobs.Job):
        """Writes down what it read and which job it is; `gates` hold its work up."""

        bl_label, bl_idname, needs_object_mode = "Job", "MIMETIC_OT_job", False
        written, gates = [], {}

        @classmethod
        def subject(cls, _context):
            return cls.clip

        def read(self, _context):
            return list(self.written)

        def work(self, inputs, progress):
            self.gates[self.clip].wait(10)
            return (inputs, self.clip) if progress(0.5, "") else None

        def write(self, _context, result):
            self.written.append(result[1])
            self.seen = result[0]
            return ""

        def report(self, *_message):
            pass

    def press(clip, label="Job"):
        Pressed.gates.setdefault(clip, threading.Event())
        return type(clip, (Pressed,), {"clip": clip, "bl_label": label})()

    yield press, context, Pressed
    jobs.running = None
    jobs.waiting.clear()


TICK = SimpleNamespace(type="TIMER", value="NOTHING")


def end_of(button, context) -> set[str]:
    while (answer := button.modal(context, TICK)) == {"PASS_THROUGH"}:
        pass
    return answer


def test_a_job_waits_its_turn_behind_one_on_another_clip(extension, pressed, footage):
    jobs, face = extension("jobs"), extension("operators.face").MIMETIC_OT_find_face
    press, context, kind = pressed
    click = SimpleNamespace(type="RIGHTMOUSE", value="PRESS")
    first, second, again = press("first"), press("second"), press("first")
    assert first.invoke(context, None) == {"RUNNING_MODAL"}
    assert again.invoke(context, None) == {"CANCELLED"}  # pressed twice
    assert second.invoke(context, None) == {"RUNNING_MODAL"}
    assert [run.subject for run in jobs.waiting] == ["second"]
    shown = drawn("MIMETIC_PT_capture_view")
    assert "Then: Job, second" in shown and shown.count("mimetic.stop") == 2
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    assert face.poll(bpy.context)  # another clip's
    kind.gates["second"].set()
    assert second.modal(context, TICK) == {"PASS_THROUGH"}  # it has not begun
    assert first.modal(context, click) == {"PASS_THROUGH"}
    kind.gates["first"].set()
    for button in (first, second):
        assert end_of(button, context) == {"FINISHED"}
    assert kind.written == ["first", "second"]
    assert second.seen == []  # read when it was pressed
    assert jobs.running is None and not jobs.waiting


def test_a_job_behind_one_on_its_clip_reads_what_that_one_made(extension, pressed):
    press, context, kind = pressed
    finding, following = press("clip"), press("clip", "Follow")
    assert finding.invoke(context, None) == following.invoke(context, None) == {"RUNNING_MODAL"}
    kind.gates["clip"].set()
    assert end_of(finding, context) == end_of(following, context) == {"FINISHED"}
    assert following.seen == ["clip"]
    assert extension("jobs").running is None


def test_a_job_that_made_nothing_takes_those_behind_it_along(extension, pressed):
    jobs = extension("jobs")
    press, context, kind = pressed
    finding, following, other = press("clip"), press("clip", "Follow"), press("other")
    for button in (finding, following, other):
        assert button.invoke(context, None) == {"RUNNING_MODAL"}
    jobs.running.stop.set()
    for gate in kind.gates.values():
        gate.set()
    assert end_of(finding, context) == end_of(following, context) == {"CANCELLED"}
    assert end_of(other, context) == {"FINISHED"} and kind.written == ["other"]


def test_a_result_waits_until_the_scene_can_take_it(extension, scene, sheet_file, monkeypatch):
    bpy.ops.mimetic.load_performance(filepath=str(sheet_file))
    bpy.ops.mimetic.bake()
    jobs = extension("jobs")
    context = SimpleNamespace(scene=scene, mode="EDIT_MESH")
    run = jobs.running = jobs.Run("Bake")
    try:
        job = jobs.Job()
        job._scene = scene.session_uid
        assert "Object Mode" in job._hindrance(context)
        context.mode = "OBJECT"
        assert job._hindrance(context) == ""
        context.scene = bpy.data.scenes.new("Other")
        assert scene.name in job._hindrance(context)
        scene.name = "sh010"
        assert "sh010" in job._hindrance(context)
        context.scene = scene
        monkeypatch.setattr(extension("playback"), "is_rendering", lambda: True)
        assert "render" in job._hindrance(context)
        run.stop.set()
        assert job._hindrance(context) == ""
    finally:
        jobs.running = None


def test_captures_do_not_overwrite_one_another(extension, tmp_path):
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a.blend"))
    takes = extension("takes")
    first = Path(takes.new_take("clip.mp4").path())
    assert first.parent == tmp_path
    first.touch()
    second = Path(takes.new_take("clip.mp4").path())
    assert second != first
    assert not second.exists()


def test_takes_that_were_begun_side_by_side_are_both_kept(extension, performance, tmp_path):
    """Of clips whose names differ in their endings: neither file is there when they begin."""
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a.blend"))
    takes = extension("takes")
    begun = [takes.new_take(name) for name in ("shot.mp4", "shot.mov")]
    paths = [takes.save(performance, new)[0] for new in begun]
    assert len(set(paths)) == 2 and all(Path(path).is_file() for path in paths)


def test_the_shown_frame_counts_start_and_offset(extension, scene, footage):
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    scene.mimetic.clip.frame_start, scene.mimetic.clip.frame_offset = 11, 5
    scene.frame_set(13)
    assert extension("scene_in").shown_frame(bpy.context) == 8
    assert extension("scene_in").scene_frame(scene.mimetic.clip, 8) == 13
    scene.frame_set(1)
    assert extension("scene_in").shown_frame(bpy.context) == 1


def test_a_bake_is_one_undo_step(scene, sheet_file):
    bpy.ops.mimetic.load_performance(filepath=str(sheet_file))
    bpy.ops.ed.undo_push(message="before")
    assert bpy.ops.mimetic.bake("EXEC_DEFAULT", True) == {"FINISHED"}
    assert "Face" in bpy.data.objects
    bpy.ops.ed.undo()
    assert len(bpy.data.objects) == 0
    assert len(bpy.data.actions) == 0
    assert bpy.context.scene.mimetic.performance_path == str(sheet_file)
    bpy.ops.ed.redo()
    keys = [key.name for key in bpy.context.scene.mimetic.face.data.shape_keys.key_blocks]
    assert len([name for name in keys if not name.startswith("contact")]) == 42 + 21


def test_a_face_in_edit_mode_is_left_alone(scene, sheet_file):
    bpy.ops.mimetic.load_performance(filepath=str(sheet_file))
    bpy.ops.mimetic.bake()
    bpy.context.view_layer.objects.active = scene.mimetic.face
    bpy.ops.object.mode_set(mode="EDIT")
    assert not bpy.ops.mimetic.bake.poll()
    assert not bpy.ops.mimetic.export_gltf.poll()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert bpy.ops.mimetic.bake.poll()


def test_a_hidden_face_is_not_exported_as_nothing(scene, sheet_file):
    bpy.ops.mimetic.load_performance(filepath=str(sheet_file))
    bpy.ops.mimetic.bake()
    scene.mimetic.face.hide_set(True)
    assert not bpy.ops.mimetic.export_gltf.poll()
