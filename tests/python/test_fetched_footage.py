# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests on real footage are skipped for want of a network alone."""

import subprocess

import fetched_footage
import pytest


def fetch_ending_with(status, monkeypatch, makes=None):
    def run(command, **_):
        if makes is not None:
            makes.write_bytes(b"footage")
        return subprocess.CompletedProcess(command, status, "", "footage: reason")

    monkeypatch.setattr(fetched_footage.subprocess, "run", run)


def test_footage_that_is_there_is_not_fetched(tmp_path, monkeypatch):
    monkeypatch.setattr(fetched_footage, "FETCH", tmp_path / "none")
    (tmp_path / "a.mp4").write_bytes(b"footage")
    assert fetched_footage.fetched_clip("a.mp4", tmp_path) == tmp_path / "a.mp4"


def test_missing_footage_is_fetched_even_if_another_clips_registry_is_away(tmp_path, monkeypatch):
    fetch_ending_with(3, monkeypatch, makes=tmp_path / "a.mp4")
    assert fetched_footage.fetched_clip("a.mp4", tmp_path).read_bytes() == b"footage"


def test_without_a_network_the_test_is_skipped(tmp_path, monkeypatch):
    fetch_ending_with(3, monkeypatch)
    with pytest.raises(pytest.skip.Exception, match="no registry"):
        fetched_footage.fetched_clip("a.mp4", tmp_path)


def test_a_fetch_that_fails_otherwise_fails_the_test(tmp_path, monkeypatch):
    fetch_ending_with(1, monkeypatch)
    with pytest.raises(AssertionError, match="footage: reason"):
        fetched_footage.fetched_clip("a.mp4", tmp_path)
