# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic bake`: a performance as .blend, .glb, .fbx, .usdc or .abc, by the Blender extension in a
child process; as Live Link Face's .csv; as timed OSC messages, .osc; beside its footage, .mp4."""

from __future__ import annotations

import argparse
import os
import tempfile
from dataclasses import asdict
from pathlib import Path

import numpy as np

from mimetic import InvalidInput
from mimetic.character.curve_settings import MIRRORS, CurveSettings, edited, parse_factors
from mimetic.character.sparse_curves import USUAL_TOLERANCE, check_tolerance
from mimetic.commands.bake_video import write_video
from mimetic.commands.blender_process import add_blender_python, write_by_blender
from mimetic.head.smoothing import USUAL_STRENGTH
from mimetic.media.clip_fingerprint import fingerprint
from mimetic.media.image_sequence import opened
from mimetic.performance.document import Performance
from mimetic.puppet.osc_file import write_control_osc, write_osc
from mimetic.retarget.controls import load_preset
from mimetic.retarget.face_csv import write_control_csv, write_face_csv
from mimetic.shared.regular_file import check_input, check_target
from mimetic.shared.shown_text import shortened, shown

TABLES = {".csv": write_face_csv, ".osc": write_osc}  # what needs no Blender
CONTROL_TABLES = {".csv": write_control_csv, ".osc": write_control_osc}  # of a target
EXPORTS = (".glb", ".fbx", ".usdc", ".abc")
VIDEO = ".mp4"  # to look at: footage and face side by side
SUFFIXES = (".blend", *EXPORTS, *TABLES, VIDEO)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("performance", type=Path, help="performance.npz of a capture")
    parser.add_argument(
        "--out",
        type=Path,
        required=True,
        help=f"FACE and one of {', '.join(SUFFIXES)}: what each format loses is in "
        "docs/guide/exporting.md; .mp4 shows footage and face side by side, from the same camera",
    )
    parser.add_argument(
        "--names",
        choices=("muscles", "arkit"),
        default="muscles",
        help="shapes of an exported face: our muscles, jaw, lids and lips (a --target's own), or "
        "ARKit's 52, which a --target has by known names, or its muscles make (default: "
        "%(default)s)",
    )
    parser.add_argument(
        "--eyes",
        choices=("shapes", "nodes"),
        default="shapes",
        help="what turns the eyes of an exported face or --target with muscles: its shapes, or "
        "eyeballs that are objects of their own (default: %(default)s)",
    )
    parser.add_argument(
        "--footage",
        type=Path,
        help="the captured clip: its colours on the skin, and the clip behind the face; with a "
        "--target the clip behind what the file's own camera sees",
    )
    add_face_arguments(parser)
    parser.add_argument(
        "--action-units",
        action="store_true",
        help="sliders of FACS's action units too, left and right, and in a .blend an action each",
    )
    parser.add_argument(
        "--by-phases",
        action="store_true",
        help="few keys at onset, apex, release and end of each event first",
    )
    parser.add_argument(
        "--control-object",
        action="store_true",
        help="curves on the bones of an armature that drives the face's muscles, for pose "
        "libraries, mirrored poses and a gaze target, instead of on the shape keys (.blend)",
    )
    add_curve_arguments(parser)
    _add_target_arguments(parser)


