# SPDX-License-Identifier: GPL-3.0-or-later
"""The network of what covers a face as ONNX."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

from ..eyes_and_lips.onnx_file import OPSET, coarse
from .pictures import CELLS, SIDE
from .training import ADDED, LAYERS, Weights


def write(weights: Weights, path: Path) -> None:
    """Input 1 x 3 x SIDE x SIDE of mean 0 and deviation 1; output 1 x 1 x CELLS x CELLS: logits."""
    nodes, stored, current = [], [], "picture"

    def store(name: str, values: np.ndarray) -> str:
        stored.append(numpy_helper.from_array(coarse(np.asarray(values, np.float32)), name))
        return name

    for name, (kind, _, _, width, stride) in LAYERS.items():
        layer = weights[name]
        inputs = [current, store(f"{name}_w", layer["w"]), store(f"{name}_b", layer["b"])]
        options = {"kernel_shape": [width] * 2, "strides": [stride] * 2}
        if kind == "up":
            nodes.append(helper.make_node("ConvTranspose", inputs, [f"{name}_x"], **options))
        else:
            options["pads"] = [width // 2] * 4
            nodes.append(helper.make_node("Conv", inputs, [f"{name}_x"], **options))
        current = f"{name}_x"
        if name in ADDED:
            nodes.append(helper.make_node("Add", [current, ADDED[name]], [f"{name}_sum"]))
            current = f"{name}_sum"
        if name != list(LAYERS)[-1]:
            nodes.append(helper.make_node("Relu", [current], [name]))
            current = name
    picture = helper.make_tensor_value_info("picture", TensorProto.FLOAT, [1, 3, SIDE, SIDE])
    cells = helper.make_tensor_value_info(current, TensorProto.FLOAT, [1, 1, CELLS, CELLS])
    graph = helper.make_graph(nodes, path.stem, [picture], [cells], stored)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", OPSET)], ir_version=6)
    onnx.checker.check_model(model)
    path.write_bytes(model.SerializeToString(deterministic=True))
