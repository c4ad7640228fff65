# SPDX-License-Identifier: GPL-3.0-or-later
"""A batch as a job of Flamenco, by the HTTP interface of its Manager (OpenAPI, version 3).

The job type is `mimetic_batch.js` beside this file, which goes into the Manager's folder `scripts`.
"""

from __future__ import annotations

import json
import sys
import urllib.error
import urllib.parse
import urllib.request
from pathlib import Path
from typing import Any

from mimetic import InvalidInput, UnreadableMedia
from mimetic.batch.plan import Batch
from mimetic.shared.json_file import parse_json
from mimetic.shared.shown_text import shortened

SCRIPT = Path(__file__).with_name("mimetic_batch.js")
JOB_TYPE = "mimetic-batch"  # as the Manager names the type of that script
PRIORITY = 50
PLATFORMS = {"linux": "linux", "darwin": "darwin", "win32": "windows"}
TIMEOUT = 30.0  # seconds
LARGEST_ANSWER = 64 << 20  # bytes: it holds the clips' names


def submit(batch: Batch, address: str, program: str) -> str:
    """Submits the job to the Manager at an address; returns the job's identifier.

    Raises InvalidInput for an address that is none, or a Manager without the job type,
    UnreadableMedia where the Manager is not reached or refuses.
    """
    base = _checked(address)
    try:
        job_type = _request(f"{base}/api/v3/jobs/type/{JOB_TYPE}")
    except urllib.error.HTTPError as error:
        if error.code != 404:
            raise UnreadableMedia(f"{address}: {_reason(error)}") from None
        raise InvalidInput(
            f"the Flamenco Manager at {address} has no job type {JOB_TYPE}: copy {SCRIPT} into the "
            "folder 'scripts' beside flamenco-manager"
        ) from None
    job = job_of(batch, program) | {"type_etag": str(job_type.get("etag", ""))}
    try:
        answer = _request(f"{base}/api/v3/jobs", job)
    except urllib.error.HTTPError as error:
        raise UnreadableMedia(f"{address} refuses the job: {_reason(error)}") from None
    return str(answer.get("id", ""))


def job_of(batch: Batch, program: str) -> dict[str, Any]:
    """What the interface calls a SubmittedJob."""
    return {
        "name": f"Mimetic {batch.out.name}",
        "type": JOB_TYPE,
        "priority": PRIORITY,
        "submitter_platform": PLATFORMS.get(sys.platform, "linux"),
        "settings": {
            "batch": str(batch.out),
            "clips": "\n".join(task.name for task in batch.tasks),
            "has_bakes": any(len(task.steps()) > 1 for task in batch.tasks),
            "mimetic": program,
        },
        "metadata": {"project": "Mimetic"},
    }


def _checked(address: str) -> str:
    parts = urllib.parse.urlsplit(address)
    if parts.scheme not in ("http", "https") or not parts.hostname:
        raise InvalidInput(
            f"--address {address}: give the Manager's address, such as http://manager:8080"
        )
    return address.rstrip("/")


def _request(url: str, document: dict[str, Any] | None = None) -> dict[str, Any]:
    """The answer to a GET, or to a POST of a document; raises HTTPError, UnreadableMedia."""
    data = None if document is None else json.dumps(document).encode()
    request = urllib.request.Request(url, data, {"Content-Type": "application/json"})
    try:
        with urllib.request.urlopen(request, timeout=TIMEOUT) as answer:
            content = answer.read(LARGEST_ANSWER)
        reply = parse_json(content)
    except urllib.error.HTTPError:
        raise
    except OSError as error:
        reason = getattr(error, "reason", error)
        raise UnreadableMedia(f"{url}: no Flamenco Manager is reached: {reason}") from None
    except InvalidInput:
        raise UnreadableMedia(f"{url}: this is no Flamenco Manager's answer") from None
    if not isinstance(reply, dict):
        raise UnreadableMedia(f"{url}: this is no Flamenco Manager's answer")
    return reply


def _reason(error: urllib.error.HTTPError) -> str:
    """The Manager's own words, else HTTP's."""
    try:
        document = parse_json(error.read(1 << 16))
        message = document["message"]  # type: ignore[index]
    except (InvalidInput, OSError, KeyError, TypeError):
        message = error.reason
    return shortened(f"{message} ({error.code})")
