# SPDX-License-Identifier: GPL-3.0-or-later
"""A taught set and its page, which appear together."""

import pytest
from mimetic.commands import taught_set
from mimetic.commands.taught_set import page_of, save_set
from mimetic.puppet.templates import TaughtSet
from sample_taught import make_taught


def test_a_set_and_its_page_are_of_one_run_wherever_it_is_stopped(tmp_path, monkeypatch):
    out = tmp_path / "set.npz"
    assert save_set(make_taught(), out) == 0
    (tmp_path / "overlay.mp4").write_bytes(b"of a capture")
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    assert set(before) == {out, page_of(out), tmp_path / "overlay.mp4"}

    def stop(*_):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr(taught_set, "write_taught_page", stop)
        save_set(make_taught(num_near=3), out)
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before
    assert save_set(make_taught(num_near=3), out) == 0
    assert len(TaughtSet.load(out).example_scores) == 9
    assert "9 examples" in page_of(out).read_text(encoding="utf-8")
    assert set(tmp_path.iterdir()) == set(before)


def test_a_link_to_a_set_stays(tmp_path):
    (tmp_path / "sets").mkdir()
    link, target = tmp_path / "link.npz", tmp_path / "sets" / "anna.npz"
    link.symlink_to(target)
    assert save_set(make_taught(), link) == 0
    assert link.is_symlink() and TaughtSet.load(target).looks
    assert page_of(link) == tmp_path / "sets" / "anna.html" and page_of(link).exists()
