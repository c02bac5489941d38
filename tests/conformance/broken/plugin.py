"""What a broken plugin is: its source, and what must be said of it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from textwrap import dedent, indent

DONE, CHECK_FAILED, INVALID, PLUGIN, FAILED = 0, 1, 3, 4, 6


@dataclass(frozen=True)
class Broken:
    """A plugin of one valve.

    `stage` of the kit is to fail and to say `says`. A study that uses the valve ends with `code`, `run` in its message
    (no code: a run has nothing to say of it). Where Python tells it otherwise than compiled code, `interpreted` is
    code and message of --no-jit. What is `slow` cannot be compiled, of which a run warns.
    """

    source: str
    stage: str
    says: str
    code: int | None = None
    run: str = ""
    interpreted: tuple[int, str] | None = None
    slow: bool = False


@dataclass(frozen=True)
class Unregistered:
    """A plugin that offers nothing; `reason` is why, and is said of its class too, unless that `says` nothing."""

    source: str
    reason: str
    says: str | None = ""


def module_of(name: str) -> str:
    return f"broken_{name.replace('-', '_')}"


def valve(
    step: str = "return u", *, before: str = "", body: str = "", doc: str = '"""Passes the opening on, for a test."""'
) -> str:
    """Source of a plugin whose valve has this step; `before` stands before the class, `body` in it."""
    return (
        dedent("""\
        from dataclasses import dataclass, field

        from waxstudy.plugin import LEVEL, Parameters, Port, Ring, Valve, delayed, hookimpl, parameter

        {before}


        class Broken(Valve):
            {doc}

            name = "NAME"
            api_version = "1.0"
        {body}

            @staticmethod
            def step(p, x, u, t, dt):
        {step}


        @hookimpl
        def waxstudy_register(register):
            register(Broken)
        """)
        .replace("{before}", dedent(before).strip())
        .replace("{doc}", doc)
        .replace("{body}", indent(dedent(body).strip(), 4 * " "))
        .replace("{step}", indent(dedent(step).strip(), 8 * " "))
    )


REMEMBERS = "State = Memory\n"
GAIN = """\
class Gain(Parameters):
    gain: float = parameter(1.0, unit="1", ge=0, le=2, description="Gain.", source="chosen for a test")
"""


def state(field: str, options: str = "") -> str:
    """Source of a state class, `Memory`, of one field."""
    return f"@dataclass{options}\nclass Memory:\n    {field}\n"


def start(line: str) -> str:
    """Source of a `start` of one line."""
    return f"@classmethod\ndef start(cls, p, dt):\n    {line}\n"


def install(folder: Path, name: str, source: str) -> Path:
    """Install a plugin into a folder as its own package would; return its module's file."""
    module = module_of(name)
    about = folder / f"{module}-1.0.dist-info"
    about.mkdir(parents=True)
    (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text(f"[waxstudy]\n{name} = {module}\n")
    file = folder / f"{module}.py"
    file.write_text(source.replace("NAME", name))
    return file
