"""The end of a run's process: with an answer, or because a call of the FMU does not return."""

from __future__ import annotations

import pickle
import time
from typing import BinaryIO

from waxstudy.simulation.own_process import POLL_S, send


class Watch:
    """Ends the process, with a word, once a call of the FMU takes too long."""

    def __init__(self, longest_s: float, answer: BinaryIO) -> None:
        self.longest_s, self.answer = longest_s, answer
        self.call, self.since_s = "", 0.0

    def begin(self, call: str) -> None:
        self.since_s = time.monotonic()
        self.call = call

    def end(self) -> None:
        self.call = ""

    def look(self) -> None:
        while True:
            time.sleep(POLL_S)
            call = self.call
            if call and time.monotonic() - self.since_s > self.longest_s:
                said = f"the FMU did not return from {call} within longest_silence_s = {self.longest_s:g} s"
                send(self.answer, pickle.dumps((None, said, True)))
