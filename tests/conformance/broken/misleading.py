"""Plugins whose valve runs, and is not to be trusted or not understood: what only the kit can tell."""

from __future__ import annotations

from collections.abc import Mapping

from tests.conformance.broken.plugin import DONE, GAIN, REMEMBERS, Broken, start, state, valve

USES_GAIN = "Parameters = Gain"
LEVEL = state("level: float = 0.0")
SHARED = "two starts share memory, so that one chain changes the other: build what is mutable in `start`"
OUTLIVES = "something outlives the state"

UNTRUSTED: Mapping[str, Broken] = {
    "aliasing-default": Broken(
        valve("return delayed(x.memory, u)", before=state("memory: Ring = Ring(60)"), body=REMEMBERS),
        "state",
        SHARED,
        DONE,
    ),
    "aliasing-start": Broken(
        valve(
            "x.level += 0.1 * (u - x.level)\nreturn x.level",
            before=f"{LEVEL}\n\nSHARED = Memory()",
            body=REMEMBERS + start("return SHARED"),
        ),
        "state",
        SHARED,
    ),
    "randomness": Broken(
        valve("return u * (1.0 - 0.01 * random.random())", before="import random"),
        "reproducible",
        "line 17 uses `random`: a run must give the same figures each time; keep everything in the state",
    ),
    "numpy-randomness": Broken(
        valve("return u * (1.0 - 0.01 * np.random.random())", before="import numpy as np"),
        "reproducible",
        "line 17 uses `numpy.random`: a run must give the same figures each time",
    ),
    "clock": Broken(
        valve("return u if time.time() > 0.0 else 0.0", before="import time"),
        "reproducible",
        "line 17 uses `time`: a run must give the same figures each time",
        DONE,
        slow=True,
    ),
    "global-memory": Broken(
        valve("global calls\ncalls += 1\nreturn u / calls", before="calls = 0"), "reproducible", OUTLIVES
    ),
    "memory-in-a-list": Broken(
        valve("last = CALLS[0]\nCALLS[0] = u\nreturn last", before="CALLS = [0.0]"), "reproducible", OUTLIVES
    ),
    "prints": Broken(valve('print("opening", u)\nreturn u'), "output", "its step prints ('opening 0.0", DONE),
    "rate-without-dt": Broken(
        valve("x.level += 0.02 * (u - x.level)\nreturn x.level", before=LEVEL, body=REMEMBERS),
        "step-halving",
        "its output does not settle with a shorter step",
    ),
    "state-in-a-function": Broken(
        valve(
            "x.level = u\nreturn x.level",
            before="def made():\n    @dataclass\n    class Memory:\n        level: float = 0.0\n\n    return Memory\n",
            body="State = made()",
        ),
        "restore",
        "its state cannot be pickled (AttributeError): define State at the top of a module",
        DONE,
    ),
    "uses-a-dict": Broken(
        valve("return CURVE[round(10.0 * u)]", before="CURVE = {n: 0.1 * n for n in range(11)}"),
        "compiled",
        "it cannot be compiled, and would run many times slower in Python: ",
        DONE,
        slow=True,
    ),
}

SAYS = 'unit="1", ge=0, le=2, description="Gain.", source="chosen for a test"'
NOT_DECLARED = "parameter gain: declare it with `parameter(default, unit=, description=, source=, ge=, le=)`"

UNDECLARED: Mapping[str, Broken] = {
    "no-docstring": Broken(valve(doc=""), "declaration", "it has no docstring: say in a sentence what it does"),
    "no-api-version": Broken(
        valve().replace('    api_version = "1.0"\n', ""), "declaration", 'add api_version = "1.0"'
    ),
    "exemption-without-reason": Broken(
        valve(body='exemptions = {"compiled": "slow"}'),
        "declaration",
        "exemption from 'compiled' without a reason: write a sentence that a user understands",
    ),
    "exemption-from-no-stage": Broken(
        valve(body='exemptions = {"compile": "It looks up a table that is far too large."}'),
        "declaration",
        "exemption from 'compile', which is no stage that allows one; did you mean 'compiled'?",
    ),
    "invalid-example": Broken(
        valve(before=GAIN, body=USES_GAIN + '\nexamples = {"much": {"gain": 9.0}}'),
        "examples",
        "example 'much' is refused: gain ",
    ),
    "parameter-without-unit": Broken(
        valve(before=GAIN.replace("parameter(", "Field(").replace(SAYS, "ge=0, le=2"), body=USES_GAIN).replace(
            "from dataclasses", "from pydantic import Field\nfrom dataclasses"
        ),
        "parameters",
        NOT_DECLARED,
    ),
    "parameter-without-source": Broken(
        valve(before=GAIN.replace("chosen for a test", ""), body=USES_GAIN),
        "parameters",
        "parameter gain: its source is empty",
    ),
    "parameter-without-bounds": Broken(
        valve(before=GAIN.replace("ge=0, le=2, ", ""), body=USES_GAIN),
        "parameters",
        "parameter gain: give both bounds (ge= or gt=, le= or lt=)",
    ),
    "unit-not-in-the-name": Broken(
        valve(before=GAIN.replace("gain:", "delay:").replace('unit="1"', 'unit="s"'), body=USES_GAIN),
        "parameters",
        "parameter delay: its unit is s: let the name end with _s",
    ),
}

MISLEADING = {**UNTRUSTED, **UNDECLARED}
