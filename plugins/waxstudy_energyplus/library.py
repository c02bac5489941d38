"""EnergyPlus' C API by ctypes: the library, its callbacks, its variables and actuators.

The process of a run loads this and little else: whatever it imports is paid for in every run.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from pathlib import Path

from waxstudy.simulation.watch import Watch

LONGEST_SILENCE_S = 600.0  # shadows of a large model take a minute or two
MODEL, WEATHER = "room.epJSON", "year.epw"  # in the folder of a run
RUN_PERIOD = 3  # of the kinds of simulation
_STATE, _TEXT, _NUMBER, _INT = ctypes.c_void_p, ctypes.c_char_p, ctypes.c_double, ctypes.c_int
_CALLBACK = ctypes.CFUNCTYPE(None, _STATE)
# name -> what it returns and takes after the state
_FUNCTIONS = {
    "stateNew": (_STATE, None),
    "stateDelete": (None, []),
    "energyplus": (_INT, [_INT, ctypes.POINTER(_TEXT)]),
    "stopSimulation": (None, []),
    "setConsoleOutputState": (None, [_INT]),
    "setEnergyPlusRootDirectory": (None, [_TEXT]),
    "apiDataFullyReady": (_INT, []),
    "apiErrorFlag": (_INT, []),
    "warmupFlag": (_INT, []),
    "kindOfSim": (_INT, []),
    "requestVariable": (None, [_TEXT, _TEXT]),
    "getVariableHandle": (_INT, [_TEXT, _TEXT]),
    "getVariableValue": (_NUMBER, [_INT]),
    "getActuatorHandle": (_INT, [_TEXT, _TEXT, _TEXT]),
    "setActuatorValue": (None, [_INT, _NUMBER]),
    "getInternalVariableHandle": (_INT, [_TEXT, _TEXT]),
    "getInternalVariableValue": (_NUMBER, [_INT]),
}
# moments of a zone time step, in the order in which they come
BEFORE_WEATHER = "callbackBeginZoneTimestepBeforeSetCurrentWeather"
BEFORE_PREDICTOR = "callbackBeginTimeStepBeforePredictor"
AFTER_REPORTING = "callbackEndOfZoneTimeStepAfterZoneReporting"


class EngineFailed(Exception):
    """EnergyPlus gave up, or cannot be loaded (`is_missing`); becomes the error of the one that asked."""

    def __init__(self, said: str, is_missing: bool = False) -> None:
        super().__init__(said, is_missing)
        self.said, self.is_missing = said, is_missing

    def __str__(self) -> str:
        return self.said


def _load(folder: Path) -> ctypes.CDLL:
    found = [folder / name for name in ("libenergyplusapi.so", "energyplusapi.dll", "libenergyplusapi.dylib")]
    try:
        library = ctypes.CDLL(str(next(path for path in found if path.exists())))
    except (OSError, StopIteration) as error:
        reason = error if isinstance(error, OSError) else f"no library in {folder}"
        raise EngineFailed(f"EnergyPlus is installed but cannot be loaded: {reason}", is_missing=True) from None
    for name, (result, arguments) in _FUNCTIONS.items():
        function = getattr(library, name)
        function.restype, function.argtypes = result, [] if arguments is None else [_STATE, *arguments]
    return library


class Engine:
    """One EnergyPlus of a folder in this process, which can run once."""

    def __init__(self, folder: str, watch: Watch | None = None) -> None:
        self._watch, self._library = watch, _load(Path(folder))
        self._state = _STATE(self._library.stateNew())  # made once, and not for each call
        self._library.setConsoleOutputState(self._state, 0)
        self._library.setEnergyPlusRootDirectory(self._state, folder.encode())
        self._kept: list[object] = []  # C code holds no reference to them
        self._raised: BaseException | None = None
        self._is_ready = False

    def watch_also(self, progress: Callable[[], int]) -> None:
        """Tell the watch of a number that changes while no Python is called."""
        if self._watch is not None:
            self._watch.progress = progress

    def request(self, variable: str, key: str) -> None:
        """Ask for an output variable before the run; without that it has no handle."""
        self._library.requestVariable(self._state, variable.encode(), key.encode())

    def at(self, moment: str, call: Callable[[], None], native: Callable[[int], int] | None = None) -> None:
        """Call at a moment of each step, as soon as handles can be had; the first exception ends the run.

        `native` gives what the engine calls in place of a Python function at an address.
        """

        def guarded(state: int) -> None:
            if self._raised is not None or not (self._is_ready or self._now_ready()):
                return
            self._waits_for("")
            try:
                call()
            except BaseException as error:  # nothing may pass through C code
                self._raised = error
                self._library.stopSimulation(self._state)
            self._waits_for("between two steps")

        callback = _CALLBACK(guarded)
        self._kept.append(callback)
        function = getattr(self._library, moment)
        function.restype, function.argtypes = None, [_STATE, ctypes.c_void_p]
        address = ctypes.cast(callback, ctypes.c_void_p).value or 0
        function(self._state, native(address) if native else address)

    def addresses(self) -> tuple[int, int, int]:
        """Return where machine code finds the state, and what reads variables and sets actuators by their handles."""
        functions = (self._library.getVariableValue, self._library.setActuatorValue)
        read, write = (ctypes.cast(each, ctypes.c_void_p).value or 0 for each in functions)
        return self._state.value or 0, read, write

    def _now_ready(self) -> bool:
        self._is_ready = bool(self._library.apiDataFullyReady(self._state))
        return self._is_ready

    def variable(self, name: str, key: str) -> Callable[[], float]:
        """Return what reads an output variable; raise `EngineFailed` where the model has none."""
        handle = self.handle(name, key)
        read, state = self._library.getVariableValue, self._state
        return lambda: float(read(state, handle))

    def handle(self, name: str, key: str) -> int:
        """Return the handle of an output variable; raise `EngineFailed` where the model has none."""
        return self._handle("variable", self._library.getVariableHandle, name, key)

    def values(self, handles: Sequence[int]) -> Callable[[], list[float]]:
        """Return what reads output variables by their handles."""
        read, state = self._library.getVariableValue, self._state
        each = [_INT(handle) for handle in handles]
        return lambda: [read(state, handle) for handle in each]

    def actuator(self, component: str, control: str, key: str) -> Callable[[float], None]:
        """Return what sets an actuator; raise `EngineFailed` where the model has none."""
        handle = _INT(self.actuator_handle(component, control, key))
        write, state = self._library.setActuatorValue, self._state
        return lambda value: write(state, handle, value)

    def actuator_handle(self, component: str, control: str, key: str) -> int:
        """Return the handle of an actuator; raise `EngineFailed` where the model has none."""
        return self._handle("actuator", self._library.getActuatorHandle, component, control, key)

    def known(self, name: str, key: str) -> float:
        """Return a number that the engine has sized or been given; raise `EngineFailed` where it has none."""
        handle = self._handle("number", self._library.getInternalVariableHandle, name, key)
        return float(self._library.getInternalVariableValue(self._state, handle))

    def _waits_for(self, engine: str) -> None:
        if self._watch is not None:
            self._watch.begin(engine)

    def _handle(self, what: str, find: Callable[..., int], *names: str) -> int:
        handle = find(self._state, *(name.encode() for name in names))
        if handle < 0:
            raise EngineFailed(f"EnergyPlus has no {what} {' / '.join(names)}")
        return handle

    @property
    def in_weather(self) -> bool:
        """Whether the engine is in a run period, its warm-up included, and not in a design day."""
        return int(self._library.kindOfSim(self._state)) == RUN_PERIOD

    @property
    def warming_up(self) -> bool:
        """Whether the engine still repeats the first day."""
        return bool(self._library.warmupFlag(self._state))

    def run(self, arguments: Sequence[str]) -> int:
        """Run to the end and return EnergyPlus' exit code; raise what a callback raised."""
        self._waits_for("before the first step")
        words = [b"energyplus", *(word.encode() for word in arguments)]
        code = int(self._library.energyplus(self._state, len(words), (_TEXT * len(words))(*words)))
        self._waits_for("")
        if self._raised is not None:
            raise self._raised
        return code
