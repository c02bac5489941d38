"""Plugins that cannot be registered: a list shows each as broken, with the reason."""

from __future__ import annotations

from collections.abc import Mapping

from tests.conformance.broken.plugin import Unregistered, valve

UNREGISTERED: Mapping[str, Unregistered] = {
    "raises-at-import": Unregistered(
        valve(before='raise RuntimeError("no licence server")'), "RuntimeError: no licence server ("
    ),
    "exits-at-import": Unregistered(
        valve(before='import sys\nsys.exit("no licence server")'), "SystemExit: no licence server ("
    ),
    "needs-a-module": Unregistered(
        valve(before="import thermostat_firmware"), "ModuleNotFoundError: No module named 'thermostat_firmware' ("
    ),
    "syntax": Unregistered(valve("return ("), "SyntaxError: '(' was never closed"),
    "parameter-without-type": Unregistered(
        valve(before='class Gain(Parameters):\n    gain = parameter(1.0, unit="1", description="Gain.", source="-")'),
        "Field 'gain' requires a type annotation",
    ),
    "exemptions-are-a-list": Unregistered(
        valve(body='exemptions = ["compiled"]'), "Broken: its exemptions must be a table, written {"
    ),
    "examples-are-a-list": Unregistered(valve(body="examples = [{}]"), "Broken: its examples must be a table"),
    # the class is right, its registration is not: a check of the class itself has nothing to say
    "misspelled-hook": Unregistered(
        valve().replace("waxstudy_register", "waxstudy_registre"), "unknown hook 'waxstudy_registre'", says=None
    ),
    "unmarked-hook": Unregistered(
        valve().replace("@hookimpl", ""), "registers nothing (is `waxstudy_register` marked @hookimpl?)", says=None
    ),
    "hook-raises": Unregistered(
        valve().replace("register(Broken)", "register(Missing)"),
        "NameError: name 'Missing' is not defined (",
        says=None,
    ),
    "duplicate": Unregistered(
        valve().replace("Valve", "Modulator").replace("NAME", "pwm"),
        "modulator 'pwm' of duplicate 1.0 is registered already by waxstudy ",
        says=None,
    ),
    # the class
    "newer-api": Unregistered(valve(body='api_version = "2.0"'), "Broken: made for plugin API 2.0, this is 1.0"),
    "wrong-name": Unregistered(
        valve().replace("NAME", "Quick Valve"), "Broken: its name is 'Quick Valve': give `name` a text of lower-case"
    ),
    "wrong-kind": Unregistered(valve(body='kind = "valv"'), "Broken: unknown kind 'valv'; kinds are sensor, "),
    "wrong-signature": Unregistered(
        valve().replace("(p, x, u, t, dt)", "(x, u)"), "Broken: its `step` must take (p, x, u, t, dt): step(x, u)"
    ),
    "takes-self": Unregistered(
        valve().replace("    @staticmethod\n", "").replace("(p, x", "(self, p, x"),
        "Broken: its `step` must take (p, x, u, t, dt): step(self, p, x, u, t, dt)",
    ),
    "no-step": Unregistered(valve().replace("def step(", "def steps("), "Broken: a valve must define `step`"),
    "step-is-compiled-already": Unregistered(
        valve(before="from numba import njit").replace("    @staticmethod\n", "    @staticmethod\n    @njit\n"),
        "plain function",
    ),
    "step-is-a-class-method": Unregistered(
        valve().replace("@staticmethod", "@classmethod").replace("(p, x", "(cls, p, x"), "plain function"
    ),
    "parameters-are-a-dict": Unregistered(
        valve(body='Parameters = {"gain": 1.0}'), "Broken: its Parameters must be a class derived from waxstudy.plugin"
    ),
}
