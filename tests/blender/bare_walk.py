# SPDX-License-Identifier: GPL-3.0-or-later
"""What test_bare runs in a Python of its own: installs the zip, captures, bakes, exports.

usage: python -I -S bare_walk.py REQUEST   (JSON; answer.json is written in the folder it runs in)
"""

import json
import os
import sys
from pathlib import Path

REPOSITORY = "bare"
NETWORK = []


def refuse_network(event, arguments):
    """No connection leaves this process, whatever asks for it."""
    if event in ("socket.connect", "socket.getaddrinfo"):
        NETWORK.append(f"{event} {arguments[-1]}")
        raise OSError("no network here")


def install(zip_path: str, folder: Path) -> str:
    """As Install from Disk: the zip's files and its wheels; returns the extension's module."""
    import bpy

    folder.mkdir()
    preferences = bpy.context.preferences
    preferences.extensions.repos.new(
        name="Bare", module=REPOSITORY, custom_directory=str(folder), source="USER"
    )
    done = bpy.ops.extensions.package_install_files(
        filepath=zip_path, repo=REPOSITORY, enable_on_install=True
    )
    assert done == {"FINISHED"}, done
    module = f"bl_ext.{REPOSITORY}.mimetic"
    assert module in preferences.addons, list(preferences.addons.keys())
    return module


def walk(request: dict, here: Path) -> dict:
    import bpy

    bpy.ops.wm.read_factory_settings(use_empty=True)
    install(request["zip"], here / "extensions")
    import mimetic

    take, glb = here / "take.npz", here / "face.glb"
    bpy.ops.mimetic.load_clip(filepath=request["clip"])
    bpy.ops.mimetic.capture(filepath=str(take), frame_first=1, frame_last=12)
    captured = json.loads(bpy.context.window_manager.mimetic_result)
    bpy.ops.mimetic.bake()
    baked = json.loads(bpy.context.window_manager.mimetic_result)
    bpy.ops.mimetic.export_gltf(filepath=str(glb))
    first, last = captured["footage_frames"]
    return {
        "package": mimetic.__file__,
        "captured": 1 + last - first,
        "num_curves": baked["num_curves"],
        "take": str(take),
        "glb": str(glb),
        "network": NETWORK,
    }


if __name__ == "__main__":
    settings, folder = json.loads(sys.argv[1]), Path.cwd()
    sys.path.insert(0, settings["packages"])
    os.environ["BLENDER_USER_RESOURCES"] = str(folder / "resources")
    sys.addaudithook(refuse_network)
    answer = walk(settings, folder)
    (folder / "answer.json").write_text(json.dumps(answer), encoding="utf-8")
    sys.stdout.flush()
    os._exit(0)  # some modules of Blender crash where Python ends before them
