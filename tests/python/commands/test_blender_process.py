# SPDX-License-Identifier: GPL-3.0-or-later
"""What a Blender that fails is told as: by a program in its place."""

import errno
import shutil
import sys
from typing import NamedTuple

import pytest
from mimetic import InvalidInput
from mimetic.commands.blender_process import write_by_blender


class Usage(NamedTuple):
    total: int
    used: int
    free: int


OTHER_BLENDER = """#!{python}
import json, sys
request = json.loads(sys.stdin.readline())
answer = {answer}
if answer is None:
    for line in ("Traceback (most recent call last):", "  save(out)", "  ^^^^~~^^^", "Error: no"):
        print(line)
    sys.exit(3)
for name in ("failed", "file", "error"):
    if answer.get(name):
        answer[name] = answer[name].replace("OUT", request["out"])
open(request["answer"], "w").write(json.dumps(answer))
"""


@pytest.fixture
def blender(tmp_path):
    """Makes a program that answers like this, or ends badly if None."""

    def blender(answer):
        program = tmp_path / "blender"
        program.write_text(OTHER_BLENDER.format(python=sys.executable, answer=repr(answer)))
        program.chmod(0o755)
        return program

    return blender


@pytest.fixture
def out(tmp_path):
    """A result's name in a folder of its own."""
    folder = tmp_path / "results"
    folder.mkdir()
    return folder / "face.glb"


def refused(text, number=None, file=None):
    return {"failed": text, "number": number, "file": file}


@pytest.mark.parametrize("suffix", [".glb", ".blend"])
@pytest.mark.parametrize("file", [None, "OUT"])
def test_what_the_system_refuses_is_an_error_of_the_system(blender, out, suffix, file):
    out = out.with_suffix(suffix)
    answer = refused("No space left on device", errno.ENOSPC, file)
    with pytest.raises(OSError) as failure:
        write_by_blender({}, out, blender(answer))
    assert (failure.value.errno, failure.value.filename) == (errno.ENOSPC, str(out))
    assert list(out.parent.iterdir()) == []


def test_what_an_exporter_says_without_a_number_names_the_result(blender, out):
    with pytest.raises(OSError) as failure:
        write_by_blender({}, out, blender(refused("OUT: wrote nothing")))
    assert str(failure.value) == f"{out}: wrote nothing"


def test_bad_input_stays_bad_input(blender, out):
    with pytest.raises(InvalidInput, match="no object"):
        write_by_blender({}, out, blender({"error": "no object"}))


@pytest.mark.parametrize("suffix", [".glb", ".blend"])
def test_a_blender_that_fails_on_a_full_disk_says_so(blender, out, suffix, monkeypatch):
    out = out.with_suffix(suffix)
    free = 2_100_000

    def disk_usage(folder):
        return Usage(0, 0, free if out.parent in (folder, folder.parent) else 1 << 30)

    monkeypatch.setattr(shutil, "disk_usage", disk_usage)
    program = blender(None)
    with pytest.raises(OSError) as failure:
        write_by_blender({}, out, program)
    assert (failure.value.errno, failure.value.filename) == (errno.ENOSPC, str(out))
    assert failure.value.strerror.startswith("No space left on device, as it seems (2.1 MB")
    assert failure.value.strerror.endswith("(most recent call last):\n  save(out)\nError: no")
    free = 1 << 30
    with pytest.raises(OSError, match=r"^Blender failed \(exit status 3\)") as failure:
        write_by_blender({}, out, program)
    assert failure.value.errno is None


def test_a_rigs_copy_wants_as_much_space_as_the_rig(blender, out, tmp_path, monkeypatch):
    rig = tmp_path / "rig.blend"
    with open(rig, "wb") as stream:
        stream.truncate(200_000_000)
    monkeypatch.setattr(shutil, "disk_usage", lambda folder: Usage(0, 0, 100_000_000))
    target = {"file": str(rig), "object": "Hero"}
    with pytest.raises(OSError, match="No space left on device"):
        write_by_blender({"target": target}, out.with_suffix(".blend"), blender(None))
