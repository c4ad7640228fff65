# SPDX-License-Identifier: GPL-3.0-or-later
"""What MediaPipe itself says of the drawn face, which a test holds against the core's networks.

usage: "$(scripts/face_mesh_env | tail -n 1)" evaluation/real/face_mesh_on_crop.py OUT.csv

Runs its own graph from a crop on, with refined lips, eyes and irises; the crop is the whole
picture. evaluation/real/drawn_face.csv is what it wrote: 478 rows of x, y, pixels of the crop
from its corner.
"""

from __future__ import annotations

import sys
from pathlib import Path

from drawn_face import SIDE, drawn_face
from mediapipe.framework.formats.rect_pb2 import NormalizedRect
from mediapipe.python.solution_base import SolutionBase

GRAPH = """
input_stream: "image"
input_stream: "roi"
output_stream: "landmarks"
node {
  calculator: "ConstantSidePacketCalculator"
  output_side_packet: "PACKET:with_attention"
  node_options: { [type.googleapis.com/mediapipe.ConstantSidePacketCalculatorOptions]: {
    packet { bool_value: true } } }
}
node {
  calculator: "FaceLandmarkCpu"
  input_stream: "IMAGE:image"
  input_stream: "ROI:roi"
  input_side_packet: "WITH_ATTENTION:with_attention"
  output_stream: "LANDMARKS:landmarks"
}
"""


def main(out: Path) -> None:
    roi = NormalizedRect(x_center=0.5, y_center=0.5, width=1, height=1, rotation=0)
    with SolutionBase(graph_config=GRAPH) as graph:
        landmarks = graph.process({"image": drawn_face(), "roi": roi}).landmarks.landmark
    rows = (f"{SIDE * point.x:.4f},{SIDE * point.y:.4f}" for point in landmarks)
    out.write_text("\n".join(("x,y", *rows)) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
