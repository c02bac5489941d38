"""A program that imports FMUs, as small as one can be: it calls the interface and keeps what is logged."""

from __future__ import annotations

import ctypes
import zipfile
from pathlib import Path
from typing import Any

import fmpy

FOLDER = {2: fmpy.platform, 3: fmpy.platform_tuple}
LOGGER = {
    2: ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p),
    3: ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p),
}
REAL = {2: "Real", 3: "Float64"}
NUMBER = ctypes.c_double


class Refused(Exception):
    """A call that gave an error; what was logged."""


class Callbacks(ctypes.Structure):
    _fields_ = [("logger", LOGGER[2]), *((name, ctypes.c_void_p) for name in "abcd")]


class Fmu:
    """A library, loaded."""

    def __init__(self, path: Path, folder: Path) -> None:
        with zipfile.ZipFile(path) as archive:
            archive.extractall(folder)
        self.description = fmpy.read_model_description(str(path))
        self.fmi = int(self.description.fmiVersion[0])
        self.references = {each.name: each.valueReference for each in self.description.modelVariables}
        name = self.description.coSimulation.modelIdentifier
        library = folder / "binaries" / FOLDER[self.fmi] / f"{name}{fmpy.sharedLibraryExtension}"
        self.library = ctypes.CDLL(str(library))
        self.do_step: Any = self.function("DoStep")
        number, flag, text, pointer = NUMBER, ctypes.c_int, ctypes.c_char_p, ctypes.c_void_p
        self.do_step.argtypes = [pointer, number, number, flag, *([pointer] * 4 if self.fmi == 3 else [])]
        new = self.function("Instantiate" if self.fmi == 2 else "InstantiateCoSimulation")
        new.restype = pointer
        strings = [text, flag, text, text] if self.fmi == 2 else [text, text, text]
        own = (
            [pointer, flag, flag] if self.fmi == 2 else [*[ctypes.c_bool] * 4, pointer, ctypes.c_size_t, *[pointer] * 3]
        )
        new.argtypes = [*strings, *own]
        self.new = new

    def function(self, name: str) -> Any:
        return getattr(self.library, f"fmi{self.fmi}{name}")


class Instance:
    """One instance; what the interface refuses is raised."""

    def __init__(self, fmu: Fmu, name: str = "one", token: str = "") -> None:
        self.fmu, self.said = fmu, list[str]()
        self.log = LOGGER[fmu.fmi](lambda *logged: self.said.append(logged[-1].decode()))
        token = token or (fmu.description.guid if fmu.fmi == 2 else fmu.description.instantiationToken)
        if fmu.fmi == 2:
            self.callbacks = Callbacks(self.log)
            given = (1, token.encode(), b"", ctypes.addressof(self.callbacks), 0, 0)
        else:
            log = ctypes.cast(self.log, ctypes.c_void_p)
            given = (token.encode(), None, False, False, False, False, None, 0, None, log, None)
        self.handle = fmu.new(name.encode(), *given)
        if not self.handle:
            raise Refused(*self.said)

    def call(self, name: str, *arguments: Any) -> None:
        function = self.fmu.function(name)
        function.argtypes = None
        if function(ctypes.c_void_p(self.handle), *arguments):
            raise Refused(self.said[-1])

    def begin(self, start: float = 0.0) -> Instance:
        self.enter(start)
        self.call("ExitInitializationMode")
        return self

    def enter(self, start: float = 0.0) -> None:
        if self.fmu.fmi == 2:
            self.call("SetupExperiment", 0, NUMBER(0), NUMBER(start), 0, NUMBER(0))
            self.call("EnterInitializationMode")
        else:
            nothing = ctypes.c_bool(False)
            self.call("EnterInitializationMode", nothing, NUMBER(0), NUMBER(start), nothing, NUMBER(0))

    def _access(self, what: str, name: str, value: Any, kind: str = "") -> None:
        reference = ctypes.c_uint(self.fmu.references[name])
        count = [ctypes.c_size_t(1)] if self.fmu.fmi == 3 else []
        self.call(
            what + (kind or REAL[self.fmu.fmi]),
            ctypes.byref(reference),
            ctypes.c_size_t(1),
            ctypes.byref(value),
            *count,
        )

    def set(self, name: str, value: float) -> None:
        self._access("Set", name, NUMBER(value))

    def get(self, name: str) -> float:
        value = NUMBER()
        self._access("Get", name, value)
        return value.value

    def step(self, at: float, length: float) -> None:
        extra = [None] * 4 if self.fmu.fmi == 3 else []
        if self.fmu.do_step(self.handle, at, length, 0, *extra):
            raise Refused(self.said[-1])

    def state(self) -> ctypes.c_void_p:
        kept = ctypes.c_void_p()
        self.call("GetFMUstate" if self.fmu.fmi == 2 else "GetFMUState", ctypes.byref(kept))
        return kept

    def restore(self, state: ctypes.c_void_p) -> None:
        self.call("SetFMUstate" if self.fmu.fmi == 2 else "SetFMUState", state)

    def serialized(self, state: ctypes.c_void_p) -> bytes:
        name = "FMUstate" if self.fmu.fmi == 2 else "FMUState"
        size = ctypes.c_size_t()
        self.call(f"Serialized{name}Size", state, ctypes.byref(size))
        data = (ctypes.c_char * size.value)()
        self.call(f"Serialize{name}", state, data, size)
        return bytes(data)

    def read_back(self, data: bytes) -> ctypes.c_void_p:
        state = ctypes.c_void_p()
        name = "DeSerializeFMUstate" if self.fmu.fmi == 2 else "DeserializeFMUState"
        self.call(name, data, ctypes.c_size_t(len(data)), ctypes.byref(state))
        return state

    def forget(self, state: ctypes.c_void_p) -> None:
        self.call("FreeFMUstate" if self.fmu.fmi == 2 else "FreeFMUState", ctypes.byref(state))

    def free(self) -> None:
        free = self.fmu.function("FreeInstance")
        free.restype = None
        free(ctypes.c_void_p(self.handle))
