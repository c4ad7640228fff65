# SPDX-License-Identifier: GPL-3.0-or-later
"""What is sent is read back on a local socket and compared."""

import dataclasses
import socket
import struct

import numpy as np
import pytest
from acting import make_acting
from mimetic import InvalidInput, UnreadableMedia
from mimetic.performance.gaze import GAZE
from mimetic.puppet.live_face import canonical_anatomy, live_names
from mimetic.puppet.live_filter import LiveState
from mimetic.puppet.live_units import live_units
from mimetic.puppet.receiver import Receiver, parse_address
from mimetic.retarget.unit_fit import unit_order, unit_values


@pytest.fixture(scope="module")
def names():
    return live_names()


@pytest.fixture
def listener():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as heard:
        heard.bind(("127.0.0.1", 0))
        heard.settimeout(5)
        yield heard


def state_of(names, turn=None, **values):
    row = np.zeros(len(names))
    for name, value in values.items():
        row[names.index(name.replace("__", "."))] = value
    pose = np.eye(4)
    pose[:3, :3] = np.diag([1.0, -1, -1]) @ (np.eye(3) if turn is None else turn)
    return LiveState(1.5, pose, row, np.zeros(len(row)), 1.0, False, True, 0.0, np.eye(6))


def turned(axis, degrees):
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    others = [i for i in range(3) if i != axis]
    rotation = np.eye(3)
    rotation[np.ix_(others, others)] = [[c, -s], [s, c]] if axis != 1 else [[c, s], [-s, c]]
    return rotation


def osc_messages(packet):
    assert packet[:8] == b"#bundle\0" and len(packet) % 4 == 0
    messages, at = [], 16
    while at < len(packet):
        (size,) = struct.unpack_from("!i", packet, at)
        messages.append(osc_message(packet[at + 4 : at + 4 + size]))
        at += 4 + size
    return messages


def osc_message(body):
    def text(at):
        end = body.index(b"\0", at)
        return body[at:end].decode(), end + 4 - end % 4

    address, at = text(0)
    tags, at = text(at)
    values = []
    for tag in tags[1:]:
        if tag == "s":
            value, at = text(at)
        else:
            (value,) = struct.unpack_from("!" + tag, body, at)
            at += 4
        values.append(value)
    assert at == len(body)
    return address, values


def sent(listener, scheme, names, state):
    receiver = Receiver(f"{scheme}://127.0.0.1:{listener.getsockname()[1]}", names, 30)
    receiver.send(state)
    receiver.close()
    assert receiver.num_failed == 0
    packets = [listener.recv(65536)]
    listener.settimeout(0.3)
    try:
        while True:
            packets.append(listener.recv(65536))
    except TimeoutError:
        return packets


def test_osc_carries_shapes_muscles_and_the_head(listener, names):
    state = state_of(names, turned(1, 30), zygomaticus_major__L=0.4, jaw_open=0.25)
    packets = sent(listener, "osc", names, state)
    assert all(len(packet) <= 1400 for packet in packets)
    messages = [message for packet in packets for message in osc_messages(packet)]
    blends = {values[0]: values[1] for address, values in messages if address.endswith("Blend/Val")}
    assert blends["MouthSmileLeft"] > 0.15 and blends["MouthSmileRight"] < 0.02
    assert blends["JawOpen"] == pytest.approx(0.25, abs=0.03)
    assert blends["jaw_open"] == pytest.approx(0.25)
    assert blends["zygomaticus_major.L"] == pytest.approx(0.4)
    assert len(blends) == 52 + len(names) - len(GAZE)
    addresses = [address for address, _ in messages]
    assert addresses.index("/VMC/Ext/Blend/Apply") > max(
        i for i, address in enumerate(addresses) if address == "/VMC/Ext/Blend/Val"
    )
    head = next(values for address, values in messages if address == "/VMC/Ext/Bone/Pos")
    # To the subject's left: for an avatar that looks along z with y up, left-handed, about -y
    half = np.radians(15)
    np.testing.assert_allclose(head[1:], [0, 0, 0, 0, -np.sin(half), 0, np.cos(half)], atol=1e-6)


def livelink(packet):
    """As Unreal's plug-in reads it."""
    (version,) = struct.unpack_from("<i", packet)
    device = packet[4:41].decode()
    (length,) = struct.unpack_from("!i", packet, 41)
    subject, at = packet[45 : 45 + length].decode(), 45 + length
    frame, part, fps, denominator, count = struct.unpack_from("!if2ib", packet, at)
    values = struct.unpack_from(f"!{count}f", packet, at + 17)
    assert at + 17 + 4 * count == len(packet)
    assert (version, subject, count, fps, denominator) == (6, "Mimetic", 61, 30, 1)
    assert device[0] == "$" and frame >= 0 and 0 <= part < 1
    return np.array(values)


