# SPDX-License-Identifier: GPL-3.0-or-later
"""A batch as an Open Job Description template, which Deadline Cloud and others run.

https://github.com/OpenJobDescription/openjd-specifications, version jobtemplate-2023-09
"""

from __future__ import annotations

from pathlib import Path

from mimetic.batch.plan import TEMPLATE, Batch
from mimetic.shared.json_file import write_json

MOST_VALUES = 1024  # of a task parameter
LONGEST_NAME = 64


def write_template(batch: Batch, program: str) -> Path:
    """Writes the template in the batch's folder and returns its path; raises OSError.

    program: how workers call Mimetic.
    """
    path = batch.out / TEMPLATE
    write_json(path, template(batch, program))
    return path


def template(batch: Batch, program: str) -> dict:
    """A step with a task for each clip; in parts, where there are more than a step may have."""
    names = [task.name for task in batch.tasks]
    parts = [names[i : i + MOST_VALUES] for i in range(0, len(names), MOST_VALUES)]
    return {
        "specificationVersion": "jobtemplate-2023-09",
        "name": f"Mimetic {batch.out.name}"[:LONGEST_NAME],
        "parameterDefinitions": [
            {
                "name": "Batch",
                "type": "PATH",
                "objectType": "DIRECTORY",
                "dataFlow": "NONE",  # nothing is uploaded: storage is shared
                "default": ".",  # as seen from the template
                "description": "The folder that mimetic batch prepared, on storage that all share",
            },
            {
                "name": "Mimetic",
                "type": "STRING",
                "default": program,
                "description": "The program mimetic, as workers find it",
            },
        ],
        "steps": [_step(f"Clips {i + 1}", part) for i, part in enumerate(parts)],
    }


def _step(name: str, clips: list[str]) -> dict:
    arguments = ["batch", "--task={{Task.Param.Clip}}", "--out", "{{Param.Batch}}"]
    return {
        "name": name,
        "parameterSpace": {
            "taskParameterDefinitions": [{"name": "Clip", "type": "STRING", "range": clips}]
        },
        "script": {"actions": {"onRun": {"command": "{{Param.Mimetic}}", "args": arguments}}},
    }
