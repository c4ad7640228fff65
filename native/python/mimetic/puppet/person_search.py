# SPDX-License-Identifier: GPL-3.0-or-later
"""While a face is followed already: a better one of it, from the first seconds, in the background.

The first picture may show any expression, which a fit takes for the person's rest. As a capture
does, the search judges pictures of the first seconds (`LiveHeads.judge`), and takes the head of the
one most at rest: fitted to it, with muscles attached, or, of a person who is known, placed there
alone.
"""

from __future__ import annotations

import queue
import threading

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput
from mimetic.puppet.live_face import LiveFace
from mimetic.puppet.live_heads import Judgement, LiveHeads

Image = NDArray[np.uint8]


class PersonSearch:
    """One search; pictures are offered to it, until `result` has a face or it gives up.

    in_background: judge, fit and attach in a thread; otherwise in `offer`, which then takes as long
    as that does. heads: that make the face of a picture.
    """

    def __init__(
        self, heads: LiveHeads, in_background: bool = True, num_judged: int | None = None
    ) -> None:
        self._heads = heads
        self._seconds, usual_number = heads.search
        self.result: LiveFace | None = None
        self.is_over = False
        self._num_judged, self._num_offered = num_judged or usual_number, 0
        self._start: float | None = None
        self._judged: list[tuple[Judgement, Image]] = []
        self._offered: queue.Queue[Image | None] = queue.Queue(maxsize=1)
        self._thread: threading.Thread | None = None
        if in_background:
            self._thread = threading.Thread(target=self._work, name="person", daemon=True)
            self._thread.start()

    def offer(self, image: Image, time: float) -> None:
        """A picture that shows the face; most are passed over. time: seconds."""
        self._start = time if self._start is None else self._start
        due = self._start + self._seconds * self._num_offered / self._num_judged
        if self.is_over or self._num_offered >= self._num_judged or time < due:
            return
        if self._thread is None:
            self._num_offered += 1
            self._take(image)
        elif not self._offered.full():
            self._num_offered += 1
            self._offered.put_nowait(image)

    def stop(self) -> None:
        """The result is not wanted any more; waits for what is begun."""
        self.is_over = True
        if self._thread is not None:
            if not self._offered.full():
                self._offered.put_nowait(None)
            self._thread.join()

    def _work(self) -> None:
        while not self.is_over:
            image = self._offered.get()
            if image is not None:
                self._take(image)

    def _take(self, image: Image) -> None:
        judged = self._heads.judge(image)
        if judged is not None:
            self._judged.append((judged, image))
        if self._num_offered >= self._num_judged:
            self.result = self._best() if self._judged else None
            self._judged.clear()
            self.is_over = True

    def _best(self) -> LiveFace | None:
        for i in self._heads.most_at_rest([judged for judged, _ in self._judged]):
            image = self._judged[i][1]
            try:
                return self._heads.own(image)
            except InvalidInput:  # no head fits, or too little of it is seen: the next best
                continue
        return None
