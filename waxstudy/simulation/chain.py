"""The blocks of one case made ready: their parameters and states, in Python and in memory for the compiled loop."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from types import MappingProxyType
from typing import Any

import numpy as np

from waxstudy.plugin import CHAIN, Block, SimulationError
from waxstudy.plugin.registry import PluginError, described
from waxstudy.plugin.structure import port_problems
from waxstudy.simulation.interpreted import Callback, checked
from waxstudy.simulation.records import (
    parameter_record,
    plain_parameters,
    state_dtype,
    state_problem,
    state_record,
)
from waxstudy.study.model import Choice


class Chain:
    """The blocks of one case, ready to run; `begins`: numbers of states that start otherwise, by kind and name."""

    def __init__(
        self,
        blocks: Mapping[str, Choice],
        step_s: float,
        begins: Mapping[str, Mapping[str, float]] = MappingProxyType({}),
    ) -> None:
        self.blocks: list[type[Block] | None] = [None] * len(CHAIN)
        self.plain: list[Any] = [()] * len(CHAIN)
        for kind, choice in blocks.items():
            place = CHAIN.index(kind)
            assert issubclass(choice.component, Block)
            self.blocks[place] = _sound(choice.component)  # type: ignore[arg-type]  # a class is hashable
            self.plain[place] = plain_parameters(choice.parameters)
        self.step_s, self.begins = step_s, begins
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
        except (Exception, SystemExit) as error:
            problem = f"its start failed: {described(error)}"
        if problem := problem or state_problem(state):
            raise SimulationError(f"{block.kind} '{block.name}': {problem}")
        for name, value in self.begins.get(block.kind, {}).items():
            setattr(state, name, value)
        return state

    def odd_state(self, states: list[Any]) -> int | None:
        """Return the place of a block that in Python made its state what compiled code could not, or None."""
        places = (place for place, block in enumerate(self.blocks) if block and state_problem(states[place]))
        return next(places, None)


class Stepped:
    """One block on its own with its state, run in Python step by step."""

    def __init__(self, choice: Choice, step_s: float) -> None:
        kind, self.step_s = choice.component.kind, step_s
        chain, place = Chain({kind: choice}, step_s), CHAIN.index(kind)
        block = chain.blocks[place]
        assert block
        self._step, self._plain, self._state = checked(block), chain.plain[place], chain.start()[place]

    def step(self, u: float, time_s: float) -> float:
        return self._step(self._plain, self._state, u, time_s, self.step_s)


@cache
def _sound(block: type[Block]) -> type[Block]:
    """Return a block; raise `PluginError` where memory or loop could not rely on what it declares."""
    problems = [*port_problems(block)]
    try:
        state_dtype(block.State)
    except (TypeError, NameError) as error:
        problems.append(str(error))
    for problem in problems:
        raise PluginError(f"{block.kind} '{block.name}': {problem}")
    return block


class CompiledChain:
    """A chain's code, parameters and states as addresses for the compiled loop.

    A block that cannot be compiled is called back in Python; `warnings` says which, and why.
    """

    def __init__(self, chain: Chain) -> None:
        from waxstudy.simulation.compiled import loop

        self.chain = chain
        self.warnings: list[str] = []
        self.callbacks: dict[int, Callback] = {}
        loop()  # compiled here, so that threads only compute
        self.addresses = np.array([self._address(place) for place in range(len(CHAIN))], dtype=np.int64)
        self._parameters = self._stored(chain.plain, parameter_record)
        self._intact = [record.tobytes() if isinstance(record, np.ndarray) else b"" for record in self._parameters]
        self.parameters = self.pointers(self._parameters)

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

    def start(self) -> list[Any]:
        """Return fresh states: memory for compiled blocks, objects for those in Python, None for no block."""
        states = [state if block else None for block, state in zip(self.chain.blocks, self.chain.start(), strict=True)]
        return self._stored(states, state_record)

    def _stored(self, values: Iterable[Any], record: Callable[[Any], np.ndarray]) -> list[Any]:
        return [v if v is None or place in self.callbacks else record(v) for place, v in enumerate(values)]

    def pointers(self, stored: Iterable[Any]) -> np.ndarray:
        """Return the addresses of parameters or states; a Python object's is its id."""
        places = [0 if v is None else v.ctypes.data if isinstance(v, np.ndarray) else id(v) for v in stored]
        return np.array(places, dtype=np.int64)

    def failed(self, states: list[Any]) -> int | None:
        """Return the place of a block that changed its parameters, or in Python its state's form; else None."""
        for place, (stored, intact) in enumerate(zip(self._parameters, self._intact, strict=True)):
            if intact and stored.tobytes() != intact:
                return place
        return next((place for place in self.callbacks if state_problem(states[place])), None)
