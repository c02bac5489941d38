"""Compile blocks and the loop with numba, guarded and cached on disk.

Every block becomes a C function behind a guard that turns an exception into NaN. The cache folder is named by a
digest of all sources that go in, because numba's own cache misses edits in other files.
"""

from __future__ import annotations

import hashlib
import logging
import os
import shutil
import sys
from collections.abc import Callable, Iterable
from functools import cache
from pathlib import Path
from types import FunctionType
from typing import Any, TypeVar

import llvmlite
import numba
import numpy as np
from numba import carray, cfunc, from_dtype, njit, types
from numba.extending import intrinsic, overload

from waxstudy.plugin import Block, Component, delayed
from waxstudy.plugin.registry import PluginError, nearest
from waxstudy.simulation import kernel
from waxstudy.simulation.records import parameter_record, state_dtype

GUARD = """\
def guarded(p, x, u, t, dt):
    try:
        return step(carray(p, 1)[0], carray(x, 1)[0], u, t, dt) + 0.0
    except Exception:
        return nan
"""
log = logging.getLogger(__name__)
T = TypeVar("T")


# --- the delay ring, compiled ----------------------------------------------------------------------


@intrinsic
def _samples(typingctx, ring):  # type: ignore[no-untyped-def]
    """Pointer to the samples of a ring record: its own address plus its offset."""

    def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
        record = builder.bitcast(args[0], context.get_value_type(types.voidptr))
        number = context.get_value_type(types.int64)
        offset = builder.load(builder.bitcast(record, number.as_pointer()))
        target = context.get_value_type(types.CPointer(types.float64))
        return builder.bitcast(builder.gep(record, [offset]), target)

    return types.CPointer(types.float64)(ring), codegen


@overload(delayed)
def _delayed_compiled(ring, value):  # type: ignore[no-untyped-def]
    def compiled(ring, value):  # type: ignore[no-untyped-def]
        if ring.length == 0:
            return value
        values = carray(_samples(ring), ring.length)
        if ring.head < 0:
            for i in range(ring.length):
                values[i] = value
            ring.head = 0
        oldest = values[ring.head]
        values[ring.head] = value
        ring.head = (ring.head + 1) % ring.length
        return oldest

    return compiled


# --- sources and cache folder ----------------------------------------------------------------------


def _source_files(module_name: str) -> list[Path]:
    """The Python files of the top-level package (or the one file) that a module belongs to."""
    top = sys.modules[module_name.split(".")[0]]
    folders = getattr(top, "__path__", None)
    if folders:
        return sorted(file for folder in folders for file in Path(folder).rglob("*.py"))
    return [Path(file)] if (file := getattr(top, "__file__", None)) else []


def digest(parts: Iterable[str | bytes | Path]) -> str:
    """Return a short digest of texts and file contents."""
    total = hashlib.sha256()
    for part in parts:
        data = part.read_bytes() if isinstance(part, Path) else part
        total.update(data if isinstance(data, bytes) else data.encode())
        total.update(b"\0")
    return total.hexdigest()[:16]


@cache
def source_digest(module_name: str) -> str:
    """Digest of the sources that a module's results depend on: its package, or for the core what simulates."""
    files = _source_files(module_name)
    if module_name.split(".")[0] == "waxstudy":
        files = [file for file in files if file.parent.name in ("plugin", "simulation", "results")]
    return digest(files)


def _helpers(function: FunctionType) -> dict[str, FunctionType]:
    """The plain functions that a function calls by name."""
    found = {name: function.__globals__.get(name) for name in function.__code__.co_names}
    known = (delayed, function)
    return {name: f for name, f in found.items() if isinstance(f, FunctionType) and f not in known}


def _modules(function: FunctionType) -> set[str]:
    """The modules of a function and of all helpers below it."""
    return {function.__module__}.union(*(_modules(helper) for helper in _helpers(function).values()))


def component_digest(component: type[Component]) -> str:
    """Digest of the sources of a component: its bases' packages, and those of every function its step calls."""
    modules = {base.__module__ for base in component.__mro__ if base is not object}
    step = getattr(component, "step", None)
    modules |= _modules(step) if isinstance(step, FunctionType) else set()
    return digest(sorted({source_digest(module) for module in modules}))


