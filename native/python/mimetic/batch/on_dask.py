# SPDX-License-Identifier: GPL-3.0-or-later
"""A batch on the workers of a Dask cluster, which share storage with each other and with us."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mimetic import InvalidInput, UnreadableMedia
from mimetic.batch.pool import BAD_INPUT, Outcome, Show, outcome_of

CONNECTING = 30.0  # seconds
TICK_SECONDS = 0.2


class TryAgain(RuntimeError):
    """A task failed on a worker in a way that another try may mend."""


@dataclass
class Cluster:
    """The workers of a scheduler; as `pool.Pool`, whose processes are on one machine."""

    address: str
    num_retries: int
    is_stopped: Callable[[], bool] = lambda: False
    ended: Callable[[str, Outcome], None] = lambda _name, _outcome: None  # as each task ends

    def run(
        self,
        out: Path,
        weights: Mapping[str, float],
        show: Show = lambda _fraction, _num_ended: None,
    ) -> dict[str, Outcome]:
        """Runs the tasks of these names in the folder `out` of a batch; returns outcomes.

        A task whose worker is lost goes to another one. Raises InvalidInput without the package
        `distributed`, UnreadableMedia where no scheduler is reached.
        """
        if importlib.util.find_spec("distributed") is None:
            raise InvalidInput(
                "Dask is not installed here: pip install 'mimetic[dask]', as the cluster has it"
            )
        from distributed import Client

        try:
            client = Client(self.address, timeout=CONNECTING, set_as_default=False)
        except (OSError, ValueError) as error:
            raise UnreadableMedia(
                f"--address {self.address}: no scheduler is reached: {error}"
            ) from None
        outcomes: dict[str, Outcome] = {}
        whole = sum(weights.values()) or 1.0
        with client:
            names = {self._begin(client, str(out), name): name for name in weights}
            waiting = set(names)
            while waiting and not self.is_stopped():
                time.sleep(TICK_SECONDS)
                for future in [future for future in waiting if future.done()]:
                    waiting.remove(future)
                    outcomes[names[future]] = _outcome_of(future)
                    self.ended(names[future], outcomes[names[future]])
                show(sum(weights[name] for name in outcomes) / whole, len(outcomes))
            client.cancel(list(waiting))
        return outcomes

    def _begin(self, client: Any, out: str, name: str) -> Any:
        key = f"mimetic-{out}-{name}"
        return client.submit(run_one, out, name, retries=self.num_retries, pure=False, key=key)


def run_one(out: str, name: str) -> tuple[int, str]:
    """On a worker: one task in a process of its own; returns exit status and message.

    Raises TryAgain for what is no bad input: the scheduler then tries again.
    """
    words = ["batch", f"--task={name}", "--out", out, "--end-with-parent"]
    ran = subprocess.Popen(
        [sys.executable, "-m", "mimetic", *words],
        stdin=subprocess.PIPE,  # closes when the worker ends, however it does
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
    )
    assert ran.stderr is not None
    with ran:
        lines = ran.stderr.read().decode(errors="replace").splitlines()[-20:]
        status = ran.wait()
    outcome = outcome_of(status, lines)
    if status not in (0, BAD_INPUT):
        raise TryAgain(outcome.message)
    return status, outcome.message


def _outcome_of(future: Any) -> Outcome:
    error = future.exception()
    if error is None:
        return Outcome(*future.result())
    if isinstance(error, TryAgain):
        return Outcome(1, str(error))
    return Outcome(1, f"Dask gave up: {error}")