def _add_target_arguments(parser: argparse.ArgumentParser) -> None:
    """A character, and what of it plays."""
    parser.add_argument(
        "--target",
        metavar="RIG.blend:OBJECT",
        help="put the performance on this character instead, in a copy of its file: on the "
        "muscles of a head that has them attached, on shape keys of its own with known names "
        "(ARKit, VRM, VRoid, Unified Expressions, MetaHuman), the head's motion alone on any other "
        "object or an armature; a .csv or .osc has the values of its controls",
    )
    parser.add_argument(
        "--controls",
        choices=("auto", "muscles", "own"),
        default="auto",
        help="what of a --target plays the face: its muscles, or its own shape keys, or an "
        "armature's bones, fitted to what muscles do (default: muscles where it has them)",
    )
    parser.add_argument(
        "--preset",
        type=Path,
        help="how a --target's own controls are driven: a table that Save Controls wrote",
    )
    parser.add_argument("--bone", help="the armature's head (default: found by its name)")
    parser.add_argument(
        "--neck", help="the armature's neck (default: found by its name; '' for none)"
    )
    parser.add_argument(
        "--neck-share", type=float, default=0.3, help="part of the turns that the neck takes"
    )
    parser.add_argument(
        "--smoothing",
        type=float,
        default=USUAL_STRENGTH,
        help="strength of the smoothing of the head's motion on a target: what the standard "
        "deviations of poses are multiplied by (default: %(default)s; 0 leaves frames as measured)",
    )


def add_curve_arguments(parser: argparse.ArgumentParser) -> None:
    """What is done to curves before they are keyed."""
    parser.add_argument(
        "--smooth-curves",
        type=float,
        default=0.0,
        metavar="SECONDS",
        help="smooth the curves of muscles, jaw and lips (lids blink too fast): what neighbouring "
        "frames weigh in by, as a standard deviation in seconds (default: 0, as captured)",
    )
    parser.add_argument(
        "--exaggerate",
        nargs="+",
        default=[],
        metavar="[GROUP=]FACTOR",
        help="multiply the expression, of all muscles or of a group such as brow-raisers=1.5, "
        "within what each muscle can do",
    )
    parser.add_argument(
        "--neutral",
        type=int,
        default=0,
        metavar="FRAME",
        help="the footage's frame in which the actor's face is what the character's is at rest",
    )
    parser.add_argument(
        "--mirror",
        choices=MIRRORS,
        default="",
        help="exchange the sides (swap), have both do what the subject's left or right does, or "
        "the mean of the two (both); the head moves as it did",
    )


def add_face_arguments(parser: argparse.ArgumentParser) -> None:
    """How a face is baked, and by which Blender."""
    parser.add_argument(
        "--detail",
        action="store_true",
        help="shapes and curves for what the muscles leave unexplained too",
    )
    parser.add_argument(
        "--few-keys",
        nargs="?",
        type=float,
        const=USUAL_TOLERANCE,
        metavar="TOLERANCE",
        help="few keys with handles to drag instead of one a frame, within this of each "
        "activation, or of bones and a target's head, of which 1 is a centimetre or ten degrees "
        f"(default: {USUAL_TOLERANCE:g})",
    )
    add_blender_python(parser)


def run_bake(arguments: argparse.Namespace) -> int:
    target = None
    if arguments.target:
        target = parse_target(arguments.target)
        target["settings"] = {
            "bone": arguments.bone,
            "neck": arguments.neck,
            "neck_share": arguments.neck_share,
            "smoothing": arguments.smoothing,
            "controls": arguments.controls,
            "preset": _preset(arguments.preset),
            "control_object": arguments.control_object,
            "as_arkit": arguments.names == "arkit",
            "with_eye_nodes": arguments.eyes == "nodes",
        }
        if arguments.control_object and arguments.controls == "own":
            raise InvalidInput("--control-object drives muscles; leave --controls own out")
        if arguments.detail:
            raise InvalidInput(
                "--detail is of the person's own face; a --target has no shapes for it: leave it "
                "out"
            )
        if arguments.names == "arkit" and (arguments.controls != "auto" or arguments.preset):
            raise InvalidInput(
                "--names arkit takes ARKit's shapes of a --target; leave --controls and "
                "--preset out"
            )
        if arguments.action_units:
            raise InvalidInput(
                "--action-units are the person's own face's; a --target has no shapes for them: "
                "leave it out"
            )
    elif arguments.controls != "auto" or arguments.preset:
        raise InvalidInput("--controls and --preset are a --target RIG.blend:OBJECT's; give it")
    elif arguments.bone or arguments.neck:
        raise InvalidInput("--bone and --neck name bones of a --target RIG.blend:OBJECT; give it")
    text = bake(
        *(arguments.performance, arguments.out, arguments.footage, arguments.blender_python),
        target,
        arguments.detail,
        arguments.few_keys,
        arguments.action_units,
        arguments.by_phases,
        arguments.control_object,
        arguments.names == "arkit",
        CurveSettings(
            arguments.smooth_curves,
            arguments.neutral,
            parse_factors(arguments.exaggerate),
            mirror=arguments.mirror,
        ),
        arguments.eyes == "nodes",
    )
    print(f"{shown(arguments.out)}: {text}")
    return 0


