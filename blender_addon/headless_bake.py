# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes a file in a Blender without a window: what `mimetic bake`, `mimetic shapes` and `mimetic
library assets` start as a child process.

Run by a Python that has the bpy module. Standard input: a line with a request as JSON; the file it
names as `answer` gets {"text": ...} or, for bad input, {"error": ...}, or, for what the system
refused, such as a full disk, {"failed": what, "number": its errno, "file": of which file}, the last
two null where unknown. Standard input then stays open as long as the parent lives: when it closes
this process ends, too.
"""

import contextlib
import importlib
import importlib.util
import json
import os
import shutil
import sys
import tempfile
import threading
from pathlib import Path

REPOSITORY = "mimetic_headless"


def main() -> None:
    request = json.loads(sys.stdin.readline())
    end_with_parent(request)
    if importlib.util.find_spec("mimetic") is None:
        sys.path.append(request["package_folder"])
    with tempfile.TemporaryDirectory() as user_files:
        # Read by bpy as it is imported: no settings or add-ons of the user's
        os.environ["BLENDER_USER_RESOURCES"] = user_files
        answer = bake(request)
    Path(request["answer"]).write_text(json.dumps(answer), encoding="utf-8")
    leave()


def leave() -> None:
    """Ends the process, all being done: the module of Blender 4.2 frees the panels that an add-on
    registered after Python is gone, and crashes."""
    import bpy

    shutil.rmtree(bpy.app.tempdir, ignore_errors=True)
    sys.stdout.flush()
    os._exit(0)


def end_with_parent(request: dict) -> None:
    """Ends this process when its parent is gone, however that was ended, and leaves nothing."""

    def wait() -> None:
        with contextlib.suppress(OSError):
            # Not by sys.stdin, whose lock a thread must not hold when the interpreter ends
            os.read(0, 1)
        out = Path(request["out"])
        folders = [Path(request["answer"]).parent]
        if request.get("its_folder"):
            folders.append(Path(request["its_folder"]))
        for left in (out, *out.parent.glob(f".{out.stem}.*"), *folders):
            if left.is_dir():
                shutil.rmtree(left, ignore_errors=True)
            else:
                left.unlink(missing_ok=True)
        os._exit(1)

    threading.Thread(target=wait, daemon=True).start()


def bake(request: dict) -> dict:
    extension = load_extension()
    native = importlib.import_module(f"{extension}.native")
    if reason := native.problem():
        return {"error": reason}
    mimetic = importlib.import_module("mimetic")
    try:
        if target := request.get("target"):
            rig_file = importlib.import_module(f"{extension}.scene_out.rig_file")
            few_keys = {name: request[name] for name in ("tolerance", "by_phases")}
            return {
                "text": rig_file.write(
                    *(request["performance"], request["out"], target["file"], target["object"]),
                    *(target["settings"] | few_keys, request["footage"], request["curves"]),
                )
            }
        if library := request.get("library"):
            assets = importlib.import_module(f"{extension}.scene_out.asset_file")
            return {"text": assets.write(library, request["out"])}
        if shapes := request.get("shapes"):
            shapes_file = importlib.import_module(f"{extension}.scene_out.shapes_file")
            head = (shapes["file"], shapes["object"], shapes["landmarks"])
            return {"text": shapes_file.write(request["out"], *head)}
        new_file = importlib.import_module(f"{extension}.scene_out.new_file")
        files = (request["performance"], request["out"], request["footage"])
        options = (request["with_detail"], request["tolerance"], request["with_units"])
        options += (request["by_phases"], request["with_controls"], request["as_arkit"])
        options += (request["curves"], request["with_eye_nodes"])
        return {"text": new_file.write(*files, *options)}
    except (mimetic.InvalidInput, mimetic.UnreadableMedia) as error:  # some are OSErrors too
        return {"error": str(error)}
    except OSError as error:
        return failed(error)
    except RuntimeError as error:  # what an exporter reported, as text
        reports = importlib.import_module(f"{extension}.scene_out.exporter_reports")
        refused = reports.reported(error, request["out"])
        if refused.errno is None:  # a fault of ours, whose traceback tells
            raise
        return failed(refused)


def failed(error: OSError) -> dict:
    if error.errno is None:
        return {"failed": str(error), "number": None, "file": None}
    name = error.filename
    file = os.fsdecode(name) if isinstance(name, (str, bytes, os.PathLike)) else None
    return {"failed": error.strerror, "number": error.errno, "file": file}


def load_extension() -> str:
    """Enables the extension beside this file; returns the name of its package."""
    import bpy

    bpy.ops.wm.read_factory_settings(use_empty=True)
    folder = str(Path(__file__).resolve().parent)
    bpy.context.preferences.extensions.repos.new(
        name="Mimetic", module=REPOSITORY, custom_directory=folder, source="USER"
    )
    package = f"bl_ext.{REPOSITORY}.mimetic"
    if bpy.ops.preferences.addon_enable(module=package) != {"FINISHED"}:
        raise RuntimeError(f"Blender does not load the extension in {folder}")
    return package


if __name__ == "__main__":
    main()
