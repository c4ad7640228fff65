# SPDX-License-Identifier: GPL-3.0-or-later
"""Binary glTF files: what Mimetic must read or mend in them."""

from __future__ import annotations

import copy
import json
import struct

import numpy as np

from mimetic import InvalidInput
from mimetic.shared.json_file import parse_json

MAGIC, JSON_CHUNK, BINARY_CHUNK = 0x46546C67, 0x4E4F534A, 0x004E4942
FLOAT = 5126
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


def read_chunks(glb: bytes) -> tuple[dict, bytes]:
    """JSON and binary chunk of a .glb file; raises InvalidInput."""
    try:
        magic, version, length = struct.unpack_from("<3I", glb)
        json_length, json_type = struct.unpack_from("<2I", glb, 12)
        document = parse_json(glb[20 : 20 + json_length])
        binary_length, binary_type = struct.unpack_from("<2I", glb, 20 + json_length)
    except (struct.error, InvalidInput) as error:
        raise InvalidInput(f"not a binary glTF file: {error}") from None
    expected_header = (MAGIC, 2, len(glb), JSON_CHUNK, BINARY_CHUNK)
    if (magic, version, length, json_type, binary_type) != expected_header:
        raise InvalidInput("not a binary glTF 2.0 file, or cut short")
    if not isinstance(document, dict):
        raise InvalidInput("not a binary glTF file: its JSON is no object")
    start = 28 + json_length
    return document, glb[start : start + binary_length]


def write_chunks(document: dict, binary: bytes) -> bytes:
    """A .glb file of a JSON and a binary chunk."""
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    return b"".join(
        [
            struct.pack("<3I", MAGIC, 2, 28 + len(text) + len(binary)),
            struct.pack("<2I", len(text), JSON_CHUNK),
            text,
            struct.pack("<2I", len(binary), BINARY_CHUNK),
            binary,
        ]
    )


class Chunks:
    """A .glb file taken apart: its document, and the bytes of each buffer view."""

    def __init__(self, glb: bytes) -> None:
        self.document, binary = read_chunks(glb)
        self.views = [
            bytearray(binary[view.get("byteOffset", 0) :][: view["byteLength"]])
            for view in self.document["bufferViews"]
        ]

    def to_bytes(self) -> bytes:
        binary = bytearray()
        for view, content in zip(self.document["bufferViews"], self.views, strict=True):
            binary += b"\0" * (-len(binary) % 4)
            view["byteOffset"], view["byteLength"] = len(binary), len(content)
            binary += content
        self.document["buffers"][0]["byteLength"] = len(binary)
        return write_chunks(self.document, bytes(binary))

    def floats(self, entry: dict, kind: str) -> np.ndarray:
        """Rows of an accessor, or of its sparse values, as a view that writes through."""
        if entry.get("componentType", FLOAT) != FLOAT:
            raise InvalidInput("the glTF file has integers where it should have floats")
        start = entry.get("byteOffset", 0)
        width = WIDTHS[kind]
        view = self.views[entry["bufferView"]]
        return np.frombuffer(view, np.float32, entry["count"] * width, start).reshape(-1, width)

    def accessor(self, index: int) -> np.ndarray:
        entry = self.document["accessors"][index]
        return self.floats(entry, entry["type"])

    def add_view(self, content: bytes, like: int) -> int:
        """Adds a buffer view with the target and stride of another; returns its index."""
        self.views.append(bytearray(content))
        self.document["bufferViews"].append(dict(self.document["bufferViews"][like]))
        return len(self.views) - 1

    def add_copy(self, index: int) -> int:
        """An accessor with a buffer view of its own, for what is about to differ; its index."""
        entry = copy.deepcopy(self.document["accessors"][index])
        entry["bufferView"] = self.add_view(self.views[entry["bufferView"]], entry["bufferView"])
        self.document["accessors"].append(entry)
        return len(self.document["accessors"]) - 1

    def add_negative(self, index: int) -> int:
        """An accessor with the negated values of another; returns its index."""
        entry = copy.deepcopy(self.document["accessors"][index])
        holders = [entry] if "bufferView" in entry else []
        if "sparse" in entry:
            holders.append(entry["sparse"]["values"])
            holders[-1]["count"] = entry["sparse"]["count"]
        for holder in holders:
            values = -self.floats(holder, entry["type"])
            holder["bufferView"] = self.add_view(values.tobytes(), holder["bufferView"])
            holder["byteOffset"] = 0
        if "sparse" in entry:
            del entry["sparse"]["values"]["count"]
        if "min" in entry:
            low, high = entry["min"], entry["max"]
            entry["min"], entry["max"] = [-v for v in high], [-v for v in low]
        self.document["accessors"].append(entry)
        return len(self.document["accessors"]) - 1


