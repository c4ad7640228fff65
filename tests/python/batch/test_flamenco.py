# SPDX-License-Identifier: GPL-3.0-or-later
"""The job type, compiled in node, and the request, by a Manager that checks it."""

import json
import shutil
import subprocess
import sys
import threading
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path

import flamenco_interface
import pytest
from mimetic import InvalidInput, UnreadableMedia
from mimetic.batch import flamenco, plan
from mimetic.batch.clip_list import Row
from mimetic.batch.steps import Settings
from mimetic.batch.task import Task

HARNESS = Path(__file__).with_name("flamenco_manager.js")
MIMETIC = Path(sys.executable).with_name("mimetic")


@pytest.fixture
def batch(tmp_path):
    rows = []
    for name in ("one", "two 'x' \"y\""):
        path = tmp_path / f"{name}.mp4"
        path.write_bytes(b"")
        rows.append(Row(str(path)))
    (tmp_path / "out").mkdir()
    return plan.prepare(tmp_path / "out", rows, Settings(("glb",)))


def compiled(job):
    """(status, what the Manager makes of a job or why it refuses it)."""
    assert shutil.which("node"), "node is not installed; scripts/setup installs it"
    ran = subprocess.run(
        ["node", HARNESS, flamenco.SCRIPT],
        input=json.dumps(job),
        capture_output=True,
        text=True,
        check=False,
    )
    return ran.returncode, json.loads(ran.stdout) if ran.returncode == 0 else ran.stderr


class Manager(BaseHTTPRequestHandler):
    """What the interface documents of two operations."""

    has_type = True
    jobs: list[dict]

    def do_GET(self):
        assert self.path == "/api/v3/jobs/type/mimetic-batch"
        if self.has_type:
            answer = {"name": "mimetic-batch", "label": "Mimetic Batch", "settings": []}
            self.answer(200, answer | {"etag": "tag"})
        else:
            self.answer(404, {"code": 404, "message": "no such job type known"})

    def do_POST(self):
        assert self.path == "/api/v3/jobs"
        assert self.headers["Content-Type"] == "application/json"
        job = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        flamenco_interface.check_job(job)
        if job["type_etag"] != "tag":
            self.answer(412, {"code": 412, "message": "rejecting job because its type is outdated"})
            return
        self.jobs.append(job)
        rest = {"id": "12345678-0000", "created": "", "updated": "", "activity": ""}
        self.answer(200, job | rest | {"status": "under-construction"})

    def answer(self, status, document):
        content = json.dumps(document).encode()
        self.send_response(status)
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, *_):
        pass


@pytest.fixture
def manager():
    handler = type("OneManager", (Manager,), {"jobs": []})
    server = HTTPServer(("127.0.0.1", 0), handler)
    thread = threading.Thread(target=server.serve_forever, args=(0.05,), daemon=True)
    thread.start()
    yield f"http://127.0.0.1:{server.server_port}", handler
    server.shutdown()
    server.server_close()


def test_the_job_type_is_as_the_interface_has_it(batch):
    status, answer = compiled(flamenco.job_of(batch, "mimetic"))
    assert status == 0, answer
    flamenco_interface.check_job_type(answer["type"])
    keys = {setting["key"] for setting in answer["type"]["settings"]}
    assert keys == flamenco.job_of(batch, "mimetic")["settings"].keys()
    assert flamenco.SCRIPT.stem.replace("_", "-") == flamenco.JOB_TYPE  # as the Manager names it


def test_a_clip_is_a_task_and_its_bake_one_that_depends_on_it(batch):
    _, answer = compiled(flamenco.job_of(batch, "/opt/mimetic"))
    tasks = answer["tasks"]
    assert [(task["name"], task["type"]) for task in tasks[:2]] == [
        ("capture one", "misc"),
        ("bake one", "blender"),
    ]
    assert len(tasks) == 4 and tasks[1]["dependencies"] == ["capture one"]
    (command,) = tasks[2]["commands"]
    name = batch.tasks[1].name
    words = ["batch", f"--task={name}", "--out", str(batch.out), "--steps", "capture"]
    assert command == {"name": "exec", "parameters": {"exe": "/opt/mimetic", "args": words}}


