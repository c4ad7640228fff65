# SPDX-License-Identifier: GPL-3.0-or-later
"""How far the linear skin is from the corotational one, for each muscle up to full activation.

    python -m evaluation.anatomy.rotation_table [--only NAME ...] [--values V ...]

Same skin, same forces; only large rotations and stretches tell them apart. Over the vertices seen
from the front: the largest and the RMS difference in millimetres, and R2 = 1 - sum |linear -
corotational|^2 / sum |corotational|^2. Left muscles only (the right ones mirror them), and the jaw.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass

import numpy as np
from mimetic.muscles.motion import LoadedSkin, load_skin
from mimetic.skin.mesh import multiply


@dataclass(frozen=True)
class LinearError:
    """motion_mm: largest corotational displacement; the rest of the linear one against it.

    residual: force that the corotational skin is out of balance by, over the load.
    """

    motion_mm: float
    largest_mm: float
    rms_mm: float
    r2: float
    iterations: int
    residual: float


def linear_error(skin: LoadedSkin, corotational, name: str, value: float) -> LinearError:
    """Of one actuator at a value; corotational: `loaded.corotational()`."""
    force = value * skin.forces[skin.names.index(name)].reshape(-1)
    solution = corotational.solve(force)
    stencils = skin.visible_stencils()
    linear = multiply(stencils, skin.skin.model.solve(force[:, None]).reshape(-1, 3))
    truth = multiply(stencils, solution.unknowns.reshape(-1, 3))
    apart = np.linalg.norm(linear - truth, axis=1)
    distance = np.linalg.norm(truth, axis=1)
    return LinearError(
        1e3 * distance.max(),
        1e3 * apart.max(),
        1e3 * np.sqrt((apart**2).mean()),
        1 - (apart**2).sum() / (distance**2).sum(),
        solution.iterations,
        solution.residual,
    )


def main(arguments: list[str] | None = None) -> int:
    from mimetic.template.face_template import load_template

    template = load_template()
    skin = load_skin(template.vertices, template)
    names = [name for name in skin.names if not name.endswith(".R")]
    parser = argparse.ArgumentParser(prog="python -m evaluation.anatomy.rotation_table")
    parser.add_argument("--only", nargs="+", default=names, choices=skin.names, metavar="NAME")
    parser.add_argument("--values", type=float, nargs="+", default=[0.5, 1.0])
    options = parser.parse_args(arguments)
    if not all(-1 <= value <= 2 for value in options.values):
        print("rotation_table: --values are -1 to 2 each", file=sys.stderr)
        return 2
    corotational = skin.corotational()
    columns = (("value", 6), ("moves", 10), ("max", 10), ("RMS", 10), ("R2", 9))
    columns += (("iterations", 12), ("out by", 9))
    print(f"{'actuator':40}" + "".join(f"{name:>{width}}" for name, width in columns))
    for name in options.only:
        for value in options.values:
            e = linear_error(skin, corotational, name, value)
            print(
                f"{name:40}{value:6.2f}{e.motion_mm:7.2f} mm{e.largest_mm:7.3f} mm"
                f"{e.rms_mm:7.3f} mm{e.r2:9.4f}{e.iterations:12d}{e.residual:9.0e}",
                flush=True,
            )
    return 0


if __name__ == "__main__":
    sys.exit(main())
