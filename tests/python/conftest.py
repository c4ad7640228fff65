# SPDX-License-Identifier: GPL-3.0-or-later
import signal
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
# fuzz and fetched_footage; evaluation
sys.path[:0] = [str(HERE.parents[n]) for n in (0, 1)]
# A shell starts what runs in its background with Ctrl-C ignored, and so would the commands that
# tests send one to
signal.signal(signal.SIGINT, signal.default_int_handler)


# What takes half a minute and more comes first, the longest before all: of two processors, neither
# is to have one of these alone at the end
LONGEST = (
    *("batch/", "evaluation/test_real_clips.py", "evaluation/test_abuse.py"),
    *("solve/test_pipeline.py", "solve/test_refining.py", "puppet/test_look_keeper.py"),
    *("solve/test_before_the_face.py", "locate/test_occlusion.py", "fit/", "solve/", "puppet/"),
)


def pytest_collection_modifyitems(items):
    def rank(item) -> int:
        name = item.path.as_posix().removeprefix(f"{HERE.as_posix()}/")
        return next((i for i, place in enumerate(LONGEST) if name.startswith(place)), len(LONGEST))

    items.sort(key=rank)  # stable: a file's tests stay in their order


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """By file with `--dist loadfile`, and all of `batch` together: one batch serves its files."""
    if config.getvalue("dist") != "loadfile":
        return None
    from xdist.scheduler import LoadFileScheduling

    class ByFile(LoadFileScheduling):
        def _split_scope(self, nodeid):
            file = super()._split_scope(nodeid)
            folder = file.rpartition("/")[0]
            return folder if folder.endswith("/batch") else file

    return ByFile(config, log)


@pytest.fixture(autouse=True, scope="session")
def same_people():
    from people_attached import people_attached_once

    with people_attached_once():
        yield


@pytest.fixture
def hangup_heard():
    """For a test that sends SIGHUP, which is ignored in tests that nohup runs."""
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGHUP, before)


@pytest.fixture(scope="session")
def rendered_clip():
    """A rendered head that raises its brows and opens its mouth: `.footage`, `.truth` paths.

    50 frames of 320 x 240. Rendered by Blender in about 20 s the first time, then taken from the
    cache; never fetched.
    """
    from mimetic.template.face_template import load_template

    from evaluation.synthetic.clips import clip
    from evaluation.synthetic.recipes import TEST

    return clip(TEST, load_template())


@pytest.fixture(scope="session")
def rest_fit(rendered_clip):
    """The fit of that clip in the frame that is taken as rest, found once for all tests."""
    from mimetic.solve.clip_capture import find_face

    return find_face(rendered_clip.footage)


@pytest.fixture(scope="session")
def captured_clip(rendered_clip, rest_fit):
    """The capture of that whole clip with that fit."""
    from mimetic.solve.clip_capture import capture

    return capture(rendered_clip.footage, fit=rest_fit)


@pytest.fixture(scope="session")
def fit_of_frame_3(rendered_clip):
    """The fit of that clip with frame 3 as rest, which was asked for."""
    from mimetic.solve.clip_capture import find_face

    return find_face(rendered_clip.footage, frame=3)


@pytest.fixture(scope="session")
def fetched_clip():
    """Path of a clip of scripts/fetch_footage by its name, fetched if missing."""
    from fetched_footage import fetched_clip

    return fetched_clip


@pytest.fixture
def performance():
    """A made-up performance of 40 frames."""
    from sample_performance import make_performance

    return make_performance(num_frames=40)


@pytest.fixture
def truth(performance):
    """Truth that the made-up performance explains exactly."""
    from sample_truth import make_truth

    return make_truth(performance)
