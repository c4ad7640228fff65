# SPDX-License-Identifier: GPL-3.0-or-later
"""The only access to the package `mimetic`, whose compiled module may be missing or not fit."""

from __future__ import annotations

import importlib
import sys
from functools import cache, lru_cache
from types import ModuleType

import numpy as np

from .module_status import (
    State,
    Status,
    extension_version,
    no_module_for,
    not_loaded,
    of_other_version,
    part_missing,
)


@cache
def status() -> Status:
    """Whether the package can be used; asked once a session, as a loaded library stays loaded."""
    try:
        version = importlib.import_module("mimetic").__version__
    except ModuleNotFoundError as error:
        python = f"Python {sys.version_info.major}.{sys.version_info.minor} on {sys.platform}"
        if error.name in ("mimetic", "mimetic._core"):
            return no_module_for(python)
        return part_missing(error.name)
    except ImportError as error:
        return not_loaded(error)
    if version != extension_version():
        return of_other_version(version)
    return Status(State.ready, version)


def problem() -> str:
    """Why nothing can run, or the empty string."""
    return "" if status().state is State.ready else status().text


# The parts of the package that the extension calls, imported when they are first needed


def appearance() -> ModuleType:
    from mimetic.character import appearance

    return appearance


def bone_channels() -> ModuleType:
    from mimetic.retarget import bone_channels

    return bone_channels


def bound_head() -> ModuleType:
    from mimetic.character import bound_head

    return bound_head


def calibration_run() -> ModuleType:
    from mimetic.solve import calibration_run

    return calibration_run


def canonical_head() -> ModuleType:
    from mimetic.character import canonical_head

    return canonical_head


def clip_capture() -> ModuleType:
    from mimetic.solve import clip_capture

    return clip_capture


def clip_fingerprint() -> ModuleType:
    from mimetic.media import clip_fingerprint

    return clip_fingerprint


def correcting() -> ModuleType:
    from mimetic.solve import correcting

    return correcting


def contact_shapes() -> ModuleType:
    from mimetic.character import contact_shapes

    return contact_shapes


def control_object() -> ModuleType:
    from mimetic.character import control_object

    return control_object


def control_names() -> ModuleType:
    from mimetic.retarget import control_names

    return control_names


def controls() -> ModuleType:
    from mimetic.retarget import controls

    return controls


def curve_keys() -> ModuleType:
    from mimetic.character import curve_keys

    return curve_keys


def curve_settings() -> ModuleType:
    from mimetic.character import curve_settings

    return curve_settings


def face_template() -> ModuleType:
    from mimetic.template import face_template

    return face_template


def fingerprint() -> ModuleType:
    from mimetic.shared import fingerprint

    return fingerprint


def face_lines() -> ModuleType:
    from mimetic.report import face_lines

    return face_lines


def fitted_lines() -> ModuleType:
    from mimetic.fit import lines as fitted_lines

    return fitted_lines


def fitting() -> ModuleType:
    from mimetic.fit import fitting

    return fitting


def footage() -> ModuleType:
    from mimetic.media import footage

    return footage


def gaze_shapes() -> ModuleType:
    from mimetic.character import gaze_shapes

    return gaze_shapes


def foreign_face() -> ModuleType:
    from mimetic.character import foreign_face

    return foreign_face


def further_frame() -> ModuleType:
    from mimetic.fit import further_frame

    return further_frame


def gltf() -> ModuleType:
    from mimetic.character import gltf

    return gltf


def head_smoothing() -> ModuleType:
    from mimetic.head import smoothing as head_smoothing

    return head_smoothing


def head_tracking() -> ModuleType:
    from mimetic.head import tracking as head_tracking

    return head_tracking


def known_lens() -> ModuleType:
    from mimetic.fit import known_lens

    return known_lens


def landmarks_file() -> ModuleType:
    from mimetic.character import landmarks_file

    return landmarks_file


def puppet(part: str) -> ModuleType:
    """One of these modules, by its name."""
    from mimetic import puppet
    from mimetic.puppet import (  # noqa: F401
        driven_face,
        live_heads,
        live_thread,
        look_keeper,
        separability,
        taught_look,
        templates,
        usual_looks,
    )

    return getattr(puppet, part)


def library(part: str) -> ModuleType:
    """One of these modules, by its name."""
    from mimetic import library
    from mimetic.library import (  # noqa: F401
        composing,
        cutting,
        expression,
        face_sliders,
        folder,
        preview,
        units,
    )

    return getattr(library, part)


def error_bars() -> ModuleType:
    from mimetic.report import error_bars

    return error_bars


def live_source(is_camera: bool) -> ModuleType:
    from mimetic.puppet import camera_source, clip_source

    return camera_source if is_camera else clip_source


@lru_cache(maxsize=64)
def stillness_figures(stillness: float, fps: float):
    """What a stillness costs and gives: `lag_frames`, `jitter_share`."""
    return core().stillness_figures(stillness, fps)


def live_contact() -> ModuleType:
    from mimetic.character import live_contact

    return live_contact


def core() -> ModuleType:
    from mimetic import _core

    return _core


def live_face() -> ModuleType:
    from mimetic.character import live_face

    return live_face


def performances() -> ModuleType:
    from mimetic.performance import document as performances

    return performances


def picture() -> ModuleType:
    from mimetic.shared import picture

    return picture


def placement() -> ModuleType:
    from mimetic.character import placement

    return placement


def playing() -> ModuleType:
    from mimetic.retarget import playing

    return playing


def projection() -> ModuleType:
    from mimetic.performance import projection

    return projection


def rig_motion() -> ModuleType:
    from mimetic.character import rig_motion

    return rig_motion


def self_landmarks() -> ModuleType:
    from mimetic.character import self_landmarks

    return self_landmarks


def shapes() -> ModuleType:
    from mimetic.character import shapes

    return shapes


def shown_text() -> ModuleType:
    from mimetic.shared import shown_text

    return shown_text


def sparse_curves() -> ModuleType:
    from mimetic.character import sparse_curves

    return sparse_curves


def stabilisation() -> ModuleType:
    from mimetic.character import stabilisation

    return stabilisation


def strain_map() -> ModuleType:
    from mimetic.character import strain_map

    return strain_map


def take_facts() -> ModuleType:
    from mimetic.performance import take_facts

    return take_facts


def timing() -> ModuleType:
    from mimetic.media import timing

    return timing


def unit_fit() -> ModuleType:
    from mimetic.retarget import unit_fit

    return unit_fit


def whole_file() -> ModuleType:
    from mimetic.shared import whole_file

    return whole_file


def array(matrix):
    """A matrix of Blender's as the package takes them."""
    return np.array(matrix, dtype=np.float64)


def known_errors() -> tuple[type[Exception], ...]:
    """What bad input raises, with a text that is fit to show."""
    package = importlib.import_module("mimetic")
    return (package.InvalidInput, package.UnreadableMedia, OSError)


def invalid_input(text: str) -> Exception:
    """What to raise for bad input; among `known_errors`."""
    return importlib.import_module("mimetic").InvalidInput(text)
