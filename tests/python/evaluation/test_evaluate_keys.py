# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic evaluate keys` counts the keys of performances that are there."""

import json

import pytest
from mimetic import InvalidInput
from mimetic.commands.bake import bake
from mimetic.commands.cli import main
from sample_performance import make_performance


def test_both_ways_are_counted_for_each_clip(tmp_path, capsys):
    make_performance(40).save(tmp_path / "franck.npz")
    command = ["evaluate", "keys", "--performances", str(tmp_path)]
    assert main([*command, "--json"]) == 0
    general, by_phases = json.loads(capsys.readouterr().out)
    assert (general["clip"], general["way"]) == ("franck", "general")
    assert general["frames"] == by_phases["frames"] == 40
    for score in (general, by_phases):
        assert score["share"] == pytest.approx(score["keys"] / (40 * 38))
        assert score["error"] <= 0.02
    assert general["events"] == 0 < by_phases["events"]
    assert main(command) == 0
    assert "franck, by phases" in capsys.readouterr().out


def test_a_folder_without_performances_is_refused(tmp_path, capsys):
    assert main(["evaluate", "keys", "--performances", str(tmp_path)]) == 2
    assert "no performance of cap12_edit" in capsys.readouterr().err


def test_phases_without_few_keys_are_refused(tmp_path):
    with pytest.raises(InvalidInput, match="give --few-keys too"):
        bake(tmp_path / "p.npz", tmp_path / "face.glb", by_phases=True)
