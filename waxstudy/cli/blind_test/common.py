"""What the commands of the blind test share: their failures, the key."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from waxstudy.cli.errors import FAILED, INTERRUPTED, PLUGIN, USAGE, CommandError
from waxstudy.simulation.threads import use_one_thread

if TYPE_CHECKING:
    from waxstudy.blind_test.key import Key


@contextmanager
def failures(folder: Path) -> Iterator[None]:
    """Turn what goes wrong into a message and an exit code."""
    from concurrent.futures import BrokenExecutor

    from waxstudy.blind_test.child import NoProcess
    from waxstudy.blind_test.key import KeyProblem
    from waxstudy.blind_test.make import BlindTestError
    from waxstudy.blind_test.plan import PlanProblem
    from waxstudy.plugin.registry import PluginError
    from waxstudy.plugin.trial import Unmakeable

    use_one_thread()
    try:
        yield
    except (BlindTestError, KeyProblem, NoProcess, PlanProblem) as error:
        raise CommandError(str(error), USAGE) from error
    except PluginError as error:
        raise CommandError(str(error), PLUGIN) from error
    except Unmakeable as error:
        raise CommandError(str(error), FAILED) from error
    except BrokenExecutor as error:
        ended = "a worker was ended, by lack of memory perhaps; what was finished is kept, take fewer --workers"
        raise CommandError(ended, FAILED) from error
    except OSError as error:
        reason = os.strerror(error.errno) if error.errno else str(error)
        raise CommandError(f"{folder}: {reason}", FAILED) from error
    except KeyboardInterrupt:
        kept = "interrupted; what was finished is kept, the same command goes on from there"
        raise CommandError(kept, INTERRUPTED, label="") from None


def key_given(file: Path | None, folder: Path) -> Key | None:
    """Return the key that a file holds, or stdin for "-"; None where there is none.

    Raises `KeyProblem`, also of a key that lies with what it seals or cannot be read.
    """
    from waxstudy.blind_test.key import Key, KeyProblem
    from waxstudy.plugin.files import read_file, why

    if file is None:
        return None
    if str(file) == "-":
        return Key.read(sys.stdin.read())
    # a link to it lies there as well, wherever it leads
    if any(place.is_relative_to(folder.resolve()) for place in (file.resolve(), file.parent.resolve() / file.name)):
        raise KeyProblem(f"{file}: a key does not lie with what it seals: move it out of {folder}")
    if not file.exists():
        return None
    try:
        # a file that is no text holds no key, which `read` says
        return Key.read(read_file(file).decode("utf-8", errors="replace"))
    except OSError as error:
        raise KeyProblem(f"{file}: cannot be read: {why(error)}") from None
