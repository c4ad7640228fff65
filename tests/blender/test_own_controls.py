# SPDX-License-Identifier: GPL-3.0-or-later
"""A performance on the shape keys that a character's maker gave it, and their table."""

import dataclasses
import json

import bpy
import numpy as np
import pytest
from last_result import result
from panel_texts import drawn
from test_bake_command import run_bake

pytestmark = pytest.mark.newest

ALIKE = 0.8  # correlation of a key's curve by its name and by what muscles do
UNITS = ("jawOpen", "mouthSmileLeft", "mouthSmileRight", "eyeBlinkLeft", "browInnerUp")


@pytest.fixture
def character(parts, scene):
    """A head in centimetres with five shape keys of its own, one that is driven, one of hair."""
    from mimetic.character.placement import to_object
    from mimetic.template.face_template import load_template

    template = load_template()
    points, faces, marks = parts
    mesh = bpy.data.meshes.new("Hero")
    mesh.from_pydata(points, [], faces.tolist())
    head = bpy.data.objects.new("Hero", mesh)
    scene.collection.objects.link(head)
    head.scale = (0.01,) * 3
    head.shape_key_add(name="Basis")
    for unit in UNITS:
        offsets = to_object(template.unit_modes[template.unit_names.index(unit)]) / 0.01
        key = head.shape_key_add(name=unit, from_mix=False)
        key.points.foreach_set("co", (points + offsets).astype(np.float32).reshape(-1))
    driven = head.shape_key_add(name="corrective", from_mix=False)
    driven.driver_add("value").driver.expression = "0.25"
    head.shape_key_add(name="Hair", from_mix=False)
    for name, vertex in marks.items():
        head.vertex_groups.new(name=name).add([vertex], 1.0, "REPLACE")
    bpy.context.view_layer.objects.active = head
    bpy.context.view_layer.update()
    return head


@pytest.fixture(scope="session")
def played(acted, tmp_path_factory):
    """The muscles' real motion where the five keys have theirs; its file."""
    from mimetic.character.canonical_head import make_head

    performance = acted[0]
    offsets = {shape.name: shape.offsets for shape in make_head().shapes}
    moving = ("zygomaticus_major", "frontalis_medial", "jaw_open", "lid_upper.L")
    is_muscle, is_bone = (
        [name.startswith(moving) for name in names]
        for names in (performance.muscles, performance.articulators)
    )
    path = tmp_path_factory.mktemp("played") / "hero.npz"
    dataclasses.replace(
        performance,
        activations=performance.activations * is_muscle,
        articulator_values=np.abs(performance.articulator_values) * is_bone,
        muscle_modes=np.stack([offsets[name] for name in performance.muscles]).astype(np.float32),
        articulator_modes=np.stack([offsets[name] for name in performance.articulators]).astype(
            np.float32
        ),
    ).save(path)
    return path


def save(path, scene) -> None:
    scene.render.fps = 25
    bpy.ops.wm.save_as_mainfile(filepath=str(path), check_existing=False)


def key_curves(extension, head) -> dict[str, np.ndarray]:
    curves = extension("compat").curves(head.data.shape_keys).fcurves
    return {
        curve.data_path.split('"')[1]: np.array([p.co[1] for p in curve.keyframe_points])
        for curve in curves
    }


def test_known_names_play_the_face_and_the_object_its_head(
    extension,
    scene,
    character,
    played,
    tmp_path,
):
    before = bpy.data.actions.new("Walk")
    character.animation_data_create().action = before
    before.use_fake_user = True
    save(tmp_path / "rig.blend", scene)
    out = tmp_path / "out.blend"
    ran = run_bake(played, "--out", out, "--target", f"{tmp_path / 'rig.blend'}:Hero")
    assert ran.returncode == 0, ran.stderr
    assert "5 of 6 controls driven" in ran.stdout
    assert "unmatched: Hair" in ran.stdout
    bpy.ops.wm.open_mainfile(filepath=str(out))
    head = bpy.data.objects["Hero"]
    curves = key_curves(extension, head)
    assert set(curves) == set(UNITS)
    assert all(np.ptp(values) > 0.05 for values in curves.values())
    assert all(values.min() >= 0 and values.max() <= 1 for values in curves.values())
    assert head.data.shape_keys.animation_data.action.name == "hero controls"
    assert len(head.data.shape_keys.animation_data.drivers) == 1
    assert head.animation_data.action.name == "hero head"
    assert "Walk" in bpy.data.actions


