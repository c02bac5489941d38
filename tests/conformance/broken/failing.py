"""Plugins whose valve stops every run that uses it."""

from __future__ import annotations

from collections.abc import Mapping

from tests.conformance.broken.plugin import FAILED, GAIN, PLUGIN, REMEMBERS, Broken, start, state, valve

USES_GAIN = "Parameters = Gain"
TABLE = "return TABLE[3 + int(10.0 * u)]"
RECURSION = "RecursionError: maximum recursion depth exceeded"
IS_NAN = "it returned nan, not a level from 0 to 1"
NO_DATACLASS = "its State, Memory, is no dataclass: mark it @dataclass"
A_LIST = "state field Memory.levels: must be float, int, bool or Ring"
SEIZED = 'raise ValueError("bearing seized")'

BEFORE_THE_FIRST_STEP: Mapping[str, Broken] = {
    "raises-at-construction": Broken(
        valve(
            before="from pydantic import model_validator\n\n"
            + GAIN
            + '\n    @model_validator(mode="after")\n    def _known(self):\n        return {}["wax"]\n',
            body=USES_GAIN,
        ),
        "examples",
        "a validator failed with KeyError: 'wax' (",
        PLUGIN,
        "failed: KeyError: 'wax'",
    ),
    "default-out-of-range": Broken(
        valve(before=GAIN.replace("1.0,", "9.0,"), body=USES_GAIN), "examples", "gain", PLUGIN, "gain"
    ),
    "start-raises": Broken(
        valve(body=start('raise OSError("no such motor")')),
        "state",
        "start failed: OSError: no such motor (",
        FAILED,
        "its start failed: OSError: no such motor (",
    ),
    "start-exits": Broken(
        valve(body=start('raise SystemExit("no such motor")')),
        "state",
        "start failed: SystemExit: no such motor (",
        FAILED,
        "its start failed: SystemExit: no such motor (",
    ),
    "start-gives-a-dict": Broken(
        valve(before=state("level: float = 0.0"), body=REMEMBERS + start("return {'level': 0.0}")),
        "state",
        "start gives {'level': 0.0}, not its State, Memory",
        FAILED,
        "its start gave {'level': 0.0}, not its State",
    ),
    "state-is-no-dataclass": Broken(
        valve("x.level = u\nreturn u", before="class Memory:\n    level: float = 0.0", body=REMEMBERS),
        "state",
        NO_DATACLASS,
        PLUGIN,
        NO_DATACLASS,
    ),
    "state-of-a-list": Broken(
        valve("return u", before=state("levels: list = field(default_factory=list)"), body=REMEMBERS),
        "state",
        A_LIST,
        PLUGIN,
        A_LIST,
    ),
    "state-of-an-unknown-type": Broken(
        valve("return u", before=state("level: 'Level' = 0.0"), body=REMEMBERS),
        "state",
        "name 'Level' is not defined",
        PLUGIN,
        "name 'Level' is not defined",
    ),
    "frozen-state": Broken(
        valve("x.level = u\nreturn u", before=state("level: float = 0.0", "(frozen=True)"), body=REMEMBERS),
        "state",
        "frozen",
        PLUGIN,
        "frozen",
    ),
    "negative-ring": Broken(
        valve(
            "return delayed(x.memory, u)",
            before=state("memory: Ring"),
            body=REMEMBERS + start("return Memory(Ring(-1))"),
        ),
        "state",
        "start failed: ValueError: ",
        FAILED,
        "its start failed: ValueError: ",
    ),
    "port-of-another-kind": Broken(
        valve("return 50.0 * u", body='output = Port("flow", "L/h", 0.0, 100.0)'),
        "ports",
        "its output is 0 to 100 [L/h]; a valve's lies within 0 to 1 [1]",
        PLUGIN,
        "its output is 0 to 100 [L/h]",
    ),
    "port-is-a-text": Broken(valve(body='output = "1"'), "ports", "its output", PLUGIN, "its output"),
}

