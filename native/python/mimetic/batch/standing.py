# SPDX-License-Identifier: GPL-3.0-or-later
"""How a batch's tasks stand: done, failed, or yet to be done."""

from __future__ import annotations

from collections.abc import Mapping

from mimetic.batch.task import Task


class Standing:
    """Remembers which were done, as long as their task.json stays as it was.

    To tell, a task's inputs are read, up to 16 MiB of each: too much to do for all that are done
    whenever some more are.
    """

    def __init__(self) -> None:
        self._done: dict[str, Task] = {}  # by name

    def why_not(self, task: Task, failures: Mapping[str, str]) -> str | None:
        """Why a task failed, the empty string if it is done, None if it is yet to be done.

        failures: by task's name, why it failed; of others that are not done, what task.json says.
        """
        if reason := failures.get(task.name) or task.row.problem or task.error:
            return reason
        return "" if self._has_all(task) else None

    def _has_all(self, task: Task) -> bool:
        if self._done.get(task.name) != task and task.has_all():
            self._done[task.name] = task
        return self._done.get(task.name) == task
