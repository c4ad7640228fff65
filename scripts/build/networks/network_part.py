# SPDX-License-Identifier: GPL-3.0-or-later
"""Part of a TensorFlow Lite network as ONNX, from some of its tensors to others.

tflite2onnx turns a whole network round, and only if all its operators are ordinary ones. A network
with operators of its own is cut at them; what they do is left to whoever runs the parts.
"""

from __future__ import annotations

import logging

import numpy as np
import onnx
import tflite
from onnx import helper
from tflite2onnx.graph import Graph

logging.getLogger("tflite2onnx").setLevel(logging.ERROR)
OPSET, IR_VERSION = 11, 6  # of the ONNX that OpenCV 4.6 reads
HALF_PRECISION = "float16"


class NetworkPart(Graph):
    """The operators that lead from tensors, by name, to others; half precision is made whole."""

    def __init__(self, content: bytes, inputs: list[str], outputs: list[str]) -> None:
        network = tflite.Model.GetRootAs(content, 0)
        super().__init__(network, network.Subgraphs(0))
        names = {
            self.graph.Tensors(i).Name().decode(): i for i in range(self.graph.TensorsLength())
        }
        self.input_tensors = [names[name] for name in inputs]
        self.output_tensors = [names[name] for name in outputs]

    def parse(self) -> None:
        """Of tflite2onnx's Graph, which takes all operators."""
        halves = []
        for i in self._operators():
            operator = self.graph.Operators(i)
            if self._code(operator) == tflite.BuiltinOperator.DEQUANTIZE:
                halves.append((operator.Inputs(0), operator.Outputs(0)))
                continue
            converter = self.OPCFactory.create(i)
            converter.parse()
            self.ops.append(converter)
        for half, whole in halves:
            stored = self.TFactory.getData(self.model, self.graph, half, HALF_PRECISION)
            self.TFactory.get(whole).data = stored.astype(np.float32)
        self.inputs = [self.TFactory.get(i) for i in self.input_tensors]
        self.outputs = [self.TFactory.get(i) for i in self.output_tensors]
        self._collectOpAndTensor()
        self.setParsed()

    def _operators(self) -> list[int]:
        """Those that the outputs need, in the network's order."""
        makers = {
            int(tensor): i
            for i in range(self.graph.OperatorsLength())
            for tensor in self.graph.Operators(i).OutputsAsNumpy()
        }
        needed: set[int] = set()
        waiting = list(self.output_tensors)
        while waiting:
            tensor = waiting.pop()
            if tensor in self.input_tensors or tensor not in makers or makers[tensor] in needed:
                continue
            needed.add(makers[tensor])
            waiting += [int(t) for t in self.graph.Operators(makers[tensor]).InputsAsNumpy()]
        return sorted(needed)

    def _code(self, operator: tflite.Operator) -> int:
        return self.model.OperatorCodes(operator.OpcodeIndex()).BuiltinCode()

    def as_onnx(self) -> onnx.ModelProto:
        self.parse()
        self.convert({})
        opset = helper.make_operatorsetid("", OPSET)
        network = helper.make_model(self.onnx, ir_version=IR_VERSION, opset_imports=[opset])
        onnx.checker.check_model(network)
        return network
