# SPDX-License-Identifier: GPL-3.0-or-later
"""Measure how well ARKit's 52 units play on each kind of character of make_characters.py.

What muscles make of each unit, alone and full, is what a character should do; what its own controls
make of that is read from the evaluated mesh. Prints a line a character, over the skin that can be
seen: medians over the units of cosine and gain, the widest gap of lids that blink, and of lips that
muscles keep shut in the worst of those units, in mm; lips that are pressed into each other are
shut, however far muscles press. Of rigs whose bones turn the eyes, how far off those look at most,
to 25 degrees aside and 15 up and down.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parent))

import blender_module
from make_characters import CHARACTERS, at_hand

ACTOR = 11  # on which options were chosen
PARTED = ("lid_upper.L", "lid_upper.R", "jaw_open")  # sources that shut rims, or part them
ASIDE, UP = (-25.0, -10.0, 0.0, 10.0, 25.0), (-15.0, 0.0, 15.0)  # degrees, of gaze
SHUT = 0.5  # mm; lips that are no further apart are shut
NEAR = 0.004  # of a head 0.25 m high: so near lie rims that touch
HEADER = "character     cosine  below .8  gain  lids, mm  lips, mm  52: lids, mm  lips, mm"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", choices=CHARACTERS, nargs="+", default=at_hand())
    parser.add_argument("--actor", type=int, default=ACTOR, help="seed of the actor's identity")
    arguments = parser.parse_args()
    if len(arguments.only) == 1:
        name, actor = arguments.only[0], arguments.actor
        return blender_module.run("measure_characters", lambda _: measure(name, actor))
    print(HEADER, flush=True)
    for name in arguments.only:  # a process each: Blender does not forget a Rigify that was in it
        command = [sys.executable, __file__, "--actor", str(arguments.actor), "--only", name]
        ran = subprocess.run(command, check=False, stdout=subprocess.PIPE, text=True)
        if ran.returncode:
            return ran.returncode
        print(*[line for line in ran.stdout.splitlines() if line.startswith(name)], flush=True)
    return 0


def measure(name: str, actor: int = ACTOR) -> None:
    import bpy
    from mimetic import _core
    from mimetic.template.face_template import load_template

    scene, mesh = bpy.context.scene, CHARACTERS[name]()
    mesh.mimetic.use_contact = False  # else it would be solved for every pose
    surface, made = _made(scene, mesh)
    units = load_template().unit_names
    values = _values(surface, actor)
    wanted = np.tensordot(values, surface.sources, axes=1)
    got = wanted if made is None else made(values)
    polygons = np.asarray(surface.starts).tolist(), np.asarray(surface.corners).tolist()
    areas = _core.seen_areas(surface.points, *polygons)[None, :, None]
    along, whole, own = (
        (areas * a * b).sum(axis=(1, 2)) for a, b in ((got, wanted), (wanted,) * 2, (got,) * 2)
    )
    cosine = along / np.sqrt(np.maximum(whole * own, 1e-30))
    millimetre = 1e3 * _metre(scene, mesh)
    opened = {source: _opened(surface, source, got, wanted) for source in PARTED}
    blinks = [units.index("eyeBlinkLeft"), units.index("eyeBlinkRight")]
    lids = [opened[source][0][row] for source, row in zip(PARTED[:2], blinks, strict=True)]
    over, as_wanted = opened["jaw_open"]
    lips = over[as_wanted * millimetre < SHUT]
    lids, lips = (millimetre * max(values, default=np.nan) for values in (lids, lips))
    print(
        f"{name:12s} {np.median(cosine):7.2f} {(cosine < 0.8).sum():9d} "
        f"{np.median(along / np.maximum(whole, 1e-30)):5.2f} {lids:9.2f} {lips:9.2f} "
        f"{_shape_gaps(scene, mesh)}"
    )
    if surface.gaze is not None:
        print(
            f"{name:12s} eyes look up to {_gaze_error(mesh, surface):.2f} degrees aside of the gaze"
        )


def _gaze_error(mesh, surface) -> float:
    """Degrees that an eyeball's turn is off at most."""
    rigs, eyes, rest = (
        _part(f"scene_out.{part}") for part in ("face_bones", "eye_bones", "rest_pose")
    )
    gaze, between = surface.gaze, _native().controls().gaze_controls.turn_between
    grid = np.array([(yaw, pitch, yaw, pitch) for yaw in ASIDE for pitch in UP])
    own = [channel for channel in rigs.channels(mesh.parent) if channel.name in gaze.names]
    eyeballs, farthest = eyes.Eyeballs(mesh), 0.0
    with rest.held(mesh.parent, mesh):
        before = eyeballs.places()
        for angles, row in zip(grid, gaze.values(grid), strict=True):
            rigs.pose(mesh.parent, own, dict(zip(gaze.names, row, strict=True)))
            places = eyeballs.places()
            for eye in range(2):
                off = between(before[eye], places[eye]) - gaze.turn_of(angles[None], eye)[0]
                farthest = max(farthest, float(np.degrees(np.linalg.norm(off))))
    return farthest


