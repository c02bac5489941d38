"""The blocks of one case made ready: their parameters and states, in Python and in memory for the compiled loop."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Any

import numpy as np

from waxstudy.plugin import CHAIN, Block
from waxstudy.plugin.registry import described
from waxstudy.simulation.interpreted import Callback, SimulationError, boxed
from waxstudy.simulation.records import parameter_record, plain_parameters, state_problem, state_record
from waxstudy.study.model import Choice


class Chain:
    """The blocks of one case, ready to run."""

    def __init__(self, blocks: Mapping[str, Choice], step_s: float) -> None:
        self.blocks: list[type[Block] | None] = [None] * len(CHAIN)
        self.plain: list[Any] = [()] * len(CHAIN)
        for kind, choice in blocks.items():
            place = CHAIN.index(kind)
            assert issubclass(choice.component, Block)
            self.blocks[place] = choice.component
            self.plain[place] = plain_parameters(choice.parameters)
        self.step_s = step_s
        ports = [block.output if block else None for block in self.blocks]
        self.low = np.array([port.low if port else 0.0 for port in ports])
        self.high = np.array([port.high if port else 0.0 for port in ports])

    def start(self) -> list[Any]:
        """Return fresh state objects, 0 where the chain has no block."""
        pairs = zip(self.blocks, self.plain, strict=True)
        return [self._started(block, plain) if block else 0 for block, plain in pairs]

    def _started(self, block: type[Block], plain: Any) -> Any:
        try:
            state = copy.deepcopy(block.start(plain, self.step_s))  # so that no two chains share what a class holds
            problem = "" if isinstance(state, block.State) else f"its start gave {state!r}, not its State"
        except Exception as error:
            problem = f"its start failed: {described(error)}"
        if problem := problem or state_problem(state):
            raise SimulationError(f"{block.kind} '{block.name}': {problem}")
        return state

    def refuse_odd_states(self, states: list[Any]) -> None:
        """Raise `SimulationError` for what a step did to its state in Python that compiled code would not have done."""
        for block, state in zip(self.blocks, states, strict=True):
            if block and (problem := state_problem(state)):
                raise SimulationError(f"{block.kind} '{block.name}': {problem}")


class CompiledChain:
    """A chain's code, parameters and states as addresses for the compiled loop.

    A block that cannot be compiled is called back in Python; `warnings` says which, and why.
    """

    def __init__(self, chain: Chain) -> None:
        self.chain = chain
        self.warnings: list[str] = []
        self.callbacks: dict[int, Callback] = {}
        self.addresses = np.array([self._address(place) for place in range(len(CHAIN))], dtype=np.int64)
        self._parameters = [
            boxed(plain) if place in self.callbacks else parameter_record(plain)
            for place, plain in enumerate(chain.plain)
        ]
        self._intact = [record.tobytes() for record in self._parameters]
        self.parameters = np.array([record.ctypes.data for record in self._parameters], dtype=np.int64)

    def _address(self, place: int) -> int:
        from waxstudy.simulation.compiled import address
        from waxstudy.simulation.typed import CannotCompile

        block = self.chain.blocks[place]
        if block is None:
            return 0
        try:
            return address(block, self.chain.plain[place])
        except CannotCompile as error:
            slow = f"{block.kind} '{block.name}' cannot be compiled and runs in Python, many times slower: {error}"
            self.warnings.append(slow)
            self.callbacks[place] = Callback(block)
            return self.callbacks[place].address

    def start(self) -> list[np.ndarray | None]:
        """Return fresh states in memory, None where the chain has no block."""
        states = enumerate(self.chain.start())
        return [self._stored(place, state) if self.chain.blocks[place] else None for place, state in states]

    def _stored(self, place: int, state: Any) -> np.ndarray:
        return boxed(state) if place in self.callbacks else state_record(state)

    def failed(self, states: list[np.ndarray | None]) -> int | None:
        """Return the place of a block that changed its parameters, or in Python its state's form; else None."""
        for place, (record, intact) in enumerate(zip(self._parameters, self._intact, strict=True)):
            if record.tobytes() != intact:
                return place
        for place in self.callbacks:
            box = states[place]
            if box is not None and state_problem(box[0]):
                return place
        return None
