# SPDX-License-Identifier: GPL-3.0-or-later
"""The template drawn as a plain shaded and painted head: a picture whose truth is known."""

import numpy as np
from mimetic import _core

SKIN, LIP, BROW, HAIR = (
    (0.80, 0.60, 0.50),
    (0.66, 0.33, 0.33),
    (0.25, 0.17, 0.12),
    (0.18, 0.13, 0.10),
)
NOSTRIL = (0.22, 0.12, 0.1)
SCLERA, IRIS = (0.92, 0.91, 0.90), (0.16, 0.13, 0.12)
LEVELS = 3  # 64 points a control face: no holes between the splats


def draw(template, vertices, pose, camera, seed=0):
    """(H, W, 3) uint8 picture of control vertices (V x 3) seen at camera_from_head `pose`."""
    faces = np.ascontiguousarray(template.faces[: template.num_skin_faces])
    skin = template.num_skin_vertices
    mesh = _core.SubdividedMesh(faces, skin, LEVELS)
    points = mesh.positions(np.ascontiguousarray(vertices[:skin]))
    normals = mesh.normals(np.ascontiguousarray(vertices[:skin]))
    colors = _skin_colors(template, mesh, vertices)
    centers, radius = template.eye_spheres(vertices)
    looks = pose[:3, :3].T @ [0, 0, -1.0]
    for center in centers:
        ball, ball_colors = _eyeball(center, 0.92 * radius, looks)
        points = np.vstack([points, ball])
        normals = np.vstack(
            [normals, (ball - center) / np.linalg.norm(ball - center, axis=1)[:, None]]
        )
        colors = np.vstack([colors, ball_colors])
    light = np.array([0.25, -0.45, -0.85])
    turned = normals @ pose[:3, :3].T
    shade = 0.45 + 0.55 * np.clip(turned @ light, 0, None)
    in_camera = points @ pose[:3, :3].T + pose[:3, 3]
    pixels = in_camera[:, :2] / in_camera[:, 2:] * [camera.fx, camera.fy] + [camera.cx, camera.cy]
    picture = _splat(pixels, in_camera[:, 2], colors * shade[:, None], turned[:, 2] < 0.1, camera)
    noise = np.random.default_rng(seed).normal(0, 1.5, picture.shape)
    return np.clip(picture * 255 + noise, 0, 255).astype(np.uint8)


def _skin_colors(template, mesh, vertices):
    stencils = mesh.stencils()

    def spread(values):
        return stencils.multiply(values[:, None])[:, 0]

    skin = template.num_skin_vertices
    colors = np.tile(SKIN, (mesh.num_refined, 1))
    amount = np.clip(2 * spread(template.in_region("scalp").astype(float)) - 0.5, 0, 1)[:, None]
    colors = colors * (1 - amount) + amount * HAIR
    hidden = spread(template.in_region("mouth_cavity", "eye_socket").astype(float))[:, None] > 0.5
    colors = np.where(hidden, (0.2, 0.08, 0.08), colors)
    points = mesh.positions(np.ascontiguousarray(vertices[:skin]))
    amount = _on_lips(template, points, vertices)[:, None]
    colors = colors * (1 - amount) + amount * LIP
    for side in (".L", ".R"):
        ala, base, tip = (
            vertices[template.landmark(name)] for name in ("ala" + side, "nose_base", "nose_tip")
        )
        hole = 0.5 * ala + 0.35 * base + 0.15 * tip
        amount = np.clip(1.5 - np.linalg.norm(points - hole, axis=1) / 0.004, 0, 1)[:, None]
        colors = colors * (1 - amount) + amount * NOSTRIL
        stops = np.array(
            [
                vertices[template.landmark(n + side)]
                for n in ("brow_inner", "brow_middle", "brow_outer")
            ]
        )
        t = np.linspace(0, 1, 40)[:, None]
        line = np.vstack([stops[0] * (1 - t) + stops[1] * t, stops[1] * (1 - t) + stops[2] * t])
        near = np.flatnonzero((np.abs(points - line.mean(axis=0)) < 0.04).all(axis=1))
        distance = np.full((len(points), 1), 1.0)
        distance[near, 0] = np.sqrt(((points[near, None, :] - line[None]) ** 2).sum(-1)).min(1)
        amount = np.clip(1.6 - distance / 0.004, 0, 1)
        colors = colors * (1 - amount) + amount * BROW
    return colors


def _on_lips(template, points, vertices):
    """1 on the red of the lips to 0 off it: two half ellipses over and under the mouth's line."""
    corner_left, corner_right, line, upper, lower = (
        vertices[template.landmark(name)]
        for name in (
            "mouth_corner.L",
            "mouth_corner.R",
            "lip_upper_inner",
            "lip_upper",
            "lip_lower",
        )
    )
    middle = (corner_left + corner_right) / 2
    half = np.linalg.norm(corner_left - corner_right) / 2
    x = (points[:, 0] - middle[0]) / half
    above = points[:, 1] - line[1]
    y = np.where(above > 0, above / (upper[1] - line[1]), above / (lower[1] - line[1]))
    in_front = points[:, 2] > middle[2] - 0.012
    return np.where(in_front, np.clip((1 - np.hypot(x, y)) / 0.12 + 0.5, 0, 1), 0)


def _eyeball(center, radius, looks):
    """Points of an eyeball and their colours; the iris, 11.7 mm across, looks along `looks`."""
    count = 30_000
    z = np.linspace(-1, 1, count)
    turn = np.pi * (1 + 5**0.5) * np.arange(count)
    flat = np.sqrt(1 - z**2)
    directions = np.stack([flat * np.cos(turn), flat * np.sin(turn), z], 1)
    away = np.linalg.norm(np.cross(directions, looks), axis=1) * radius
    iris = (away < 0.00585) & (directions @ looks > 0)
    return center + radius * directions, np.where(iris[:, None], IRIS, SCLERA)


def _splat(pixels, depth, colors, facing, camera):
    picture = np.tile(np.array([0.45, 0.52, 0.58]), (camera.height, camera.width, 1))
    kept = facing & (depth > 0)
    order = np.argsort(-depth[kept])
    places = np.rint(pixels[kept][order]).astype(int)
    inside = ((places >= 0) & (places < [camera.width, camera.height])).all(1)
    picture[places[inside, 1], places[inside, 0]] = colors[kept][order][inside]
    # A camera's blur
    padded = np.pad(picture, ((1, 1), (1, 1), (0, 0)), mode="edge")
    rows = 0.25 * padded[:-2] + 0.5 * padded[1:-1] + 0.25 * padded[2:]
    return 0.25 * rows[:, :-2] + 0.5 * rows[:, 1:-1] + 0.25 * rows[:, 2:]
