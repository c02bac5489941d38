"""Machine code for each platform, by the C compiler that the package `ziglang` brings."""

from __future__ import annotations

import os
import platform
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from waxstudy.plugin import BackendMissing
from waxstudy.simulation.cache_place import cache_base, private

LONGEST_S = 900.0  # the first library for Windows takes minutes: what its C library needs is compiled once
FLAGS = ("-shared", "-O2", "-fPIC", "-s", "-fvisibility=hidden", "-ffp-contract=off", "-Wno-override-module", "-lm")


class CompilerFailed(Exception):
    """The compiler gave no library; the message says which, and what it said."""


@dataclass(frozen=True)
class Platform:
    """One that FMUs are for: its folder in an FMU of FMI 2.0 ("" for none) and 3.0, the compiler's name, the ending."""

    folder2: str
    folder3: str
    target: str
    ending: str


PLATFORMS = {
    "linux64": Platform("linux64", "x86_64-linux", "x86_64-linux-gnu.2.17", ".so"),
    "win64": Platform("win64", "x86_64-windows", "x86_64-windows-gnu", ".dll"),
    "darwin64": Platform("darwin64", "x86_64-darwin", "x86_64-macos", ".dylib"),
    "linux-arm64": Platform("", "aarch64-linux", "aarch64-linux-gnu.2.17", ".so"),
    "darwin-arm64": Platform("", "aarch64-darwin", "aarch64-macos", ".dylib"),
}


def this_platform() -> str:
    """Return the name of the platform that this runs on, "" if it is none of `PLATFORMS`."""
    machine = {"AMD64": "64", "x86_64": "64", "arm64": "-arm64", "aarch64": "-arm64"}.get(platform.machine(), "")
    name = {"Linux": "linux", "Windows": "win", "Darwin": "darwin"}.get(platform.system(), "") + machine
    return name if name in PLATFORMS else ""


def require_compiler() -> None:
    if find_spec("ziglang") is None:
        raise BackendMissing(
            'an FMU needs a C compiler, which comes with the extra `fmu`: python -m pip install "waxstudy[fmu]"'
        )


def shared_library(sources: Sequence[Path], include: Path, of: Platform, path: Path) -> None:
    """Compile sources of C and of LLVM into one library; raise `CompilerFailed` or `BackendMissing`."""
    require_compiler()
    cache = private(cache_base() / "compiler") or path.parent / "compiler"
    environment = os.environ | {"ZIG_GLOBAL_CACHE_DIR": str(cache), "ZIG_LOCAL_CACHE_DIR": str(cache)}
    command = [sys.executable, "-m", "ziglang", "cc", "-target", of.target, *FLAGS, "-I", str(include)]
    try:
        done = subprocess.run(
            [*command, "-o", str(path), *map(str, sources)],
            env=environment,
            cwd=path.parent,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=LONGEST_S,
        )
    except subprocess.TimeoutExpired as error:
        raise CompilerFailed(f"the compiler did not end within {LONGEST_S:g} s for {of.target}") from error
    if done.returncode or not path.is_file():
        said = next((line for line in done.stderr.splitlines() if "error" in line), done.stderr.strip()[-200:])
        raise CompilerFailed(f"the compiler failed for {of.target}: {said}")
