"""modelDescription.xml of an FMU, in FMI 2.0 and 3.0."""

from __future__ import annotations

from collections.abc import Iterator
from xml.etree import ElementTree as Xml

from waxstudy.export.model import Model, Variable
from waxstudy.version import __version__

# unit of waxstudy -> FMI's exponents of base units, factor and offset; one that is not here is a name without them
UNITS: dict[str, dict[str, str]] = {
    "1": {},
    "s": {"s": "1"},
    "h": {"s": "1", "factor": "3600"},
    "min": {"s": "1", "factor": "60"},
    "K": {"K": "1"},
    "degC": {"K": "1", "offset": "273.15"},
    "1/K": {"K": "-1"},
    "1/s": {"s": "-1"},
    "m": {"m": "1"},
    "mm": {"m": "1", "factor": "0.001"},
    "m2": {"m": "2"},
    "g": {"kg": "1", "factor": "0.001"},
    "N": {"kg": "1", "m": "1", "s": "-2"},
    "N/mm": {"kg": "1", "s": "-2", "factor": "1000"},
    "mm/N": {"kg": "-1", "s": "2", "factor": "0.001"},
    "Pa": {"kg": "1", "m": "-1", "s": "-2"},
    "kPa": {"kg": "1", "m": "-1", "s": "-2", "factor": "1000"},
    "W": {"kg": "1", "m": "2", "s": "-3"},
    "W/K": {"kg": "1", "m": "2", "s": "-3", "K": "-1"},
    "W/m2": {"kg": "1", "s": "-3"},
    "J/K": {"kg": "1", "m": "2", "s": "-2", "K": "-1"},
    "J/g": {"m": "2", "s": "-2", "factor": "1000"},
    "J/(g K)": {"m": "2", "s": "-2", "K": "-1", "factor": "1000"},
    "L/h": {"m": "3", "s": "-1", "factor": "2.7777777777777776e-07"},
}
VARIABILITY = {"time": "continuous", "input": "discrete", "output": "discrete", "parameter": "fixed"}
CAUSALITY = {"time": "independent", "constant": "local"}
TYPE2 = {"d": "Real", "q": "Integer", "?": "Boolean"}
TYPE3 = {"d": "Float64", "q": "Int64", "?": "Boolean"}


def model_description(model: Model, identifier: str, fmi: int) -> str:
    """Return the text of modelDescription.xml, with the value reference of a variable its place in the model."""
    root = _root(model, identifier, fmi)
    able = {
        "modelIdentifier": identifier,
        "canHandleVariableCommunicationStepSize": "true",
        "canGetAndSetFMUstate" if fmi == 2 else "canGetAndSetFMUState": "true",
        "canSerializeFMUstate" if fmi == 2 else "canSerializeFMUState": "true",
    }
    fixed_step = {} if fmi == 2 else {"fixedInternalStepSize": repr(model.step_s)}
    Xml.SubElement(root, "CoSimulation", able | fixed_step)
    units = Xml.SubElement(root, "UnitDefinitions")
    for name in sorted({unit_of(variable) for variable in model.variables if variable.unit}):
        unit = Xml.SubElement(units, "Unit", name=name)
        if name in UNITS:
            Xml.SubElement(unit, "BaseUnit", UNITS[name])
    categories = Xml.SubElement(root, "LogCategories")
    Xml.SubElement(categories, "Category", name="logStatusError", description="why a call was refused")
    Xml.SubElement(root, "DefaultExperiment", startTime="0", stopTime="86400", stepSize=repr(model.step_s))
    variables = Xml.SubElement(root, "ModelVariables")
    for reference, variable in enumerate(model.variables):
        (_scalar2 if fmi == 2 else _scalar3)(variables, reference, variable)
    _structure(Xml.SubElement(root, "ModelStructure"), model, fmi)
    Xml.indent(root)
    return Xml.tostring(root, encoding="unicode", xml_declaration=True).replace("us-ascii", "UTF-8") + "\n"


def unit_of(variable: Variable) -> str:
    return "degC" if variable.unit == "C" else variable.unit


def _root(model: Model, identifier: str, fmi: int) -> Xml.Element:
    said = {
        "fmiVersion": f"{fmi}.0",
        "modelName": identifier,
        "guid" if fmi == 2 else "instantiationToken": model.token,
        "description": f"{model.title}; stepped every {model.step_s:g} s",
        "generationTool": f"waxstudy {__version__}",
        "variableNamingConvention": "structured",
    }
    return Xml.Element("fmiModelDescription", said | ({"numberOfEventIndicators": "0"} if fmi == 2 else {}))


def _attributes(reference: int, variable: Variable) -> dict[str, str]:
    said = {
        "name": variable.name,
        "valueReference": str(reference),
        "description": variable.description,
        "causality": CAUSALITY.get(variable.causality, variable.causality),
        "variability": VARIABILITY.get(variable.causality, variable.causality),
    }
    initial = {"output": "calculated", "parameter": "exact", "constant": "exact"}.get(variable.causality)
    return said | ({"initial": initial} if initial else {})


def _of_type(variable: Variable) -> dict[str, str]:
    """Attributes that depend on the type: unit, bounds, start."""
    number = {"d": lambda value: repr(float(value)), "q": lambda value: str(int(value)), "?": _boolean}[variable.type]
    said: dict[str, str] = {}
    if variable.type == "d" and variable.unit:
        said["unit"] = unit_of(variable)
    if variable.type != "?" and variable.causality != "time":
        said |= {"min": number(variable.low), "max": number(variable.high)}
    if variable.causality not in ("time", "output"):
        said["start"] = number(variable.start)
    return said


def _boolean(value: float) -> str:
    return "true" if value else "false"


def _scalar2(parent: Xml.Element, reference: int, variable: Variable) -> None:
    scalar = Xml.SubElement(parent, "ScalarVariable", _attributes(reference, variable))
    Xml.SubElement(scalar, TYPE2[variable.type], _of_type(variable))


def _scalar3(parent: Xml.Element, reference: int, variable: Variable) -> None:
    Xml.SubElement(parent, TYPE3[variable.type], _attributes(reference, variable) | _of_type(variable))


def _structure(structure: Xml.Element, model: Model, fmi: int) -> None:
    outputs = [str(place) for place in _outputs(model)]
    if fmi == 2:
        for name in ("Outputs", "InitialUnknowns"):
            listed = Xml.SubElement(structure, name)
            for place in outputs:
                Xml.SubElement(listed, "Unknown", index=str(int(place) + 1))
        return
    for name in ("Output", "InitialUnknown"):
        for place in outputs:
            Xml.SubElement(structure, name, valueReference=place)


def _outputs(model: Model) -> Iterator[int]:
    yield from (place for place, variable in enumerate(model.variables) if variable.causality == "output")
