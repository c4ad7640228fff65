# SPDX-License-Identifier: GPL-3.0-or-later
"""A performance as a file of timed OSC messages, written and read back."""

import dataclasses
import struct

import numpy as np
import pytest
from acting import make_acting
from mimetic import InvalidInput
from mimetic.commands.bake import bake
from mimetic.performance.head_turn import head_turn, quaternion
from mimetic.puppet.osc_file import read_osc, write_osc
from mimetic.retarget.unit_fit import unit_order, unit_values

RISE = np.linspace(0, 1, 5)


@pytest.fixture(scope="module")
def acting():
    performance = make_acting({"jaw_open": RISE, "lid_upper.R": RISE[::-1]})
    pose = performance.head_pose.copy()
    c, s = np.cos(0.3), np.sin(0.3)
    pose[3, :3, :3] = pose[3, :3, :3] @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    return dataclasses.replace(performance, head_pose=pose)


def test_what_is_read_back_is_what_was_written(acting, tmp_path):
    path, out = tmp_path / "performance.npz", tmp_path / "face.osc"
    acting.save(path)
    assert bake(path, out) == "5 frames of 99 OSC messages"
    messages = read_osc(out)
    times = sorted({message.seconds for message in messages})
    np.testing.assert_allclose(times, (acting.frame - 1) / acting.fps, atol=1e-9)
    units = unit_values(acting)
    for i, seconds in enumerate(times):
        frame = [message for message in messages if message.seconds == seconds]
        blends = dict(m.values for m in frame if m.address == "/VMC/Ext/Blend/Val")
        for unit, weight in zip(unit_order(), units[i], strict=True):
            assert blends[unit[0].upper() + unit[1:]] == pytest.approx(weight, abs=1e-6)
        assert blends["jaw_open"] == pytest.approx(RISE[i])
        (head,) = (m.values for m in frame if m.address == "/VMC/Ext/Bone/Pos")
        w, x, y, z = quaternion(head_turn(acting.head_pose[i]))
        np.testing.assert_allclose(head[4:], [x, -y, -z, w], atol=1e-6)
        order = [m.address for m in frame]
        assert order.index("/VMC/Ext/Blend/Apply") > order.index("/VMC/Ext/Blend/Val")


def test_a_bundle_that_is_damaged_is_refused(acting, tmp_path):
    path = tmp_path / "face.osc"
    write_osc(acting, path)
    whole = path.read_bytes()
    for content, message in (
        (whole[:-4], "cut short"),
        (struct.pack("!i", 12) + whole[4:], "of 12 bytes"),
        (struct.pack("!i", -8) + whole[4:], "of -8 bytes"),
        (whole.replace(b"#bundle", b"#bungle", 1), "bundle 1: no OSC bundle"),
        (whole.replace(b",sfffffff", b",sffffffQ", 1), "a value of type 'Q'"),
        (whole[:20] + struct.pack("!i", 4096) + whole[24:], "a message of 4096 bytes"),
        (whole[:3], "bundle 1"),
    ):
        path.write_bytes(content)
        with pytest.raises(InvalidInput, match=message):
            read_osc(path)