IN_A_STEP: Mapping[str, Broken] = {
    "raises": Broken(
        valve(f"if u < 2.0:\n    {SEIZED}\nreturn u"),
        "output",
        "ValueError: bearing seized",
        FAILED,
        "ValueError: bearing seized",
    ),
    "always-raises": Broken(
        valve(SEIZED), "output", "ValueError: bearing seized", FAILED, "ValueError: bearing seized", slow=True
    ),
    "raises-after-an-hour": Broken(
        valve(
            f"x.age_s += dt\nif x.age_s > 3600.0:\n    {SEIZED}\nreturn u",
            before=state("age_s: float = 0.0"),
            body=REMEMBERS,
        ),
        "output",
        "ValueError: bearing seized",
        FAILED,
        "601200 s before the week (warm-up) with input",
    ),
    "exits": Broken(
        valve('if u < 2.0:\n    raise SystemExit("bearing seized")\nreturn u'),
        "output",
        "SystemExit: bearing seized",
        FAILED,
        "SystemExit: bearing seized",
        slow=True,
    ),
    "gives-nan": Broken(valve('return float("nan")'), "output", IS_NAN, FAILED, IS_NAN),
    "out-of-range": Broken(
        valve("return u + 1.5"),
        "output",
        "it returned 1.5, not a level from 0 to 1",
        FAILED,
        ", not a level from 0 to 1",
    ),
    "tuple-index": Broken(
        valve(TABLE, before="TABLE = (0.0, 0.5, 1.0)"),
        "output",
        "IndexError: tuple index out of range",
        FAILED,
        "IndexError: tuple index out of range",
    ),
    "numpy-index": Broken(
        valve(TABLE, before="import numpy as np\n\nTABLE = np.array([0.0, 0.5, 1.0])"),
        "output",
        "is out of bounds for axis 0 with size 3",
        FAILED,
        "is out of bounds for axis 0 with size 3",
    ),
    "unknown-name": Broken(
        valve("return openning"),
        "output",
        "NameError: name 'openning' is not defined",
        FAILED,
        "NameError: name 'openning' is not defined",
        slow=True,
    ),
    "gives-a-text": Broken(
        valve('return "open"'),
        "output",
        "it returned str 'open', not",
        FAILED,
        "it returned str 'open', not",
        slow=True,
    ),
    "gives-an-array": Broken(
        valve("return np.full((2, 2), u)", before="import numpy as np"),
        "output",
        "it returned ndarray array([[0., 0.], [0., 0.]]), not a number",
        FAILED,
        "it returned ndarray array([[0., 0.], [0., 0.]]), not a number",
        slow=True,
    ),
    "gives-a-complex-number": Broken(
        valve("return np.sqrt(np.complex128(u))", before="import numpy as np"),
        "output",
        "it returned complex128 ",
        FAILED,
        "it returned complex128 ",
        slow=True,
    ),
    "gives-what-cannot-be-shown": Broken(
        valve("return Odd()", before='class Odd:\n    def __repr__(self):\n        raise KeyError("odd")'),
        "output",
        "it returned Odd",
        FAILED,
        "it returned Odd",
        slow=True,
    ),
    "gives-none-on-a-path": Broken(
        valve("if u < 0.5:\n    return u"),
        "output",
        "it returned None (a path without `return`?)",
        PLUGIN,
        "a path through its step returns nothing",
        (FAILED, "it returned None (a path without `return`?)"),
    ),
    "float-into-int": Broken(
        valve("x.cycles = x.cycles + 0.5\nreturn u", before=state("cycles: int = 0"), body=REMEMBERS),
        "output",
        "its state field 'cycles' is declared int and holds ",
        PLUGIN,
        "its state field 'cycles' is declared int and is given a float",
        (FAILED, "its state field 'cycles' is declared int and holds "),
    ),
    "array-into-float": Broken(
        valve(
            "x.level = np.zeros(3)\nreturn u",
            before="import numpy as np\n" + state("level: float = 0.0"),
            body=REMEMBERS,
        ),
        "output",
        "its state field 'level' is declared float and holds ",
        PLUGIN,
        "its state field 'level' is declared a float and is given an array",
        (FAILED, "its state field 'level' is declared float and holds "),
    ),
    "misspelled-state-written": Broken(
        valve("x.openning = u\nreturn u", before=state("opening: float = 0.0"), body=REMEMBERS),
        "output",
        "its step sets 'openning', which its State does not declare; did you mean 'opening'?",
        PLUGIN,
        "no field 'openning'; did you mean 'opening'?",
        (FAILED, "'openning', which its State does not declare; did you mean 'opening'?"),
    ),
    "misspelled-state-read": Broken(
        valve("return x.openning", before=state("opening: float = 0.0"), body=REMEMBERS),
        "output",
        "'Memory' object has no attribute 'openning'",
        PLUGIN,
        "no field 'openning'; did you mean 'opening'?",
        (FAILED, "'Memory' object has no attribute 'openning'"),
    ),
    "changes-its-parameters": Broken(
        valve("p.gain = 0.5\nreturn p.gain * u", before=GAIN, body=USES_GAIN),
        "output",
        "AttributeError: can't set attribute",
        FAILED,
        "AttributeError: can't set attribute",
    ),
    "recursion": Broken(
        valve("return deeper(u)", before="def deeper(u):\n    return deeper(u) if u < 9.0 else u"),
        "output",
        RECURSION,
        FAILED,
        RECURSION,
        slow=True,
    ),
    "recursion-of-two": Broken(
        valve("return there(u)", before="def there(u):\n    return back(u)\n\n\ndef back(u):\n    return there(u)"),
        "output",
        RECURSION,
        FAILED,
        RECURSION,
        slow=True,
    ),
}

FAILING = {**BEFORE_THE_FIRST_STEP, **IN_A_STEP}