def test_a_preset_is_heeded_by_the_command(extension, scene, character, played, tmp_path):
    save(tmp_path / "rig.blend", scene)
    row = {"control": "jawOpen", "gain": 0.5, "highest": 0.3}
    preset = {"format": "mimetic controls 1", "controls": [row]}
    (tmp_path / "hero.json").write_text(json.dumps(preset))
    out, target = tmp_path / "out.blend", f"{tmp_path / 'rig.blend'}:Hero"
    given = ("--target", target, "--preset", tmp_path / "hero.json")
    ran = run_bake(played, "--out", out, *given)
    assert ran.returncode == 0, ran.stderr
    bpy.ops.wm.open_mainfile(filepath=str(out))
    curves = key_curves(extension, bpy.data.objects["Hero"])
    assert curves["jawOpen"].max() == pytest.approx(0.3)
    assert set(curves) == set(UNITS)
    for wrong, said in (
        ({}, "not a preset of controls"),
        (preset | {"controls": [{"control": "jawopen"}]}, "Hero has none of the preset's controls"),
    ):
        (tmp_path / "hero.json").write_text(json.dumps(wrong))
        ran = run_bake(played, "--out", out, *given)
        assert ran.returncode == 2
        assert said in ran.stderr


def test_a_presets_strangers_are_said_and_it_is_refused_where_muscles_play(
    extension, scene, character, acted, tmp_path
):
    preset = {"format": "mimetic controls 1", "controls": [{"control": "jawOpen"}]}
    preset["controls"] += [{"control": "jawopen"}]
    path = tmp_path / "hero.json"
    path.write_text(json.dumps(preset))
    own_controls = extension("scene_out.own_controls")
    played = own_controls.play(acted[0], character, str(path))
    assert "of the preset alone: jawopen" in played.summary()
    with pytest.raises(ValueError, match="no controls that a preset is for"):
        own_controls.check_no_preset(character, str(path))
    bpy.ops.mimetic.add_face()
    rig, name = tmp_path / "rig.blend", bpy.context.active_object.name
    save(rig, scene)
    settings = {"bone": "", "neck": "", "neck_share": 0.3, "smoothing": 1.0, "preset": str(path)}
    write = extension("scene_out.rig_file").write
    for out in ("out.blend", "out.npz"):
        with pytest.raises(ValueError, match="played by its muscles, which no preset is for"):
            write(acted[1], str(tmp_path / out), str(rig), name, settings)
        assert not (tmp_path / out).exists()


def test_changed_names_play_the_same_through_muscles(
    extension,
    scene,
    character,
    played,
    tmp_path,
):
    save(tmp_path / "named.blend", scene)
    assert bpy.ops.mimetic.attach_muscles() == {"FINISHED"}
    for number, unit in enumerate(UNITS):
        character.data.shape_keys.key_blocks[unit].name = f"expr_{number}"
    save(tmp_path / "changed.blend", scene)
    curves = {}
    for name, controls in (("named", "auto"), ("changed", "own")):
        out = tmp_path / f"{name}.out.blend"
        target = f"{tmp_path / name}.blend:Hero"
        ran = run_bake(played, "--out", out, "--target", target, "--controls", controls)
        assert ran.returncode == 0, ran.stderr
        bpy.ops.wm.open_mainfile(filepath=str(out))
        curves[name] = key_curves(extension, bpy.data.objects["Hero"])
    assert "of the face's motion explained" in ran.stdout
    for number, unit in enumerate(UNITS):
        named, fitted = curves["named"][unit], curves["changed"][f"expr_{number}"]
        assert np.corrcoef(named, fitted)[0, 1] > ALIKE, unit


@pytest.mark.parametrize(
    ("change", "arguments", "message"),
    [
        (lambda head: None, ["--controls", "muscles"], "Hero has no muscles"),
        (lambda head: head.shape_key_clear(), ["--controls", "own"], "no shape keys of its own"),
        (
            lambda head: setattr(head.data.shape_keys, "use_relative", False),
            ["--controls", "own"],
            "shape keys are absolute",
        ),
    ],
)
def test_what_cannot_be_played_is_said_in_one_line(
    scene,
    character,
    played,
    tmp_path,
    change,
    arguments,
    message,
):
    change(character)
    save(tmp_path / "rig.blend", scene)
    target = f"{tmp_path / 'rig.blend'}:Hero"
    ran = run_bake(played, "--out", tmp_path / "out.blend", "--target", target, *arguments)
    assert ran.returncode == 2
    assert message in ran.stderr
    assert len(ran.stderr.strip().splitlines()) == 1
    assert not (tmp_path / "out.blend").exists()


@pytest.fixture
def loaded(character, played, scene):
    scene.render.fps = 25
    bpy.ops.mimetic.load_performance(filepath=str(played))
    return character


