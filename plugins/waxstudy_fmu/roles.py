"""What a variable of an FMU can be for a study, in which units, and whether the FMU has it so."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from waxstudy.plugin import Refused

# unit -> factor and offset from it to ours
TEMPERATURE = {"degC": (1.0, 0.0), "K": (1.0, -273.15)}
HEAT = {"W": (1.0, 0.0), "kW": (1000.0, 0.0)}
FLUX = {"W/m2": (1.0, 0.0), "W/m^2": (1.0, 0.0)}
FLOW = {"1": (1.0, 0.0), "L/h": (1.0, 0.0), "l/h": (1.0, 0.0), "m3/s": (3.6e6, 0.0), "m^3/s": (3.6e6, 0.0)}
INPUTS = {
    "flow": FLOW,  # of water; of the unit 1, the fraction of the full flow
    "heat_W": HEAT,  # of the water to the floor, in place of a flow
    "supply_C": TEMPERATURE,
    "outdoor_C": TEMPERATURE,
    "gains_W": HEAT,
    "start_air_C": TEMPERATURE,  # parameters, before the warm-up
    "start_floor_C": TEMPERATURE,
}
OUTPUTS = {
    "air_C": TEMPERATURE,
    "operative_C": TEMPERATURE,
    "sensed_C": TEMPERATURE,
    "floor_surface_C": TEMPERATURE,
    "layer_C": TEMPERATURE,
    "return_C": TEMPERATURE,
    "floor_heat_W_m2": FLUX,
    "water_heat_W": HEAT,
}
STANDS_FOR = {"operative_C": "air_C", "sensed_C": "air_C", "floor_surface_C": "operative_C", "layer_C": "operative_C"}


@dataclass(frozen=True)
class Variable:
    """One of the FMU's, and how its number becomes ours: `factor * number + offset`."""

    reference: int
    name: str
    unit: str
    factor: float
    offset: float

    def ours(self, number: float) -> float:
        return self.factor * number + self.offset

    def theirs(self, number: float) -> float:
        return (number - self.offset) / self.factor


@dataclass(frozen=True)
class Variables:
    """All that a study maps, by role; `sun` by azimuth."""

    inputs: Mapping[str, Variable]
    outputs: Mapping[str, Variable]
    sun: Mapping[str, Variable]

    def told(self) -> Iterator[str]:
        """Yield what stands for a role that the FMU does not give."""
        for role, other in STANDS_FOR.items():
            if role not in self.outputs:
                yield f"{other} for {role}"
        if "floor_heat_W_m2" not in self.outputs:
            yield "the water's heat for floor_heat_W_m2"
        if "flow" in self.inputs and "supply_C" not in self.inputs and "water_heat_W" not in self.outputs:
            yield "the paper's heating curve for supply_C, from which the heat is computed"


def find(description: Any, inputs: Mapping[str, str], outputs: Mapping[str, str], sun: Mapping[str, str]) -> Variables:
    """Return the variables of a model description; raise `Refused` for roles and variables that cannot be."""
    known = {each.name: each for each in description.modelVariables}
    seen: dict[str, str] = {}
    found: dict[str, dict[str, Variable]] = {"inputs": {}, "outputs": {}, "sun": {}}
    sun_roles = dict.fromkeys(sun, FLUX)
    for table, roles, names in (("inputs", INPUTS, inputs), ("outputs", OUTPUTS, outputs), ("sun", sun_roles, sun)):
        for role, name in names.items():
            key = f"room.{table}.{role}"
            if role not in roles:
                raise Refused(key, name, f"is no role; there are {', '.join(roles)}")
            if name in seen:
                raise Refused(key, name, f"is the variable of {seen[name]} already")
            seen[name] = role
            found[table][role] = _variable(key, name, known, roles[role], table == "outputs")
    _refuse_gaps(found["inputs"], found["outputs"])
    return Variables(found["inputs"], found["outputs"], found["sun"])


def _variable(
    key: str, name: str, known: Mapping[str, Any], units: Mapping[str, tuple[float, float]], is_output: bool
) -> Variable:
    if name not in known:
        raise Refused(key, name, f"the FMU has no such variable; it has {', '.join(list(known)[:20])}")
    each = known[name]
    if each.type not in ("Real", "Float64"):
        raise Refused(key, name, f"is a variable of type {each.type}, not a real number")
    if not is_output and each.causality not in ("input", "parameter"):
        raise Refused(key, name, f"is an {each.causality} variable of the FMU, which cannot be set")
    unit = str(each.unit or (each.declaredType.unit if each.declaredType is not None else "") or "")
    if unit not in units:
        said = f"is in {unit}" if unit else "has no unit"
        raise Refused(key, name, f"{said} in the model description; taken are {', '.join(units)}")
    return Variable(int(each.valueReference), name, unit, *units[unit])


def _refuse_gaps(inputs: Mapping[str, Variable], outputs: Mapping[str, Variable]) -> None:
    if ("flow" in inputs) == ("heat_W" in inputs):
        raise Refused("room.inputs", list(inputs), "one of flow and heat_W is needed")
    if "air_C" not in outputs:
        raise Refused("room.outputs", list(outputs), "air_C is needed")
    if "heat_W" in inputs and "layer_C" not in outputs:
        raise Refused("room.outputs", list(outputs), "layer_C is needed for heat_W, which is the water's to that layer")
    if "flow" in inputs and not {"water_heat_W", "return_C"} & set(outputs):
        raise Refused("room.outputs", list(outputs), "one of water_heat_W and return_C is needed for the heat")
