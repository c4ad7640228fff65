# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic bake --target` as a table, .csv or .osc: own controls, or ARKit's names."""

import bpy
import numpy as np
import pytest
from test_bake_command import run_bake
from test_face_bones import acting_file, rig  # noqa: F401
from test_own_controls import character, played, save  # noqa: F401

pytestmark = pytest.mark.newest


@pytest.fixture
def target(scene, character, tmp_path) -> str:  # noqa: F811
    save(tmp_path / "rig.blend", scene)
    return f"{tmp_path / 'rig.blend'}:Hero"


def table(path, fps=25.0):
    from mimetic.retarget.face_csv import read_face_csv

    return read_face_csv(path, fps)


def test_a_characters_own_keys_and_their_osc(extension, scene, character, played, target, tmp_path):  # noqa: F811
    from mimetic.performance.document import Performance
    from mimetic.puppet.osc_file import read_osc

    performance = Performance.load(played)
    expected = extension("scene_out.own_controls").play(performance, character)
    ran = run_bake(played, "--out", tmp_path / "a.csv", "--target", target)
    assert ran.returncode == 0, ran.stderr
    assert "5 of 6 controls driven" in ran.stdout
    found = table(tmp_path / "a.csv")
    assert list(found.names[:5]) == expected.names and found.names[5] == "HeadYaw"
    np.testing.assert_allclose(found.values[:, :5], expected.values, atol=1e-6)
    assert np.ptp(found.values[:, 5]) > 0.1  # the head turns

    ran = run_bake(played, "--out", tmp_path / "a.osc", "--target", target)
    assert ran.returncode == 0, ran.stderr
    sent = [m.values for m in read_osc(tmp_path / "a.osc") if m.address.endswith("Blend/Val")]
    assert {name for name, _ in sent} == set(expected.names)
    jaw = [value for name, value in sent if name == "jawOpen"]
    own = expected.values[:, expected.names.index("jawOpen")]
    np.testing.assert_allclose(jaw, own, atol=1e-6)


def test_arkits_names_are_all_there_and_those_that_it_lacks_are_0(played, target, tmp_path):  # noqa: F811
    out = tmp_path / "a.csv"
    ran = run_bake(played, "--out", out, "--target", target, "--names", "arkit")
    assert ran.returncode == 0, ran.stderr
    whole = tmp_path / "whole.csv"
    assert run_bake(played, "--out", whole).returncode == 0
    found, other = table(out), table(whole)
    assert found.names == other.names
    own = found.names.index("JawOpen")
    np.testing.assert_allclose(found.values[:, own], other.values[:, own], atol=1e-6)
    assert not found.values[:, found.names.index("CheekPuff")].any()


def test_bones_and_muscles_have_tables_too(extension, rig, scene, acting_file, tmp_path):  # noqa: F811
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "rig.blend"), check_existing=False)
    out = tmp_path / "a.csv"
    target = f"{tmp_path / 'rig.blend'}:Rig"
    ran = run_bake(acting_file, "--out", out, "--target", target, "--controls", "own")
    assert ran.returncode == 0, ran.stderr
    found = table(out)
    assert np.ptp(found.values[:, found.names.index("brow.L along z")]) > 0.05
    ran = run_bake(acting_file, "--out", out, "--target", f"{tmp_path / 'rig.blend'}:Hero")
    assert ran.returncode == 0, ran.stderr
    found = table(out)
    assert found.values[5, found.names.index("jaw_open")] == pytest.approx(0.7, abs=1e-6)


def test_what_a_table_does_not_hold_is_said(played, target, tmp_path):  # noqa: F811
    ran = run_bake(played, "--out", tmp_path / "a.csv", "--target", target, "--few-keys")
    assert ran.returncode == 2
    assert "leave --footage, --few-keys and --eyes out" in ran.stderr
    ran = run_bake(played, "--out", tmp_path / "a.mp4", "--target", target)
    assert ran.returncode == 2 and "a target is written as .blend" in ran.stderr
    assert not list(tmp_path.glob("a.*"))