def test_few_keys_play_nearly_the_same(extension, loaded):
    assert bpy.ops.mimetic.bake_controls() == {"FINISHED"}
    dense = key_curves(extension, loaded)
    assert bpy.ops.mimetic.bake_controls(use_few_keys=True, tolerance=0.05) == {"FINISHED"}
    assert loaded.mimetic.takes[-1].settings == "own controls, few keys within 0.05"
    few = extension("compat").curves(loaded.data.shape_keys).fcurves
    assert sum(len(c.keyframe_points) for c in few) < 0.5 * sum(map(len, dense.values()))
    for curve in few:
        values = dense[curve.data_path.split('"')[1]]
        first = curve.keyframe_points[0].co[0]
        actual = [curve.evaluate(first + i) for i in range(len(values))]
        np.testing.assert_allclose(actual, values, atol=0.06)


def row(character, name: str):
    return character.mimetic.controls[name]


def test_bake_to_character_is_the_commands(extension, loaded):
    assert bpy.ops.mimetic.bake_controls() == {"FINISHED"}
    made = result()
    assert made["driven"] == list(UNITS)
    assert made["unmatched"] == ["Hair"]
    assert made["explained"] is None  # no muscles: by their names
    curves = key_curves(extension, loaded)
    assert set(curves) == set(UNITS)
    assert [entry.name for entry in loaded.mimetic.controls] == [*UNITS, "Hair"]
    assert loaded.animation_data.action.name == "hero head"


def test_a_bake_to_the_character_edits_curves_and_is_a_take(extension, loaded):
    assert bpy.ops.mimetic.bake_controls() == {"FINISHED"}
    before = {name: values.max() for name, values in key_curves(extension, loaded).items()}
    assert bpy.ops.mimetic.bake_controls(exaggeration=0.5) == {"FINISHED"}
    after = {name: values.max() for name, values in key_curves(extension, loaded).items()}
    assert after["jawOpen"] == pytest.approx(0.5 * before["jawOpen"], rel=0.1), (before, after)
    rows = [(row.name, row.settings) for row in loaded.mimetic.takes]
    assert rows == [
        ("hero", "own controls, a key a frame"),
        ("hero.002", "own controls, a key a frame, exaggerated by 0.5"),
    ]
    assert bpy.ops.mimetic.play_take(take="hero") == {"FINISHED"}
    again = {name: values.max() for name, values in key_curves(extension, loaded).items()}
    assert again == before


def test_the_table_is_heeded_and_survives_a_refit(extension, loaded):
    assert bpy.ops.mimetic.fit_controls() == {"FINISHED"}
    assert not any(entry.is_edited for entry in loaded.mimetic.controls)
    row(loaded, "jawOpen").gain = 0.5
    row(loaded, "eyeBlinkLeft").is_on = False
    row(loaded, "browInnerUp").highest = 0.2
    assert [e.name for e in loaded.mimetic.controls if e.is_edited] == [
        "jawOpen",
        "eyeBlinkLeft",
        "browInnerUp",
    ]
    bpy.ops.mimetic.bake_controls(use_head_motion=False)
    edited = key_curves(extension, loaded)
    assert "eyeBlinkLeft" not in edited
    assert edited["browInnerUp"].max() == pytest.approx(0.2)
    assert loaded.animation_data is None
    assert row(loaded, "jawOpen").gain == 0.5
    bpy.ops.mimetic.fit_controls(reset_edits=True)
    bpy.ops.mimetic.bake_controls()
    plain = key_curves(extension, loaded)
    np.testing.assert_allclose(2 * edited["jawOpen"], plain["jawOpen"], atol=1e-5)
    assert len([a for a in bpy.data.actions if a.name.startswith("hero controls")]) == 2


def test_an_edited_row_waits_for_a_key_that_is_renamed(extension, loaded):
    assert bpy.ops.mimetic.fit_controls() == {"FINISHED"}
    row(loaded, "jawOpen").gain = 0.5
    keys = loaded.data.shape_keys.key_blocks
    keys["jawOpen"].name = "Gape"
    assert bpy.ops.mimetic.fit_controls() == {"FINISHED"}
    assert "whose edited rows wait: jawOpen" in result()["message"]
    assert loaded.mimetic.controls[-1].name == "jawOpen"
    assert row(loaded, "jawOpen").remark == "no control of this name now"
    bpy.ops.mimetic.bake_controls(use_head_motion=False)
    assert "whose edited rows wait: jawOpen" in result()["message"]
    keys["Gape"].name = "jawOpen"
    assert bpy.ops.mimetic.fit_controls() == {"FINISHED"}
    assert "wait" not in result()["message"]
    assert row(loaded, "jawOpen").gain == 0.5
    keys["jawOpen"].name = "Gape"
    bpy.ops.mimetic.fit_controls(reset_edits=True)
    assert "jawOpen" not in loaded.mimetic.controls


