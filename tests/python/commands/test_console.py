# SPDX-License-Identifier: GPL-3.0-or-later
"""What is said of work is no part of it: none fails because its progress cannot be written."""

import io
import os
import subprocess
import sys

import pytest
from mimetic.commands import cli, console
from sample_performance import make_performance

TELL = """
import sys
from mimetic.commands import cli, console
from mimetic import __main__ as program
console.PLAIN_EVERY = 0.0
class Work:
    add_arguments = staticmethod(lambda parser: None)
    @staticmethod
    def run_work(_arguments):
        with console.Console() as at_work:
            for i in range(2000):
                at_work.show(i / 2000, "at work " * 20)
                at_work.tell("more than a pipe holds " * 20)
        open("result", "w").write("done")
        return 0
sys.modules["work"] = Work
cli.COMMANDS["work"] = ("work", "works")
sys.argv = ["mimetic", "work"]
sys.exit(program.main())
"""


@pytest.mark.parametrize("stream", ["2>&1 | head -1", "2>/dev/full", "2>&-", ">&- 2>&- <&-"])
def test_work_is_done_whoever_hears_of_it(tmp_path, stream):
    shell = 'set -o pipefail; "$0" -c "$1" ' + stream
    ran = subprocess.run(["bash", "-c", shell, sys.executable, TELL], cwd=tmp_path)
    assert ran.returncode == 0
    assert (tmp_path / "result").read_text() == "done"


class Broken(io.StringIO):
    """A stream that nobody reads any more."""

    def __init__(self, is_terminal):
        super().__init__()
        self.num_tries, self._is_terminal = 0, is_terminal

    def isatty(self):
        return self._is_terminal

    def write(self, _text):
        self.num_tries += 1
        raise BrokenPipeError(32, "Broken pipe")


@pytest.mark.parametrize("is_terminal", [False, True])
def test_after_the_first_failure_nothing_more_is_written(monkeypatch, is_terminal):
    stream = Broken(is_terminal)
    monkeypatch.setattr(sys, "stderr", stream)
    monkeypatch.setattr(console, "PLAIN_EVERY", 0.0)
    with console.Console() as at_work:
        for i in range(5):
            at_work.tell("a line")
            at_work.show(i / 5, "at work")
    if not is_terminal:
        assert stream.num_tries == 1


def test_without_a_stream_nothing_is_said(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(sys, "stderr", None)
    assert cli.main(["info", str(tmp_path / "none.npz")]) == 2
    make_performance().save(tmp_path / "p.npz")
    assert cli.main(["info", str(tmp_path / "p.npz")]) == 0
    assert "12 in all" in capsys.readouterr().out


def test_no_result_gets_the_number_of_a_closed_stream(tmp_path):
    code = "import sys; from mimetic import __main__ as m; sys.argv[1:] = ['--version']; m.main();"
    code += " print(open('result', 'w').fileno())"
    shell = '"$0" -c "$1" <&- 2>&-'
    ran = subprocess.run(
        ["bash", "-c", shell, sys.executable, code], cwd=tmp_path, capture_output=True, text=True
    )
    assert int(ran.stdout.split()[-1]) > 2


@pytest.fixture
def checkout(tmp_path):
    """A folder with scripts/mimetic, and a setup that says where it is."""
    scripts = tmp_path / "checkout" / "scripts"
    scripts.mkdir(parents=True)
    here = os.path.dirname(os.path.realpath(__file__))
    own = os.path.join(here, *[os.pardir] * 3, "scripts", "mimetic")
    with open(own, encoding="utf-8") as stream:
        (scripts / "mimetic").write_text(stream.read())
    (scripts / "setup").write_text('#!/bin/sh\necho "setup: $0" >&2\nexit 3\n')
    for name in ("mimetic", "setup"):
        (scripts / name).chmod(0o755)
    (tmp_path / "elsewhere" / "scripts").mkdir(parents=True)
    (tmp_path / "link").symlink_to(scripts / "mimetic")
    return tmp_path / "checkout"


@pytest.mark.parametrize("called", ["scripts/mimetic", "./scripts/mimetic", "../link"])
def test_the_script_finds_its_checkout_however_it_is_called(checkout, called):
    ran = subprocess.run(
        ["bash", "-c", f"{called} info"],
        cwd=checkout,
        env={**os.environ, "CDPATH": f"{checkout.parent / 'elsewhere'}:."},
        capture_output=True,
        text=True,
    )
    assert (ran.returncode, ran.stdout) == (3, "")
    assert ran.stderr == f"setup: {checkout.resolve()}/scripts/setup\n"


def test_the_script_works_with_nobody_to_tell(checkout):
    (checkout / "scripts" / "setup").write_text("#!/bin/sh\necho setup >&2 && exit 4\n")
    ran = subprocess.run(["bash", "-c", "scripts/mimetic info 2>&-"], cwd=checkout)
    assert ran.returncode == 4
