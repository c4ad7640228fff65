# SPDX-License-Identifier: GPL-3.0-or-later
"""Small meshes as files: .ply of all kinds, and what a glTF file is made of."""

import struct

import numpy as np

POINTS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 1.5, 0.25]])
FACES = [[0, 1, 2, 3], [3, 2, 4]]


def ply(order="binary_little_endian", faces=FACES, counts=(5, 2), cut=None) -> bytes:
    """A file with a colour beside each place, and a flag beside each face."""
    head = f"ply\nformat {order} 1.0\ncomment a head\nelement vertex {counts[0]}\n"
    head += "property float x\nproperty float y\nproperty float z\nproperty uchar red\n"
    head += f"element face {counts[1]}\nproperty list uchar int vertex_indices\n"
    head += "property short flag\nend_header\n"
    sign = {"binary_little_endian": "<", "binary_big_endian": ">"}.get(order)
    if sign is None:
        body = "".join(f"{x} {y} {z} 200\n" for x, y, z in POINTS)
        body += "".join(f"{len(face)} {' '.join(map(str, face))} 7\n" for face in faces)
        return (head + body).encode()
    body = b"".join(struct.pack(f"{sign}3fB", *point, 200) for point in POINTS)
    for face in faces:
        body += struct.pack(f"{sign}B{len(face)}ih", len(face), *face, 7)
    return (head.encode() + body)[:cut]


def document(**changes) -> tuple[dict, bytes]:
    """A quad as two triangles, of a node turned by 90 degrees about z, doubled and moved."""
    places = POINTS[:4].astype("<f4").tobytes()
    corners = np.array([0, 1, 2, 0, 2, 3], "<u2").tobytes()
    landmarks = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [1]}],
        "nodes": [
            {"mesh": 0, "translation": [0, 0, 5]},
            {"children": [0], "rotation": [0, 0, 0.5**0.5, 0.5**0.5], "scale": [2, 2, 2]},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": len(places)},
            {"buffer": 0, "byteOffset": len(places), "byteLength": len(corners)},
        ],
        "buffers": [{"byteLength": len(places) + len(corners)}],
    }
    return landmarks | changes, places + corners