def _preset(path: Path | None) -> str | None:
    """The whole path of a table that can be read."""
    if path is None:
        return None
    load_preset(path)
    return str(path.absolute())


def parse_target(text: str, form: str = "--target RIG.blend:OBJECT") -> dict:
    """The file and the object of a text of this form."""
    path, _, name = text.rpartition(":")
    if not path.endswith(".blend") or not name:
        raise InvalidInput(f"{shortened(text)}: give it as {form}")
    check_input(path, "the .blend of a rig")
    return {"file": str(Path(path).absolute()), "object": name}


def _check_few_keys(tolerance: float | None, by_phases: bool) -> None:
    if by_phases and tolerance is None:
        raise InvalidInput("--by-phases says where few keys are: give --few-keys too")
    if tolerance is not None:
        check_tolerance(tolerance)


def _check_kind(out: Path, has_target: bool, with_controls: bool, is_remade: bool) -> None:
    """Raises InvalidInput for a kind of file that does not hold what is asked for."""
    if out.suffix not in SUFFIXES:
        raise InvalidInput(f"--out {out.name}: bake writes {', '.join(SUFFIXES)} files")
    if has_target and out.suffix == VIDEO:
        kinds = ", ".join((".blend", *EXPORTS, *TABLES))
        raise InvalidInput(f"--out {out.name}: a target is written as {kinds}")
    if with_controls and out.suffix != ".blend":
        raise InvalidInput(f"--out {out.name}: --control-object is of a .blend")
    if is_remade and out.suffix not in (*EXPORTS, *(TABLES if has_target else ())):
        raise InvalidInput(f"--out {out.name}: --names and --eyes are of {', '.join(EXPORTS)}")


def _write_here(
    performance: os.PathLike[str],
    out: Path,
    footage: os.PathLike[str] | None,
    with_detail: bool,
    is_edited: bool,
    curves: CurveSettings,
) -> str:
    """What needs no Blender: a table, or a video; is_edited: sliders or few keys are asked for."""
    if write_table := TABLES.get(out.suffix):
        if footage is not None or with_detail or is_edited:
            raise InvalidInput(f"--out {out.name}: a table takes no option but the performance")
        return write_table(edited(Performance.load(performance), curves), out)
    if footage is None:
        raise InvalidInput(f"--out {out.name} shows the face beside its footage: give --footage")
    if is_edited:
        raise InvalidInput(
            f"--out {out.name}: a video has neither sliders nor keys; leave --action-units and "
            "--few-keys out"
        )
    return write_video(edited(Performance.load(performance), curves), footage, out, with_detail)


def check_footage(performance: os.PathLike[str], footage: os.PathLike[str]) -> None:
    """Raises InvalidInput for footage other than what the performance names, if it names any."""
    source = opened(footage)
    check_input(source, "a video file, or a folder of numbered pictures")
    document = Performance.load(performance)
    if document.footage and not document.is_of(fingerprint(source)):
        raise InvalidInput(
            f"--footage {shown(footage)} is not the clip that {shown(performance)} was captured "
            f"from ({shown(document.footage[0])}): give that one, or leave --footage out"
        )