def read_weights(glb: bytes) -> tuple[np.ndarray, np.ndarray, list[str]]:
    """Morph weights of a file's first animated mesh; raises InvalidInput where none is.

    returns: seconds (N), weights (N x T), names of the targets (T).
    """
    chunks = Chunks(glb)
    if not (animated := _animated_meshes(chunks.document)):
        raise InvalidInput("the glTF file has no animated morph weights")
    mesh, sampler = animated[0]
    names = mesh["extras"]["targetNames"]
    weights = chunks.accessor(sampler["output"]).reshape(-1, len(names))
    return chunks.accessor(sampler["input"])[:, 0].copy(), weights.copy(), names


def retime(glb: bytes, rate: float) -> bytes:
    """The file with its animations' keys at whole frames, 1 / rate seconds each.

    Motions that begin some frames after the first go on doing so. For files whose keys are a frame
    apart, as a sampling exporter writes them, whatever it takes a frame for; raises InvalidInput
    for others.
    """
    chunks = Chunks(glb)
    inputs = {
        sampler["input"]
        for animation in chunks.document.get("animations", [])
        for sampler in animation["samplers"]
    }
    times = {accessor: chunks.accessor(accessor)[:, 0] for accessor in sorted(inputs)}
    steps = np.concatenate([np.empty(0), *(np.diff(seconds) for seconds in times.values())])
    if len(steps) and np.ptp(steps) > 0.5 * steps.mean():
        raise InvalidInput("the animation's keys are not evenly spaced")
    # A pose of one key has no step: it is where it is among the others, or at the start
    step = float(steps.mean()) if len(steps) else 1.0
    for accessor, seconds in times.items():
        first = round(float(seconds[0]) / step)
        seconds[:] = (first + np.arange(len(seconds))) / rate
        entry = chunks.document["accessors"][accessor]
        entry["min"], entry["max"] = [float(seconds[0])], [float(seconds[-1])]
    return chunks.to_bytes()


def split_negative(glb: bytes) -> bytes:
    """The file with weights of 0 and above only.

    Engines clamp morph weights at 0, and Blender's importer does after the first key. A target
    whose weight goes below gets a second one, `<name>.negative`, with the opposite displacement.
    """
    chunks = Chunks(glb)
    # Teeth and tongue that move alike share one accessor, so it is read for all before one is split
    animated = [
        (mesh, sampler, chunks.accessor(sampler["output"]).copy())
        for mesh, sampler in _animated_meshes(chunks.document)
    ]
    split: set[int] = set()
    for mesh, sampler, values in animated:
        if sampler["output"] in split:
            sampler["output"] = chunks.add_copy(sampler["output"])
        split.add(sampler["output"])
        _split_mesh(chunks, mesh, sampler, values)
    return chunks.to_bytes()


def _split_mesh(chunks: Chunks, mesh: dict, sampler: dict, values: np.ndarray) -> None:
    names = mesh["extras"]["targetNames"]
    weights = values.reshape(-1, len(names))
    below = np.flatnonzero(weights.min(axis=0) < 0)
    for primitive in mesh["primitives"]:
        primitive["targets"] += [
            {kind: chunks.add_negative(index) for kind, index in primitive["targets"][i].items()}
            for i in below
        ]
    names += [f"{names[i]}.negative" for i in below]
    mesh["weights"] = [0.0] * len(names)
    both = np.hstack([np.maximum(weights, 0), np.maximum(-weights[:, below], 0)])
    output = chunks.document["accessors"][sampler["output"]]
    chunks.views[output["bufferView"]] = bytearray(both.astype(np.float32).tobytes())
    output["byteOffset"], output["count"] = 0, both.size
    output.pop("min", None), output.pop("max", None)


def _animated_meshes(document: dict) -> list[tuple[dict, dict]]:
    """Meshes whose morph weights are animated, each once, and what samples them."""
    pairs: dict[int, dict] = {}
    for animation in document.get("animations", []):
        for channel in animation["channels"]:
            if channel["target"]["path"] == "weights":
                mesh = document["nodes"][channel["target"]["node"]]["mesh"]
                pairs.setdefault(mesh, animation["samplers"][channel["sampler"]])
    return [(document["meshes"][mesh], sampler) for mesh, sampler in pairs.items()]
