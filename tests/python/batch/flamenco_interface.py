# SPDX-License-Identifier: GPL-3.0-or-later
"""What Flamenco's published interface (OpenAPI, /api/v3) says of jobs, as far as we use it.

Written after `SubmittedJob`, `AvailableJobType` and `AvailableJobSetting` of flamenco-openapi.yaml,
which every Manager serves under "API".
"""

# Field: its type; fields that are required
SUBMITTED_JOB = {
    "name": str,
    "type": str,
    "type_etag": str,
    "priority": int,
    "settings": dict,
    "metadata": dict,
    "submitter_platform": str,
    "storage": dict,
    "worker_tag": str,
}
SUBMITTED_JOB_REQUIRED = {"name", "type", "priority", "submitter_platform"}
JOB_TYPE = {"name": str, "label": str, "description": str, "settings": list, "etag": str}
JOB_TYPE_REQUIRED = {"label", "settings"}  # of the script; the Manager adds name and etag
SETTING = {
    "key": str,
    "type": str,
    "subtype": str,
    "choices": list,
    "propargs": dict,
    "description": str,
    "default": object,
    "eval": str,
    "evalInfo": dict,
    "visible": str,
    "required": bool,
    "editable": bool,
}
SETTING_REQUIRED = {"key", "type"}
SETTING_TYPES = {"string": str, "int32": int, "float": float, "bool": bool}
SUBTYPES = {"file_path", "dir_path", "file_name", "hashed_file_path"}
VISIBILITIES = {"visible", "hidden", "submission", "web"}


def check(document, fields, required) -> None:
    """Asserts that a document has what the interface asks for, and nothing else."""
    assert required <= document.keys() <= fields.keys(), document.keys()
    for name, value in document.items():
        assert isinstance(value, fields[name]), name


def check_job(job) -> None:
    check(job, SUBMITTED_JOB, SUBMITTED_JOB_REQUIRED)
    assert all(isinstance(value, str) for value in job.get("metadata", {}).values())
    # No nested structures are supported as settings
    assert all(isinstance(value, str | int | float | bool) for value in job["settings"].values())


def check_job_type(job_type) -> None:
    check(job_type, JOB_TYPE, JOB_TYPE_REQUIRED)
    for setting in job_type["settings"]:
        check(setting, SETTING, SETTING_REQUIRED)
        assert isinstance(setting.get("default", SETTING_TYPES[setting["type"]]()), object)
        if "default" in setting:
            assert type(setting["default"]) is SETTING_TYPES[setting["type"]]
        assert setting.get("subtype", "file_path") in SUBTYPES
        assert setting.get("visible", "visible") in VISIBILITIES
