# SPDX-License-Identifier: GPL-3.0-or-later
"""A regressor as ONNX."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

from .crops import SIDE
from .training import LAYERS, Weights

OPSET = 11
LEVELS = 31  # of an output's largest weight; 22 to 44, as steps are powers of two


def coarse(values: np.ndarray) -> np.ndarray:
    """Weights on a grid of each output's own, so that packages compress them to a byte each.

    Points move by .12 % of the square in the median, an eighth of their error.
    """
    if values.ndim == 1:
        return values
    largest = np.abs(values).reshape(len(values), -1).max(axis=1)
    step = 2.0 ** np.round(np.log2(np.maximum(largest, 1e-12) / LEVELS))
    step = step.reshape(-1, *[1] * (values.ndim - 1))
    return (np.round(values / step) * step).astype(np.float32)


def write(weights: Weights, path: Path) -> None:
    """Input 1 x 3 x SIDE x SIDE of mean 0 and deviation 1; output: places, then logs of spreads."""
    nodes, stored, current = [], [], "picture"

    def store(name: str, values: np.ndarray) -> str:
        stored.append(numpy_helper.from_array(coarse(np.asarray(values, np.float32)), name))
        return name

    strides = [*(stride for _, stride in LAYERS), 1]
    for i, layer in enumerate(weights):
        inputs = [current, store(f"w{i}", layer["w"]), store(f"b{i}", layer["b"])]
        if i < len(strides):
            size, stride = layer["w"].shape[2], strides[i]
            options = {"kernel_shape": [size] * 2, "strides": [stride] * 2, "pads": [size // 2] * 4}
            nodes.append(helper.make_node("Conv", inputs, [f"x{i}"], **options))
        else:
            nodes.append(helper.make_node("Gemm", inputs, [f"x{i}"], transB=1))
        current = f"x{i}"
        if i < len(weights) - 1:
            nodes.append(helper.make_node("Relu", [current], [f"y{i}"]))
            current = f"y{i}"
        if i == len(strides) - 1:
            nodes.append(helper.make_node("Flatten", [current], ["flat"], axis=1))
            current = "flat"
    picture = helper.make_tensor_value_info("picture", TensorProto.FLOAT, [1, 3, SIDE, SIDE])
    count = len(weights[-1]["b"])
    points = helper.make_tensor_value_info(current, TensorProto.FLOAT, [1, count])
    graph = helper.make_graph(nodes, path.stem, [picture], [points], stored)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", OPSET)], ir_version=6)
    onnx.checker.check_model(model)
    path.write_bytes(model.SerializeToString(deterministic=True))
