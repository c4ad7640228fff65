# SPDX-License-Identifier: GPL-3.0-or-later
"""ARKit's 52 shapes on any head: MakeHuman's sculpted face units carried over by its bound skin.

What lids and eyes do is the head's own, since that knows where its eyeballs are; teeth and tongue
follow the jaw rigidly. Then lids and lips are closed where a shape says so. Displacements
are in the registered template's frame and size.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimetic import _core
from mimetic.muscles.anatomy import SIDES
from mimetic.muscles.articulators import EyeFrame
from mimetic.muscles.contact import lid_slit, lip_slit
from mimetic.skin.mesh import SkinMesh, canonical_skin, multiply

SIDE_WORDS = dict(zip(SIDES, ("Left", "Right"), strict=True))
# What the head's own lids and gaze do: name -> theirs
OWN = {
    **{
        f"eyeLook{way.title()}{word}": f"look_{way}.{side}"
        for way in ("up", "down", "in", "out")
        for side, word in SIDE_WORDS.items()
    },
    **{f"eyeBlink{word}": f"lid_upper.{side}" for side, word in SIDE_WORDS.items()},
}
# Bone does not turn with the skin over it, and what mouthClose takes back is the jaw's
STRAIGHT = ("jawOpen", "jawForward", "jawLeft", "jawRight", "mouthClose")
NUM_PAIRS = 24  # of points across a slit
LID_REACH, LIP_REACH = 0.010, 0.020  # m along the skin
UPPER_LID_SHARE = 0.9  # of what is left between closed lids
NEAR_RIM = 0.003  # m from the template's rim; farther off the head has no such rim


@dataclass(frozen=True)
class BoundSkin:
    """What face units need of a head that the template is registered to.

    vertices: N x 3 of its skin; surface: of all its triangles (T x 3); places: of them on the
    template's refined skin; onto: places on the skin of points by vertices of the template; spread:
    M x N x 3 of the skin to M x V x 3 of the head; read: N, a vertex of the head at each of the
    skin's; on_jaw: V, which are teeth or tongue; eyes: left and right, the head's own eyeballs.
    """

    template_mesh: SkinMesh
    vertices: NDArray[np.float64]
    triangles: NDArray[np.int32]
    surface: _core.MuscleSurface
    places: _core.SkinPlaces
    onto: Callable[[ArrayLike, NDArray[np.float64]], _core.SkinPlaces]
    spread: Callable[[NDArray[np.float64]], NDArray[np.float64]]
    head_vertices: NDArray[np.float64]
    read: NDArray[np.int64]
    on_jaw: NDArray[np.bool_]
    eyes: list[tuple[EyeFrame, _core.EyeSurface]]
    is_sealed: bool


@dataclass(frozen=True)
class FaceUnits:
    """names: 52 in ARKit's spelling; modes: 52 x V x 3, metres at value 1; gaps_mm: the widest
    between lids of each closed eye and between lips with open jaw and mouthClose, those left out
    that are one surface; depths_mm: the deepest of the lids in each eyeball, in a blink; notes."""

    names: tuple[str, ...]
    modes: NDArray[np.float64]
    gaps_mm: dict[str, float]
    depths_mm: dict[str, float]
    notes: tuple[str, ...]


def face_units(skin: BoundSkin, own_modes: Mapping[str, NDArray[np.float64]]) -> FaceUnits:
    """The 52 shapes of a head, in the registered template's frame.

    own_modes: V x 3 at value 1 of lids and gaze, by name.
    """
    template = skin.template_mesh.template
    names = tuple(str(name) for name in template.unit_names)
    carry = _Carrier(skin)
    modes = {}
    for name, unit in zip(names, template.unit_modes, strict=True):
        if name in OWN:
            modes[name] = own_modes[OWN[name]]
        elif name == "tongueOut":
            modes[name] = _tongue(skin, unit)
        else:
            modes[name] = skin.spread(carry(unit, name in STRAIGHT)[None])[0]
        if name.startswith("jaw"):
            _follow_jaw(skin, unit, modes[name])
    gaps, depths = {}, {}
    notes: tuple[str, ...] = ()
    for frame, eye in skin.eyes:
        word = SIDE_WORDS[frame.side]
        blink, slit = f"eyeBlink{word}", _lid_slit(skin, frame)
        if slit is None:
            notes += (
                f"the {word.lower()} lids have no opening of their own: {blink} cannot close them",
            )
            continue
        modes[blink], gaps[blink] = _closed(
            skin, modes[blink], slit, (UPPER_LID_SHARE, LID_REACH, False, eye)
        )
        at_skin = np.ascontiguousarray(modes[blink][skin.read])
        depths[blink] = 1e3 * _core.largest_depth(skin.surface, at_skin, slit, eye, LID_REACH)
    if skin.is_sealed:
        notes += ("the lips are one surface: mouthClose takes back what jawOpen does to them",)
    else:
        open_jaw = modes["jawOpen"]
        shut = open_jaw + modes["mouthClose"]
        shut, gaps["mouthClose"] = _closed(skin, shut, _lip_slit(skin), (0.5, LIP_REACH, True))
        modes["mouthClose"] = shut - open_jaw
    if not skin.on_jaw.any():
        notes += ("no teeth or tongue of the lower jaw were found: tongueOut moves nothing",)
    return FaceUnits(names, np.stack([modes[name] for name in names]), gaps, depths, notes)


class _Carrier:
    """Displacements of the template's control vertices, carried to a head's skin."""

    def __init__(self, skin: BoundSkin):
        mesh = skin.template_mesh
        canonical = canonical_skin(mesh.template)
        self._skin, self._stencils = skin, mesh.stencils
        self._count = int(mesh.template.num_skin_vertices)
        self._maps = _core.surface_maps(canonical.vertices, mesh.vertices, mesh.triangles)

    def __call__(self, unit: NDArray[np.float64], is_straight: bool) -> NDArray[np.float64]:
        """V' x 3 of the template to N x 3 of the head's skin; straight: not turned or stretched."""
        fine = multiply(self._stencils, np.asarray(unit[: self._count], np.float64))
        carried = fine if is_straight else _core.carried_by(self._maps, fine)
        return self._skin.places.values(carried)


def _closed(
    skin: BoundSkin,
    mode: NDArray[np.float64],
    slit: _core.SlitPlaces,
    how: tuple[float, float, bool] | tuple[float, float, bool, _core.EyeSurface],
) -> tuple[NDArray[np.float64], float]:
    """A mode with a slit closed, and the widest gap that is left, mm. how: the upper rim's share,
    the reach, whether the gap at rest is kept, and an eyeball."""
    rows = skin.read
    before = np.ascontiguousarray(mode[rows])
    after = _core.close_slit(skin.surface, before, slit, *how)
    closed = mode + skin.spread((after - before)[None])[0]
    gaps = _core.rim_gaps(skin.vertices, np.ascontiguousarray(closed[rows]), slit)
    keeps_gap = how[2]
    if keeps_gap:
        gaps = gaps - _core.rim_gaps(skin.vertices, np.zeros_like(skin.vertices), slit)
    return closed, 1e3 * float(gaps.max(initial=0.0))


def _lid_slit(skin: BoundSkin, frame: EyeFrame) -> _core.SlitPlaces | None:
    """The rims of an eye's lids as the head has them; None where it has none, as lids that are one
    surface."""
    mesh, side = skin.template_mesh, frame.side
    rims = lid_slit(mesh, side)
    corners = [mesh.landmark(f"eye_{end}.{side}") for end in ("inner", "outer")]
    upper, lower = mesh.vertices[np.asarray(rims.upper)], mesh.vertices[np.asarray(rims.lower)]
    pairs = _core.rim_pairs(upper, lower, mesh.vertices[corners], NUM_PAIRS)
    if _core.are_joined(skin.surface, *pairs):
        return None
    own = _core.lid_rims(frame, skin.vertices, skin.triangles, *pairs)
    return own if len(own.upper.corners) > NUM_PAIRS // 2 else None


def _lip_slit(skin: BoundSkin) -> _core.SlitPlaces:
    """All that touches between the lips: each point of either, and the nearest of the other."""
    mesh = skin.template_mesh
    band = lip_slit(mesh, is_refined=False)
    upper, lower = np.asarray(band.upper), np.asarray(band.lower)
    below = lower[_core.nearest(mesh.vertices[upper], mesh.vertices[lower])]
    above = upper[_core.nearest(mesh.vertices[lower], mesh.vertices[upper])]
    sides = np.concatenate([upper, above]), np.concatenate([below, lower])
    return _near_places(skin, *((side, mesh.vertices[side]) for side in sides))


def _near_places(
    skin: BoundSkin, *sides: tuple[NDArray[np.int64], NDArray[np.float64]]
) -> _core.SlitPlaces:
    """sides: vertices of the template, and points at them, in pairs; those off the head are left
    out."""
    places = [skin.onto(vertices, points) for vertices, points in sides]
    is_near = (places[0].gaps < NEAR_RIM) & (places[1].gaps < NEAR_RIM)
    return _core.SlitPlaces(
        *(_core.SkinPlaces(one.corners[is_near], one.weights[is_near]) for one in places)
    )


def _follow_jaw(skin: BoundSkin, unit: NDArray[np.float64], mode: NDArray[np.float64]) -> None:
    """Moves teeth and tongue (rows of a mode, V x 3) rigidly as the unit moves the template's."""
    mesh = skin.template_mesh
    teeth = np.asarray(mesh.template.part_vertices("teeth_lower"))
    rest = np.ascontiguousarray(mesh.template.vertices[teeth])
    moved = rest + unit[teeth]
    turn = _core.fit_similarity(rest, moved).rotation  # without its scale: bone keeps its size
    # Of the template's place in the registered head, which may lie elsewhere
    middle = mesh.neutral[teeth].mean(axis=0)
    own = skin.head_vertices[skin.on_jaw]
    shift = moved.mean(axis=0) - rest.mean(axis=0)
    mode[skin.on_jaw] = (own - middle) @ turn.T + middle + shift - own


def _tongue(skin: BoundSkin, unit: NDArray[np.float64]) -> NDArray[np.float64]:
    """V x 3: what the lower jaw carries moves as the nearest of the template's teeth and tongue."""
    mesh = skin.template_mesh
    inside = np.asarray(mesh.template.part_vertices("teeth_lower", "tongue"))
    mode = np.zeros_like(skin.head_vertices)
    own = np.flatnonzero(skin.on_jaw)
    if len(own):
        nearest = inside[_core.nearest(skin.head_vertices[own], mesh.neutral[inside])]
        mode[own] = unit[nearest]
    return mode