def test_livelink_carries_61_numbers(listener, names):
    values = {"lid_upper__R": 1.0, "gaze_yaw__L": 15.0, "gaze_pitch__R": -10.0, "jaw_side": -0.5}
    (packet,) = sent(listener, "livelink", names, state_of(names, **values))
    numbers = livelink(packet)
    weights = dict(zip(unit_order(), numbers, strict=False))
    assert weights["eyeBlinkRight"] == 1 and weights["eyeBlinkLeft"] == 0
    # As far as the sliders of a head look: 35 degrees sideways, 30 down
    assert weights["eyeLookOutLeft"] == pytest.approx(15 / 35) and weights["eyeLookInLeft"] == 0
    assert weights["eyeLookDownRight"] == pytest.approx(1 / 3) and weights["eyeLookUpRight"] == 0
    assert weights["jawRight"] > 0.3 and weights["jawLeft"] == 0
    np.testing.assert_allclose(
        numbers[52:], [0, 0, 0, np.radians(15), 0, 0, 0, np.radians(10), 0], atol=1e-6
    )


@pytest.mark.parametrize(("axis", "number"), [(1, 0), (0, 1), (2, 2)])
def test_livelink_turns_the_head_about_arkits_axes(listener, names, axis, number):
    (packet,) = sent(listener, "livelink", names, state_of(names, turned(axis, 20)))
    expected = np.zeros(3)
    expected[number] = np.radians(20)
    np.testing.assert_allclose(livelink(packet)[52:55], expected, atol=1e-6)


def test_every_value_shows_in_some_unit(names):
    rows = np.concatenate([np.eye(len(names)), -np.eye(len(names))])
    rows[:, [names.index(name) for name in GAZE]] *= 20  # degrees
    weights = live_units().weights(rows)
    moved = (weights > 0.02).any(axis=1).reshape(2, -1).any(axis=0)
    assert [name for name, moves in zip(names, moved, strict=True) if not moves] == []


def test_what_is_sent_live_is_what_a_table_has(names):
    """One map for both: the same state, by its head's own modes, as a frame of a performance."""
    values = {"jaw_open": 0.6, "zygomaticus_major.L": 0.8, "lid_upper.R": 0.4, "mentalis.R": 0.5}
    row = np.zeros(len(names))
    for name, value in values.items():
        row[names.index(name)] = value
    live = live_units().weights(row[None])[0]
    anatomy = canonical_anatomy()
    count = len(anatomy.muscle_names)
    acting = make_acting({"jaw_open": np.zeros(1)})
    performance = dataclasses.replace(
        acting,
        muscles=list(anatomy.muscle_names),
        muscle_modes=anatomy.muscle_modes,
        activations=row[None, :count],
        articulators=list(anatomy.articulator_names),
        articulator_modes=anatomy.articulator_modes,
        articulator_values=row[None, count:-4],
    )
    np.testing.assert_allclose(unit_values(performance)[0], live, atol=0.02)


@pytest.mark.parametrize(
    "address",
    [
        "http://a:1",
        "osc://host",
        "osc://:99",
        "osc://host:0",
        "osc://host:99999",
        "osc://h:1/x",
        "",
    ],
)
def test_what_is_no_address_is_refused(address):
    with pytest.raises(InvalidInput, match="osc://HOST:PORT or livelink://HOST:PORT"):
        parse_address(address)


def test_a_host_that_is_not_known_is_said(names):
    with pytest.raises(UnreadableMedia, match="is not known"):
        Receiver("osc://no-such-host.invalid:39539", names, 30)


@pytest.mark.parametrize("has_both", [True, False])
def test_a_host_of_two_addresses_is_reached_on_its_old_one(names, monkeypatch, has_both):
    kind = (socket.SOCK_DGRAM, 0, "")
    new = (socket.AF_INET6, *kind, ("::1", 39539, 0, 0))
    old = (socket.AF_INET, *kind, ("127.0.0.1", 39539))
    found = [new, old] if has_both else [new]
    monkeypatch.setattr(socket, "getaddrinfo", lambda *_, **__: found)
    monkeypatch.setattr(socket, "socket", FakeSocket)
    receiver = Receiver("osc://localhost:39539", names, 30)
    receiver.send(state_of(names))
    receiver.close()
    assert set(receiver._socket.sent) == {(found[-1][0], found[-1][-1])}


class FakeSocket:
    def __init__(self, family, *_):
        self.family, self.sent = family, []

    def setblocking(self, _): ...

    def sendto(self, _, target):
        self.sent.append((self.family, target))

    def close(self): ...


def test_nobody_who_listens_is_no_failure(names):
    receiver = Receiver("osc://127.0.0.1:9", names, 30)
    for _ in range(5):
        receiver.send(state_of(names))
    receiver.close()