def test_a_key_that_is_switched_off_keeps_nothing_of_the_bake_before(extension, loaded, scene):
    bpy.ops.mimetic.bake_controls(use_head_motion=False)
    scene.frame_set(20)
    assert key_curves(extension, loaded)["eyeBlinkLeft"].max() > 0.05
    bpy.ops.mimetic.fit_controls()
    row(loaded, "eyeBlinkLeft").is_on = False
    bpy.ops.mimetic.bake_controls(use_head_motion=False)
    assert set(key_curves(extension, loaded)) == set(UNITS) - {"eyeBlinkLeft"}
    assert loaded.data.shape_keys.key_blocks["eyeBlinkLeft"].value == 0


def test_an_end_of_a_range_takes_the_other_along(loaded, tmp_path):
    bpy.ops.mimetic.fit_controls()
    jaw, path = row(loaded, "jawOpen"), tmp_path / "hero.json"
    jaw.highest = 0.2
    jaw.lowest = 0.8
    assert jaw.highest == jaw.lowest == pytest.approx(0.8)
    jaw.highest = -0.5
    assert jaw.highest == jaw.lowest == -0.5
    assert jaw.is_edited
    assert bpy.ops.mimetic.save_controls(filepath=str(path)) == {"FINISHED"}
    assert bpy.ops.mimetic.load_controls(filepath=str(path)) == {"FINISHED"}
    assert row(loaded, "jawOpen").lowest == -0.5


PRESETS = (("save", bpy.ops.mimetic.save_controls), ("load", bpy.ops.mimetic.load_controls))


def test_rows_are_mirrored_and_kept_as_a_preset(loaded, tmp_path):
    bpy.ops.mimetic.fit_controls()
    row(loaded, "mouthSmileLeft").gain = 1.5
    bpy.ops.mimetic.mirror_controls()
    assert row(loaded, "mouthSmileRight").gain == 1.5
    assert result()["message"] == "1 row changed"
    path = tmp_path / "hero.json"
    with pytest.raises(RuntimeError, match="the file has no name"):
        bpy.ops.mimetic.save_controls(filepath=f"{tmp_path}/")
    bpy.ops.mimetic.save_controls(filepath=str(path))
    assert list(tmp_path.iterdir()) == [path]
    # By this property Blender's file browser asks before it writes over a file
    asks = {name: "check_existing" in kind.get_rna_type().properties for name, kind in PRESETS}
    assert asks == {"save": True, "load": False}
    bpy.ops.mimetic.fit_controls(reset_edits=True)
    assert row(loaded, "mouthSmileRight").gain == 1.0
    loaded.data.shape_keys.key_blocks["Hair"].name = "Fur"
    bpy.ops.mimetic.load_controls(filepath=str(path))
    assert result()["left_out"] == ["Hair"]
    assert row(loaded, "mouthSmileRight").gain == 1.5
    path.write_text("{}")
    with pytest.raises(RuntimeError, match="not a preset"):
        bpy.ops.mimetic.load_controls(filepath=str(path))
    assert row(loaded, "mouthSmileRight").gain == 1.5


def test_the_panel_shows_the_table_or_why_there_is_none(loaded):
    bpy.ops.mimetic.fit_controls()
    shown = drawn("MIMETIC_PT_controls")
    assert "MIMETIC_UL_controls" in shown
    assert "ARKit: 1 jawOpen" in shown
    loaded.data.shape_keys.use_relative = False
    assert "shape keys are absolute" in " ".join(drawn("MIMETIC_PT_controls").split())
    assert not bpy.ops.mimetic.bake_controls.poll()


def test_a_key_removed_meanwhile_is_said(extension, loaded):
    own_controls = extension("scene_out.own_controls")
    performance = (
        extension("native")
        .performances()
        .Performance.load(bpy.path.abspath(bpy.context.scene.mimetic.performance_path))
    )
    fitted = own_controls.play(performance, loaded)
    loaded.shape_key_remove(loaded.data.shape_keys.key_blocks["jawOpen"])
    with pytest.raises(ValueError, match="no shape key jawOpen any more"):
        own_controls.bake(bpy.context.scene, performance, "hero", loaded, fitted)
    assert loaded.data.shape_keys.animation_data.action is None