def cache_folder() -> Path:
    """Folder of the compiled code: `WAXSTUDY_CACHE`, or the user's cache folder; one subfolder per digest."""
    base = os.environ.get("WAXSTUDY_CACHE") or os.path.join(
        os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache"), "waxstudy"
    )
    versions = (numba.__version__, llvmlite.__version__, np.__version__, sys.version)
    return Path(base) / digest((*versions, source_digest(__name__)))


def _cached(build: Callable[[Path | None], T]) -> T:
    """Build with the disk cache, or without it where it cannot be used; a damaged one is removed for the next time."""
    folder = cache_folder()
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        return build(folder)
    except numba.core.errors.NumbaError:
        raise
    except Exception as error:  # a damaged cache may raise anything while it is read
        built = build(None)  # what is wrong with the code itself is raised here again
        log.info("compiled code cannot be cached in %s: %s", folder, error)
        shutil.rmtree(folder, ignore_errors=True)
        return built
    finally:
        numba.config.CACHE_DIR = before


# --- compilation -----------------------------------------------------------------------------------


@cache
def _jitted(function: FunctionType) -> Any:
    """Compile a plain function together with the plain helpers that it calls by name."""
    namespace = function.__globals__ | {name: _jitted(helper) for name, helper in _helpers(function).items()}
    copy = FunctionType(function.__code__, namespace, function.__name__, function.__defaults__, function.__closure__)
    return njit(copy, error_model="python")


@cache
def _guarded(block: type[Block], parameter_dtype: np.dtype[Any]) -> Any:
    """Compile a block's guarded C function for one layout of its parameter record."""
    step = block.step
    assert isinstance(step, FunctionType)
    layout = _layout(block)
    signature = types.float64(
        types.CPointer(from_dtype(parameter_dtype)),
        types.CPointer(from_dtype(layout)),
        types.float64,
        types.float64,
        types.float64,
    )
    name = digest(
        (source_digest(step.__module__), step.__module__, step.__qualname__, str(parameter_dtype), str(layout))
    )

    def build(folder: Path | None) -> Any:
        path = folder / f"guard_{name}.py" if folder else None
        if path and not path.exists():
            path.write_text(GUARD)
        # numba imports the module of what it finds in its cache, so the guard needs one that exists
        namespace = {"__name__": __name__, "step": _jitted(step), "carray": carray, "nan": float("nan")}
        exec(compile(GUARD, str(path or "<guard>"), "exec"), namespace)
        return cfunc(signature, cache=path is not None)(namespace["guarded"])

    try:
        return _cached(build)
    except Exception as error:
        raise PluginError(
            f"{block.kind} '{block.name}' cannot be compiled: {_reason(error, layout)} (--no-jit runs it interpreted)"
        ) from error


def _layout(block: type[Block]) -> np.dtype[Any]:
    try:
        return state_dtype(block.State)
    except TypeError as error:
        raise PluginError(f"{block.kind} '{block.name}': {error}") from error


def _reason(error: Exception, layout: np.dtype[Any]) -> str:
    """What numba says, in one line; a misspelled state field comes from it as a bare KeyError."""
    if isinstance(error, KeyError):
        field = str(error.args[0])
        near = nearest(field, layout.names or ())
        return f"its state or parameters have no field '{field}'" + (f"; did you mean '{near}'?" if near else "")
    return " ".join(str(error).split())[:500]


def address(block: type[Block], plain: Any) -> int:
    """Return the address of the compiled, guarded block for the layout of these parameters."""
    compile_block: Callable[..., Any] = _guarded  # a cached function takes hashable arguments, which classes are
    return int(compile_block(block, parameter_record(plain).dtype).address)


_LOOP = types.int64(
    types.int64[::1],
    types.int64[::1],
    types.int64[::1],
    types.float64[::1],
    types.float64[::1],
    types.float64[::1],
    types.float64[::1],
    types.float64[:, ::1],
    types.float64[:, ::1],
    types.float64[:, ::1],
    types.float64[::1],
    types.float64[::1],
    types.float64[::1],
    types.float64[::1],
    types.float64[::1],
    types.float64,
    types.float64,
    types.float64,
    types.int64,
    types.float64,
    types.float64[:, ::1],
    types.int64[::1],
    types.int64[::1],
)


@cache
def loop() -> Callable[..., int]:
    """Return the compiled loop; it releases the interpreter lock."""

    def build(folder: Path | None) -> Any:
        return njit(_LOOP, nogil=True, cache=folder is not None)(kernel.simulate)

    compiled: Callable[..., int] = _cached(build)
    return compiled
