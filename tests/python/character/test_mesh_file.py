# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes read from files, and files that lie about themselves."""

import base64
import json

import numpy as np
import pytest
from mimetic import InvalidInput, UnreadableMedia
from mimetic.character.gltf import write_chunks
from sample_mesh import FACES, POINTS, document, ply

from evaluation.anatomy.mesh_file import read_mesh

EXPECTED = [[0, 1, 2, 3], [3, 2, 4, -1]]


@pytest.mark.parametrize("order", ["ascii", "binary_little_endian", "binary_big_endian"])
def test_ply_files_of_all_kinds_are_read(tmp_path, order):
    path = tmp_path / "head.ply"
    path.write_bytes(ply(order))
    vertices, faces = read_mesh(path)
    np.testing.assert_array_equal(vertices, POINTS)
    assert faces.tolist() == EXPECTED
    path.write_bytes(ply(order, [[0, 1, 2, 4, 3], *FACES], (5, 3)))
    _, faces = read_mesh(path)
    assert faces.tolist() == [[0, 1, 2, -1], [0, 2, 4, -1], [0, 4, 3, -1], *EXPECTED]


@pytest.mark.parametrize(
    ("content", "match"),
    [
        (b"solid head", "not a .ply file"),
        (ply(counts=(900_000, 2)), "no room for 900000 vertex"),
        (ply(counts=(10**12, 2)), "at most are 1000000"),
        (ply(counts=(-5, 2)), "-5 of vertex"),
        (ply(cut=-3), "cut short in face 1"),
        (ply("ascii", counts=(5, 3)), "face 2 cannot be read"),
        (ply(faces=[[0, 1, 2, 9], [3, 2, 4]]), "does not have"),
        (ply(faces=[[0, -1, 2, 3], [3, 2, 4]]), "face 0 names a vertex below 0"),
        (ply(faces=[[0, 1, 2, 3], [3, 2]]), "face 1 has 2 corners"),
        (ply().replace(b"uchar int", b"uchar huge"), "'property list uchar huge vertex_indices'"),
        (ply().replace(b"float z", b"float w"), "no z"),
        (ply().replace(b"vertex_indices", b"vertex_numbers"), "no list vertex_indices"),
        (ply().replace(b"face 2", b"face 0"), "no faces"),
    ],
)
def test_bad_ply_files_are_refused(tmp_path, content, match):
    path = tmp_path / "head.ply"
    path.write_bytes(content)
    with pytest.raises(InvalidInput, match=match):
        read_mesh(path)


def check_quad(path) -> None:
    vertices, faces = read_mesh(path)
    x, y, z = POINTS[:4].T
    np.testing.assert_allclose(vertices, 2 * np.column_stack([-y, x, z + 5]), atol=1e-6)
    assert faces.tolist() == [[0, 1, 2, -1], [0, 2, 3, -1]]


def test_gltf_files_are_read_with_their_nodes_transforms(tmp_path):
    content, binary = document()
    path = tmp_path / "head.glb"
    path.write_bytes(write_chunks(content, binary))
    check_quad(path)
    path = tmp_path / "head.gltf"
    content["buffers"][0]["uri"] = "head%20data.bin"
    path.write_text(json.dumps(content))
    with pytest.raises(InvalidInput, match=r"buffer head data\.bin is not beside the file"):
        read_mesh(path)
    (tmp_path / "head data.bin").write_bytes(binary)
    path.write_text(json.dumps(content))
    check_quad(path)
    code = base64.b64encode(binary).decode()
    content["buffers"][0]["uri"] = f"data:application/octet-stream;base64,{code}"
    path.write_text(json.dumps(content))
    check_quad(path)


def test_a_mirrored_node_keeps_its_faces_outward(tmp_path):
    content, binary = document()
    content["nodes"][1]["scale"] = [-2, 2, 2]
    path = tmp_path / "head.glb"
    path.write_bytes(write_chunks(content, binary))
    _, faces = read_mesh(path)
    assert faces[0].tolist() == [2, 1, 0, -1]


def test_bad_gltf_files_are_refused(tmp_path):
    usual, binary = document()
    far = [dict(usual["accessors"][0], count=400), usual["accessors"][1]]
    vast = [dict(usual["accessors"][0], count=10**15), usual["accessors"][1]]
    circle = [{"mesh": 0, "children": [1]}, {"children": [0]}]
    outside = [{"uri": "../../secret.bin", "byteLength": 60}]
    absolute = [{"uri": "/dev/zero", "byteLength": 60}]
    missing = [{"mesh": 7}, {"children": [0]}]
    for changes, match in (
        ({"accessors": far}, "reaches beyond its buffer"),
        ({"accessors": vast}, "length that cannot be"),
        ({"nodes": circle}, "in a circle"),
        ({"buffers": outside}, "outside of the file's folder"),
        ({"buffers": absolute}, "outside of the file's folder"),
        ({"nodes": missing}, "not a sound glTF file"),
        ({"extensionsRequired": ["KHR_draco_mesh_compression"]}, "without compression"),
        ({"scenes": [{"nodes": []}]}, "no triangles"),
    ):
        path = tmp_path / "head.glb"
        path.write_bytes(write_chunks(usual | changes, binary))
        with pytest.raises(InvalidInput, match=match):
            read_mesh(path)
    path.write_bytes(write_chunks(usual, binary)[:-8])
    with pytest.raises(InvalidInput, match="cut short"):
        read_mesh(path)
    path = tmp_path / "head.gltf"
    path.write_text("[" * 100_000)
    with pytest.raises(InvalidInput, match="not JSON"):
        read_mesh(path)


def test_other_files_and_missing_ones_are_named(tmp_path):
    with pytest.raises(InvalidInput, match=r"read from \.obj, \.ply, \.glb, \.gltf files"):
        read_mesh(tmp_path / "head.fbx")
    for suffix in ("obj", "ply", "glb"):
        with pytest.raises(UnreadableMedia, match="no such file"):
            read_mesh(tmp_path / f"none.{suffix}")
    with pytest.raises(InvalidInput, match="larger than"):
        path = tmp_path / "head.ply"
        with path.open("wb") as file:
            file.truncate(500_000_000)
        read_mesh(path)
