"""waxstudy: how much modelling detail does a heating control loop need, and what is a model missing?

    import waxstudy as wx

    run = wx.run("studies/table5.toml")
    run.kpis, run.differences, run.traces("O_WM", "january")

    record = wx.Dataset.from_frame(frame, units={"supply": "degF"}, timezone="Europe/Tallinn", believed=..., room=...)
    found = wx.diagnose(record)
    found.effects, found.where, found.how_far

Nothing of it is imported before it is used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from waxstudy.version import __version__

if TYPE_CHECKING:
    from waxstudy.api.components import components
    from waxstudy.api.diagnosing import Found, diagnose
    from waxstudy.api.fitting import fit_actuator, fit_valve
    from waxstudy.api.provenance import read_diagnosis
    from waxstudy.api.record import Dataset
    from waxstudy.api.running import Results, run
    from waxstudy.api.sweeping import sweep
    from waxstudy.fleet.result import Activated
    from waxstudy.plugin import (
        Actuator,
        BackendMissing,
        Controller,
        Effect,
        Modulator,
        Room,
        Sensor,
        SimulationError,
        Valve,
        Weather,
        hookimpl,
    )
    from waxstudy.plugin.registry import PluginError
    from waxstudy.results.folder import RunError
    from waxstudy.study.problems import StudyError
    from waxstudy.sweeps.result import Swept

_PLACES = {
    "Activated": "waxstudy.fleet.result",
    "Actuator": "waxstudy.plugin",
    "BackendMissing": "waxstudy.plugin",
    "Controller": "waxstudy.plugin",
    "Dataset": "waxstudy.api.record",
    "Effect": "waxstudy.plugin",
    "Found": "waxstudy.api.diagnosing",
    "Modulator": "waxstudy.plugin",
    "PluginError": "waxstudy.plugin.registry",
    "Results": "waxstudy.api.running",
    "Room": "waxstudy.plugin",
    "RunError": "waxstudy.results.folder",
    "Sensor": "waxstudy.plugin",
    "SimulationError": "waxstudy.plugin",
    "StudyError": "waxstudy.study.problems",
    "Swept": "waxstudy.sweeps.result",
    "Valve": "waxstudy.plugin",
    "Weather": "waxstudy.plugin",
    "components": "waxstudy.api.components",
    "diagnose": "waxstudy.api.diagnosing",
    "fit_actuator": "waxstudy.api.fitting",
    "fit_valve": "waxstudy.api.fitting",
    "hookimpl": "waxstudy.plugin",
    "read_diagnosis": "waxstudy.api.provenance",
    "run": "waxstudy.api.running",
    "sweep": "waxstudy.api.sweeping",
}
__all__ = [
    "Activated",
    "Actuator",
    "BackendMissing",
    "Controller",
    "Dataset",
    "Effect",
    "Found",
    "Modulator",
    "PluginError",
    "Results",
    "Room",
    "RunError",
    "Sensor",
    "SimulationError",
    "StudyError",
    "Swept",
    "Valve",
    "Weather",
    "__version__",
    "components",
    "diagnose",
    "fit_actuator",
    "fit_valve",
    "hookimpl",
    "read_diagnosis",
    "run",
    "sweep",
]


def __getattr__(name: str) -> Any:
    if name not in _PLACES:
        raise AttributeError(f"module 'waxstudy' has no attribute '{name}'")
    from importlib import import_module

    found = getattr(import_module(_PLACES[name]), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted(__all__)