def _made(scene, mesh):
    """The character's surface; and what its own controls make of values of its sources (T x S), T x
    V x 3 of the evaluated mesh, None where muscles' sliders play by themselves."""
    rigs, keys, rest = (
        _part(f"scene_out.{part}") for part in ("face_bones", "own_keys", "rest_pose")
    )
    playing, values = _native().playing(), _part("scene_out.control_values")
    if mesh.parent is not None and mesh.parent.type == "ARMATURE":
        character, surface = mesh.parent, rigs.surface(scene, mesh.parent)
        channels, options = rigs.channels(character), _native().bone_channels().nearest_surface()
    elif keys.own_keys(mesh):
        character, surface, channels, options = mesh, keys.surface(mesh), [], None
    else:
        return keys.surface(mesh), None

    def made(rows):
        fitted = playing.fit_of(surface, options).frames(
            rows, np.zeros((len(rows), len(surface.control_names)))
        )
        shown = []
        with rest.held(character if channels else None, mesh):
            for row in np.vstack([np.zeros_like(fitted[:1]), fitted]):
                values.put(character, dict(zip(surface.control_names, row, strict=True)), channels)
                shown.append(rest.evaluated(mesh))
        return np.array(shown[1:]) - shown[0]

    return surface, made


def _values(surface, actor: int) -> np.ndarray:
    """52 x S: what muscles of the actor do for each unit."""
    from mimetic.template.face_template import load_template

    from evaluation.runs.retarget import Course, activations

    course = Course(np.eye(52), np.arange(52))
    names, acted, _ = activations(load_template(), course, actor)
    rows = np.zeros((52, len(surface.source_names)))
    for name, column in zip(names, acted.T, strict=True):
        if name in surface.source_names:
            rows[:, surface.source_names.index(name)] = column
    return rows


def _pairs(surface) -> dict[str, np.ndarray]:
    """Vertices (K x 2) of one skin that touch with lids shut, and lips that the jaw parts."""
    from mimetic import _core

    reach = NEAR * float(np.ptp(surface.points, axis=0).max()) / 0.25
    piece, pairs = _pieces(surface), {}
    for name in PARTED:
        offsets = surface.sources[surface.source_names.index(name)]
        points = surface.points + offsets * (name != "jaw_open")
        length = np.linalg.norm(offsets, axis=1)
        movers = np.flatnonzero(length > 0.5 * length.max())
        others = np.flatnonzero(length <= 0.5 * length.max())
        nearest = others[_core.nearest(points[movers], points[others])]
        rows = np.stack([movers, nearest], axis=1)
        apart = np.linalg.norm(points[rows[:, 0]] - points[rows[:, 1]], axis=1)
        parted = np.linalg.norm(offsets[rows[:, 0]] - offsets[rows[:, 1]], axis=1)
        is_pair = (apart < reach) & (parted > 0.5 * length.max())
        pairs[name] = rows[is_pair & (piece[rows[:, 0]] == piece[rows[:, 1]])]
    return pairs


def _pieces(surface) -> np.ndarray:
    """V: a number for each piece of the mesh that hangs together."""
    ends = np.append(surface.starts[1:], len(surface.corners))
    first = np.repeat(surface.corners[surface.starts], ends - surface.starts)
    number, before = np.arange(len(surface.points)), None
    while before is None or not np.array_equal(number, before):
        before = number.copy()
        least = np.minimum(number[first], number[surface.corners])
        np.minimum.at(number, first, least)
        np.minimum.at(number, surface.corners, least)
        number = number[number]
    return number


def _opened(surface, source: str, got, wanted) -> tuple[np.ndarray, np.ndarray]:
    """T each: how much further apart than wanted the rims are that a source parts or shuts, at the
    widest place; and how far apart they are wanted at most."""
    rows = _pairs(surface)[source]
    if not len(rows):
        return (np.full(len(got), np.nan),) * 2

    def apart(offsets):
        return offsets[..., rows[:, 0], :] - offsets[..., rows[:, 1], :]

    # Away from each other, from rims that touch
    parted = apart(surface.sources[surface.source_names.index(source)])
    way = (1 if source == "jaw_open" else -1) * parted
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    have, want = ((apart(offsets) * way).sum(axis=2) for offsets in (got, wanted))
    if source == "jaw_open":  # lips touch at rest, and go no further than that
        want = np.maximum(want, 0)
    return np.maximum(have - want, 0).max(axis=1), want.max(axis=1)


def _shape_gaps(scene, mesh) -> str:
    """What the 52 shapes of this head leave open: between lids, between lips."""
    head = _part("heads").bound_head(scene, mesh)
    parts = _native().foreign_face()
    face = parts.attach_face(*head.whole, head.landmarks, head.matrix)
    gaps = face.head.make_units().gaps_mm
    lids = [gaps.get(f"eyeBlink{side}", np.nan) for side in ("Left", "Right")]
    return f"{max(lids):12.2f} {gaps.get('mouthClose', np.nan):9.2f}"


def _metre(scene, mesh) -> float:
    return (scene.unit_settings.scale_length or 1.0) * float(
        np.median(mesh.matrix_world.to_scale())
    )


def _part(name: str):
    import importlib

    return importlib.import_module(f"bl_ext.{blender_module.repository()}.mimetic.{name}")


def _native():
    return _part("native")


if __name__ == "__main__":
    sys.exit(main())