def bake(
    performance: os.PathLike[str],
    out: os.PathLike[str],
    footage: os.PathLike[str] | None = None,
    blender_python: os.PathLike[str] | None = None,
    target: dict | None = None,
    with_detail: bool = False,
    tolerance: float | None = None,
    with_units: bool = False,
    by_phases: bool = False,
    with_controls: bool = False,
    as_arkit: bool = False,
    curves: CurveSettings | None = None,
    with_eye_nodes: bool = False,
) -> str:
    """Writes `out`, whole or not at all; returns a line that says what is in it.

    blender_python: a Python with the bpy module, this one if None. target: what `parse_target`
    gives, with `settings` for the head's motion on it; None bakes the person's own face.
    with_detail: shapes and curves of the surface that the muscles leave unexplained too.
    tolerance: by how much few keys with handles may miss an activation; None keys every frame.
    with_units: sliders of FACS's action units, which need the canonical mesh. by_phases: few keys
    at the phases of each event first. with_controls: curves on a control object, for a .blend.
    as_arkit: ARKit's 52 shapes instead of muscles, with_eye_nodes: eyeballs as objects, in a file
    for other programs. curves: edits of the performance's curves before they are keyed.
    Raises InvalidInput, UnreadableMedia, and OSError where `out` cannot be written.
    """
    _check_few_keys(tolerance, by_phases)
    out = Path(os.path.realpath(out))
    _check_kind(out, target is not None, with_controls, as_arkit or with_eye_nodes)
    if as_arkit and (with_detail or with_units):
        raise InvalidInput("--names arkit leaves our shapes out, --detail and --action-units too")
    check_input(performance, "the performance.npz of a capture")
    if footage is not None:
        check_footage(performance, footage)
    check_target(out, performance, *_further_inputs(footage, target))
    curves = curves or CurveSettings()
    if not curves.changes_nothing():  # what is wrong with it is said before Blender starts
        edited(Performance.load(performance), curves)
    if target is None and out.suffix in (*TABLES, VIDEO):
        is_edited = with_units or tolerance is not None
        return _write_here(performance, out, footage, with_detail, is_edited, curves)
    request = {
        "performance": os.path.abspath(performance),
        "footage": None if footage is None else os.path.abspath(opened(footage)),
        "target": target,
        "with_detail": with_detail,
        "tolerance": tolerance or 0.0,
        "with_units": with_units,
        "by_phases": by_phases,
        "with_controls": with_controls,
        "as_arkit": as_arkit,
        "curves": asdict(curves),
        "with_eye_nodes": with_eye_nodes,
    }
    if out.suffix in TABLES:
        return _write_controls(request, out, blender_python, curves)
    return write_by_blender(request, out, blender_python)


def _further_inputs(
    footage: os.PathLike[str] | None, target: dict | None
) -> list[str | os.PathLike[str]]:
    """What a bake reads beside the performance: nothing is written over it."""
    files: list[str | os.PathLike[str]] = [] if footage is None else [footage]
    if target is not None:
        preset = target.get("settings", {}).get("preset")
        files += [target["file"], *([] if preset is None else [preset])]
    return files


def _write_controls(
    request: dict, out: Path, blender_python: os.PathLike[str] | None, curves: CurveSettings
) -> str:
    """A table of what a target's own controls do, which Blender finds out."""
    if request["footage"] or request["tolerance"] or request["with_eye_nodes"]:
        raise InvalidInput(
            f"--out {out.name}: a table has a value in every frame and no more; leave --footage, "
            "--few-keys and --eyes out"
        )
    with tempfile.TemporaryDirectory(prefix="mimetic-controls-") as folder:
        found = Path(folder, "controls.npz")
        text = write_by_blender(request, found, blender_python)
        with np.load(found, allow_pickle=False) as arrays:
            names, values = arrays["names"].tolist(), arrays["values"]
    performance = edited(Performance.load(request["performance"]), curves)
    written = CONTROL_TABLES[out.suffix](performance, names, values, out)
    return f"{written}; {text}"
