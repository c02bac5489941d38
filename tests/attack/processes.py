"""Commands in processes of their own: what may be killed, hindered, or see another machine."""

from __future__ import annotations

import ctypes
import os
import resource
import signal
import subprocess
import sys
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path

from tests.attack.verdict import Ended
from tests.conftest import NO_BYTECODE
from waxstudy.results.atomic import PARTIAL

WAXSTUDY = Path(sys.executable).with_name("waxstudy")
LIMIT_S = 600.0
PR_CAPBSET_DROP, CAP_DAC_OVERRIDE, CAP_DAC_READ_SEARCH = 24, 1, 2


def ended(folder: Path, *command: str, before: Callable[[], None] | None = None, kill_s: float | None = None) -> Ended:
    """Run the installed command, or another if it is a path, and kill it after some seconds."""
    words = [str(WAXSTUDY), *command] if not os.path.isabs(command[0]) else list(command)
    process = subprocess.Popen(
        words,
        cwd=folder,
        env={**os.environ, **NO_BYTECODE} if before else None,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        errors="replace",
        preexec_fn=before,
        start_new_session=True,
    )
    try:
        out, err = process.communicate(timeout=LIMIT_S if kill_s is None else kill_s)
    except subprocess.TimeoutExpired:
        process.kill()  # it alone: what it began must end with it
        try:
            process.communicate(timeout=10.0)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
        return Ended(None, "", "")
    return Ended(process.returncode, out, err)


def small_files(most_bytes: int) -> Callable[[], None]:
    """Let no file grow beyond a size, as on a full disk."""

    def limit() -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (most_bytes, most_bytes))

    return limit


def without_rights() -> None:
    """Let root be held by the permissions of files, as any other user is; the interpreter stays readable to it."""
    if os.geteuid() == 0:
        libc = ctypes.CDLL(None, use_errno=True)
        for capability in (CAP_DAC_OVERRIDE, CAP_DAC_READ_SEARCH):
            if libc.prctl(PR_CAPBSET_DROP, capability, 0, 0, 0):
                raise OSError(ctypes.get_errno(), "a capability cannot be dropped")


def contents(folder: Path) -> dict[str, str]:
    """Digest of every file below a folder but what is being written."""
    files = [path for path in sorted(folder.rglob("*")) if path.is_file()]
    names = {path: path.relative_to(folder).as_posix() for path in files}
    return {names[path]: sha256(path.read_bytes()).hexdigest() for path in files if PARTIAL not in names[path]}
