# SPDX-License-Identifier: GPL-3.0-or-later
"""Writing what was captured, where it can be written."""


def save(performance, path: str, spare_path: str) -> tuple[str, list[str]]:
    """Writes a performance; returns where it is, and what the user should know."""
    notes = performance.notes or []
    try:
        performance.save(path)
    except OSError as error:  # minutes of work: not lost for a folder that is read-only
        performance.save(spare_path)
        told = f"{path} cannot be written ({error.strerror}): saved as {spare_path}"
        return spare_path, [told, *notes]
    return path, [*notes]