def test_without_bakes_there_are_captures_alone(batch):
    for task in batch.tasks:
        task.settings = Settings()
    _, answer = compiled(flamenco.job_of(batch, "mimetic"))
    assert [task["type"] for task in answer["tasks"]] == ["misc", "misc"]


def test_a_batch_of_nothing_is_refused_by_the_script(batch):
    batch.tasks.clear()
    status, reason = compiled(flamenco.job_of(batch, "mimetic"))
    assert status == 1 and "no clips" in reason


def test_blenders_panel_finds_the_clips_by_itself(batch):
    """The expression that Flamenco's add-on evaluates, with the names that it documents."""
    _, answer = compiled(flamenco.job_of(batch, "mimetic"))
    setting = next(one for one in answer["type"]["settings"] if one["key"] == "clips")
    program = (
        "from pathlib import Path; from types import SimpleNamespace\n"
        f"settings = SimpleNamespace(batch={str(batch.out)!r})\nprint({setting['eval']})"
    )
    clips = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert clips.stdout.splitlines() == [task.name for task in batch.tasks]


def test_the_request_is_as_the_interface_has_it(batch, manager):
    address, handler = manager
    assert flamenco.submit(batch, f"{address}/", "mimetic") == "12345678-0000"
    (job,) = handler.jobs
    assert job["type"] == "mimetic-batch" and job["settings"]["batch"] == str(batch.out)


def test_a_manager_without_the_job_type_says_what_to_do(batch, manager):
    address, handler = manager
    handler.has_type = False
    with pytest.raises(InvalidInput, match=r"copy .*mimetic_batch\.js into"):
        flamenco.submit(batch, address, "mimetic")
    assert handler.jobs == []


def test_what_is_no_manager_is_one_line(batch, manager):
    address, handler = manager
    with pytest.raises(InvalidInput, match="such as http"):
        flamenco.submit(batch, "file:///etc/passwd", "mimetic")
    with pytest.raises(UnreadableMedia, match="no Flamenco Manager is reached"):
        flamenco.submit(batch, "http://127.0.0.1:9", "mimetic")
    handler.do_GET = lambda self: self.answer(500, {"code": 500, "message": "out of order"})
    with pytest.raises(UnreadableMedia, match=r"out of order \(500\)"):
        flamenco.submit(batch, address, "mimetic")
    handler.do_GET = lambda self: self.answer(200, ["web page"])
    with pytest.raises(UnreadableMedia, match="no Flamenco Manager's answer"):
        flamenco.submit(batch, address, "mimetic")


def test_its_tasks_give_the_bytes_that_one_machine_gives(
    resumed, clips, mimetic, manager, tmp_path
):
    address, handler = manager
    shutil.copy(clips / "one.mp4", tmp_path)
    out = tmp_path / "out"
    ran = mimetic(
        *("batch", tmp_path / "one.mp4", "--out", out, "--bake", "glb", "--mimetic", MIMETIC),
        *("--submit", "flamenco", "--address", address),
    )
    assert ran.returncode == 0 and "job 12345678-0000" in ran.stdout, ran.stderr
    _, answer = compiled(handler.jobs[0])
    for task in answer["tasks"]:
        (command,) = task["commands"]
        order = [command["parameters"]["exe"], *command["parameters"]["args"]]
        ran = subprocess.run(order, capture_output=True, text=True, check=False)
        assert ran.returncode == 0, ran.stderr
        assert (out / "one" / "face.glb").exists() == (task["type"] == "blender")
    for name in ("performance.npz", "fit.json", "overlay.mp4"):
        assert (out / "one" / name).read_bytes() == (resumed[0] / "one" / name).read_bytes()
    assert Task.load(out / "one").is_all_done()
