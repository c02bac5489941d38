"""The end of a run's process where a call of its engine does not return."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

from waxstudy.simulation.own_process import POLL_S


class Watch:
    """Calls `give_up` with the name of a call that takes too long, from a thread of its own."""

    def __init__(self, longest_s: float, give_up: Callable[[str], None]) -> None:
        self.longest_s, self.give_up = longest_s, give_up
        self.call, self.since_s = "", 0.0
        self.progress: Callable[[], int] = int  # a number that changes while calls go on without being told of
        threading.Thread(target=self._look, daemon=True).start()

    def begin(self, call: str) -> None:
        self.since_s = time.monotonic()
        self.call = call

    def end(self) -> None:
        self.call = ""

    def _look(self) -> None:
        seen = self.progress()
        while True:
            time.sleep(POLL_S)
            if seen != (seen := self.progress()):
                self.since_s = time.monotonic()
            call = self.call
            if call and time.monotonic() - self.since_s > self.longest_s:
                self.give_up(call)
