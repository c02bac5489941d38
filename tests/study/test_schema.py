"""The JSON Schema of study files accepts and refuses what the reader does, as far as a schema can tell."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, Literal

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from jsonschema import Draft7Validator, ValidationError
from pydantic import model_validator

from tests.conftest import ROOT, SMALL, Waxstudy
from tests.study.regenerate_schema import COMMITTED, own, text
from tests.study.test_study_fuzz import mutated_studies
from tests.test_docs import PAGES, blocks
from waxstudy.plugin import Component, Parameters, parameter
from waxstudy.plugin.registry import PluginError, Registry
from waxstudy.study.model import is_safe_name
from waxstudy.study.read import StudyError, read_study
from waxstudy.study.schema import NAME, Json, described, needed_keys, schema
from waxstudy_paper.actuators import IdealActuator
from waxstudy_paper.room import NzebRoom
from waxstudy_paper.sensors import IdealSensor
from waxstudy_paper.weather import TallinnWeek


@cache
def own_schema() -> Json:
    return schema(own())


def refusals(study: str, registry: Registry | None = None) -> list[ValidationError]:
    """What an editor marks in a study; without a registry waxstudy's own components are known."""
    values = json.loads(json.dumps(tomllib.loads(study), default=str))
    return list(Draft7Validator(schema(registry) if registry else own_schema()).iter_errors(values))


def problems(study: str, folder: Path, registry: Registry | None = None) -> list[str]:
    """What the reader says of it."""
    path = folder / "x.toml"
    path.write_text(study, encoding="utf-8")
    try:
        read_study(path, registry or own())
    except StudyError as error:
        return [str(problem) for problem in error.problems]
    return []


def marks(study: str, registry: Registry | None = None) -> list[str]:
    """The places that are marked."""
    return [".".join(map(str, error.absolute_path)) for error in refusals(study, registry)]


# --- the schema itself -------------------------------------------------------------------------------


def test_the_committed_copy_is_current() -> None:
    # as values: versions of pydantic differ in the order of keys, and write 0 or 0.0
    current = json.loads(COMMITTED.read_text(encoding="utf-8")) == json.loads(text())
    assert current, "studies/study.schema.json is old: python -m tests.study.regenerate_schema"


def test_the_command_prints_a_valid_schema_with_every_installed_component(waxstudy: Waxstudy) -> None:
    done = waxstudy("schema")
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.endswith("}\n")
    printed = json.loads(done.stdout)
    Draft7Validator.check_schema(printed)
    assert printed["definitions"].keys() >= {
        f"{kind}.{name}" for kind, name in own().components if kind not in ("effect", "reference")
    }


def test_a_schema_without_any_component_is_valid_and_accepts_no_study() -> None:
    Draft7Validator.check_schema(schema(Registry()))
    assert marks(SMALL, Registry())


def test_every_parameter_tells_its_unit_default_and_source() -> None:
    band = own_schema()["definitions"]["controller.on-off"]["properties"]["dead_band_K"]
    assert band["description"] == (
        "Full width of the dead band, half above and half below the setpoint [K]. Default: 2.0. "
        "Source: Table 4, T_Db (2 K by default, 0.5 K adapted); full width is our reading."
    )
    assert (band["default"], band["minimum"], band["maximum"]) == (2.0, 0.0, 20.0)


def test_the_schema_holds_only_words_of_draft_07() -> None:
    # a parameter of a component may be called `unit`: its schema is a table, a word of ours would be a text
    assert re.findall(r'"(\$defs|prefixItems|null|source|title|unit(?=": "))":', text()) == ["title"]
    assert "null" not in text()


@given(st.text(st.sampled_from("aZ0_-. é/\0"), max_size=70) | st.text(max_size=4) | st.from_regex(NAME, fullmatch=True))
def test_names_follow_the_reader_s_rule(name: str) -> None:
    # JSON Schema's `$` is the end of the text, Python's also matches before a last line break
    assert bool(re.search(NAME.replace("$", r"\Z"), name)) == is_safe_name(name)


# --- what is right is accepted -----------------------------------------------------------------------

OF_PLUGINS = ("plugins.md", "plugin-tutorial-study.md", "enthalpy.md")  # pages about what this schema does not know
EXAMPLES = {
    **{path.name: path.read_text(encoding="utf-8") for path in (ROOT / "studies").glob("*.toml")},
    **{
        f"{page.name} {i}": block
        for page in PAGES
        if page.name not in OF_PLUGINS
        for i, block in enumerate(blocks(page, "toml"))
        if "[dataset]" not in block  # no study
    },
}


@pytest.mark.parametrize("example", EXAMPLES.values(), ids=EXAMPLES)
def test_every_study_and_every_example_of_the_pages_is_valid(example: str) -> None:
    values = tomllib.loads(SMALL) | tomllib.loads(example)  # some pages show a part
    assert [error.message for error in Draft7Validator(own_schema()).iter_errors(values)] == []


def test_the_resolved_study_is_valid(tmp_path: Path) -> None:
    (tmp_path / "x.toml").write_text(SMALL)
    resolved = json.loads(json.dumps(read_study(tmp_path / "x.toml", own()).described()))
    assert list(Draft7Validator(own_schema()).iter_errors(resolved)) == []


RIGHT = {
    "a whole number for a number": ("dead_band_K = 0.5", "dead_band_K = 1"),
    "only some of a product's times": ('"variable-times"', '"variable-times", product = "A", fall_s = 100.0'),
    "other parameters in a step without use": ("quick-opening", "linear"),
    "an empty change": ("{ dead_band_K = 0.5 }", "{}"),
    "the same use again": ("{ dead_band_K = 0.5 }", '{ use = "on-off", dead_band_K = 0.5 }'),
    "another use": ("{ dead_band_K = 0.5 }", '{ use = "pi", gain = 1 }'),
    "published figures": ('name = "small"', 'name = "small"\nagainst = "paper"'),
    "nested tables": ('use = "nzeb"', 'use = "nzeb"\ngains.mean_W_m2 = 3\ncircuit.heating_curve_C = [[-20, 35.0]]'),
    "no steps": (SMALL[SMALL.index("reference") :], 'reference = "a"\nstart = { id = "a", controller.use = "pi" }'),
}


@pytest.mark.parametrize(("old", "new"), RIGHT.values(), ids=RIGHT)
def test_what_the_reader_accepts_the_schema_accepts(tmp_path: Path, old: str, new: str) -> None:
    assert old in SMALL
    study = SMALL.replace(old, new)
    assert problems(study, tmp_path) == []
    assert marks(study) == []


# --- what is wrong is refused, in the right place ----------------------------------------------------

START, STEP = "ladder.on-off.start", "ladder.on-off.steps.0"

WRONG = {
    "a misspelled table": ("[ensemble]", "[ensembel]", ""),
    "a misspelled key": ("members", "memebrs", "ensemble"),
    "a misspelled key of a block": ('"on-off" }', '"on-off", dead_bnd_K = 1.0 }', f"{START}.controller"),
    "a misspelled key of a step": ("dead_band_K", "dead_bnd_K", f"{STEP}.controller"),
    "a key of another component": ('"on-off" }', '"on-off", gain = 1.0 }', f"{START}.controller"),
    "a misspelled key of a nested table": ('use = "nzeb"', 'use = "nzeb"\ngains.men_W_m2 = 3.0', "room.gains"),
    "a number out of its range": ("dead_band_K = 0.5", "dead_band_K = 20.5", f"{STEP}.controller.dead_band_K"),
    "a number at an open end": (
        'name = "small"\n',
        'name = "small"\n[comfort]\nhours_below_per_week = 168\n',
        "comfort.hours_below_per_week",
    ),
    "a text for a number": ("dead_band_K = 0.5", 'dead_band_K = "0.5"', f"{STEP}.controller.dead_band_K"),
    "a truth for a number": ("dead_band_K = 0.5", "dead_band_K = true", f"{STEP}.controller.dead_band_K"),
    "a broken whole number": ("members = 2", "members = 2.5", "ensemble.members"),
    "a number for a text": ('"small"', "5", "study.name"),
    "a list of the wrong length": ('"january"\n', '"january"\nsun_by_day = [1.0]\n', "weather.january.sun_by_day"),
    "a text in a list": (
        '"january"\n',
        '"january"\nsun_by_day = [1, 1, "1", 1, 1, 1, 1]\n',
        "weather.january.sun_by_day.2",
    ),
    "a point of three numbers": (
        '"nzeb"',
        '"nzeb"\ncircuit.heating_curve_C = [[1, 2, 3]]',
        "room.circuit.heating_curve_C.0",
    ),
    "an unknown choice": ('month = "january"', 'month = "janury"', "weather.january.month"),
    "an unknown component": ('"quick-opening"', '"quick"', "ladder.on-off.steps.1.valve.use"),
    "an unknown room": ('"nzeb"', '"nzbe"', "room.use"),
    "a component of another kind": ('"quick-opening"', '"pi"', "ladder.on-off.steps.1.valve.use"),
    "a number for a component": ('use = "nzeb"', "use = 3", "room.use"),
    "no room chosen": ('use = "nzeb"', "", "room"),
    "no block chosen": ('controller = { use = "on-off" }', "controller = {}", f"{START}.controller"),
    "a needed parameter that is missing": ('month = "january"', "", "weather.january"),
    "a file that is not named": ('use = "tallinn-week"\nmonth = "january"', 'use = "epw"', "weather.january"),
    "a block that is no table": ('{ use = "linear" }', '"linear"', f"{START}.valve"),
    "unknown published figures": ('name = "small"', 'name = "small"\nagainst = "papre"', "study.against"),
    "a bad name of the study": ('"small"', '"../small"', "study.name"),
    "a bad name of a week": ("[weather.january]", '[weather."a/b"]', "weather"),
    "a bad id": ('"O_CP"', '"O CP"', f"{STEP}.id"),
    "no name": ('name = "small"', "", "study"),
    "no id": ('id = "O_CP", ', "", STEP),
    "no controller": ('controller = { use = "on-off" }, ', "", START),
    "no reference": ('reference = "O_WM"', "", "ladder.on-off"),
    "no start": (SMALL[SMALL.index("start") :], "", "ladder.on-off"),
    "no weather": (SMALL[SMALL.index("[weather") : SMALL.index("[ens")], "", ""),
    "a weather without a name": ("[weather.january]", "[weather]", "weather.month"),
    "no study": ('[study]\nname = "small"', "", ""),
    "steps that are no list": (SMALL[SMALL.index("steps") :], "steps = 3", "ladder.on-off.steps"),
    "a step that is no table": ('{ id = "O_CP", controller = { dead_band_K = 0.5 } }', "3", STEP),
    "a misspelled block": ("actuator =", "actuatr =", "ladder.on-off.steps.1"),
    "a key that no ladder has": ("reference", "referenz", "ladder.on-off"),
}


@pytest.mark.parametrize(("old", "new", "place"), WRONG.values(), ids=WRONG)
def test_what_the_reader_refuses_the_schema_marks_at_its_place(tmp_path: Path, old: str, new: str, place: str) -> None:
    assert old in SMALL
    study = SMALL.replace(old, new)
    assert problems(study, tmp_path)
    assert place in marks(study)


def test_one_mistake_is_marked_once_and_says_what_is_allowed() -> None:
    (refused,) = refusals(SMALL.replace('"quick-opening"', '"quick"'))
    assert refused.message == "'quick' is not one of ['linear', 'quick-opening']"
    (refused,) = refusals(SMALL.replace("dead_band_K = 0.5", "dead_band_K = 50"))
    assert refused.message == "50 is greater than the maximum of 20.0"


# --- what only the reader sees -----------------------------------------------------------------------

# what a schema cannot see -> how the reader says it
UNSEEN = {
    "a step that does not divide the hour": r"must divide the hour",
    "the interval of the traces between steps": r"must be a multiple of step_s",
    "more traces than members": r"must be at most \[ensemble\] members",
    "a reference to no case": r"is no case of this ladder",
    "the same name twice, or in other capitals": r"there is a (week|case) of this name in line",
    "a step's change of what is not there yet": r"case [^:]*: \w+\.use: missing: no \w+ is chosen yet",
    "a step's parameter of another component than the one before": r"case [^:]*: [^:]*: unknown key",
    "what a component needs that a step changes to": r"case [^:]*: \w+\.\w+: missing \(",
    "what a component's own validators say": r"must be MM-DD|give either product or dead_s|\w+ failed: ",
    "a file that is not there": r"no such file",
    "a whole number written with a point": r"must be a whole number",
    "infinity and not-a-number": r"must be a finite number",
    "numbers beyond 64 bits, and very deep tables": r"whole numbers go up to|nested \d+ deep",
    "a line break at the end of a name": r"\bmust be at most 64 letters",
}

UNSEEN_EXAMPLES = [
    ('name = "small"', 'name = "small"\nstep_s = 7.0'),
    ("[ensemble]", "[output]\ntrace_interval_s = 7.0\n[ensemble]"),
    ("[ensemble]", "[output]\ntrace_members = 3\n[ensemble]"),
    ('reference = "O_WM"', 'reference = "O"'),
    ('id = "O_0"', 'id = "o_cp"'),
    ("controller = { dead_band_K = 0.5 }", "sensor = { delay_s = 5.0 }"),
    ("dead_band_K = 0.5", "gain = 0.5"),
    ('use = "tallinn-week"\nmonth = "january"', 'use = "epw"\nstart = "01-01"\npath = "none.epw"'),
    ("members = 2", "members = 2.0"),
    ("dead_band_K = 0.5", "dead_band_K = nan"),
]


@pytest.mark.parametrize(("old", "new"), UNSEEN_EXAMPLES)
def test_what_a_schema_cannot_see_is_left_to_the_reader(tmp_path: Path, old: str, new: str) -> None:
    assert old in SMALL
    study = SMALL.replace(old, new)
    assert marks(study) == []
    said = problems(study, tmp_path)
    assert said
    assert [line for line in said if not re.search("|".join(UNSEEN.values()), line)] == []


@settings(max_examples=300, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=mutated_studies())
def test_schema_and_reader_agree_on_any_damaged_study(data: bytes, tmp_path: Path) -> None:
    study = data.decode()
    said = problems(study, tmp_path)
    if not said:
        assert marks(study) == []
    elif not marks(study):
        assert [line for line in said if not re.search("|".join(UNSEEN.values()), line)] == []


# --- strangers ---------------------------------------------------------------------------------------


def component(base: type[Component], name: str, model: type[Parameters]) -> type[Component]:
    return type(name, (base,), {"name": name, "Parameters": model})


def quantity(description: str, default: Any = ..., unit: str = "", **options: Any) -> Any:
    return parameter(default, unit=unit, description=description, source="test", **options)


class Wax(Parameters):
    """Times that a product completes; only an example tells."""

    maker: str = quantity("maker")
    product: Literal["X"] | None = quantity("product", None)
    rise_s: float = quantity("rise time", unit="s", gt=0.0)

    @model_validator(mode="before")
    @classmethod
    def _complete(cls, data: Any) -> Any:
        return {"rise_s": 90.0, **data} if data.get("product") == "X" else data


class Shell(Parameters):
    wax: Wax = quantity("nested, and completed")
    pair: tuple[int, str] = (1, "a")


class Odd(Parameters):
    convert: Callable[[float], float] = float


class Either(Parameters):
    convert: float | Callable[[float], float] = 1.0


class Endless(Parameters):
    size: float = float("inf")


def with_strangers(*components: type[Component]) -> Registry:
    registry = own()
    for stranger in components:
        registry.add(stranger, "stranger", "1.0")
    return registry


def test_a_stranger_s_component_is_in_the_schema() -> None:
    registry = with_strangers(component(IdealSensor, "brisk", Wax))
    Draft7Validator.check_schema(schema(registry))
    change = SMALL.replace(
        'valve = { use = "quick-opening" }', 'sensor = { use = "brisk", maker = "M", rise_s = -1.0 }'
    )
    assert marks(change, registry) == ["ladder.on-off.steps.1.sensor.rise_s"]
    assert marks(change) == ["ladder.on-off.steps.1.sensor.use"]
    assert marks(change.replace('use = "brisk", ', ""), registry) == ["ladder.on-off.steps.1.sensor.rise_s"]


def test_only_what_no_validator_completes_is_needed() -> None:
    wax = component(IdealActuator, "wax", Wax)
    assert needed_keys(wax) == ["maker", "rise_s"]
    wax.examples = {"X": {"maker": "M", "product": "X"}}
    assert needed_keys(wax) == ["maker"]
    wax.examples = {"X": 3}  # type: ignore[dict-item]
    assert needed_keys(wax) == []
    shell = with_strangers(component(NzebRoom, "shell", Shell))
    assert marks(SMALL.replace('"nzeb"', '"shell"\nwax.product = "X"'), shell) == []
    assert marks(SMALL.replace('"nzeb"', '"shell"'), shell) == ["room"]


def test_tuples_are_checked_entry_by_entry() -> None:
    shell = with_strangers(component(NzebRoom, "shell", Shell))
    assert marks(SMALL.replace('"nzeb"', '"shell"\nwax = {}\npair = ["a", "a"]'), shell) == ["room.pair.0"]
    assert marks(SMALL.replace('"nzeb"', '"shell"\nwax = {}\npair = [1, "a", 2]'), shell) == ["room.pair", "room.pair"]


@pytest.mark.parametrize(
    ("model", "why"), [*((odd, "PydanticInvalidForJsonSchema") for odd in (Odd, Either)), (Endless, "ValueError")]
)
def test_parameters_that_cannot_be_described_take_nothing_else_down(model: type[Parameters], why: str) -> None:
    odd = component(TallinnWeek, "odd", model)
    assert f"No check of its parameters: {why}: " in described(odd)["description"]
    registry = with_strangers(odd, component(IdealSensor, "odd", model))
    Draft7Validator.check_schema(json.loads(json.dumps(schema(registry), allow_nan=False)))
    study = SMALL.replace('"tallinn-week"\nmonth = "january"', '"odd"\nanything = 3')
    assert marks(study, registry) == []
    assert marks(study.replace("members", "memebrs"), registry) == ["ensemble"]
    assert marks(SMALL.replace("controller = { dead_band_K = 0.5 }", "sensor = { anything = 3 }"), registry) == []


def test_a_name_that_two_packages_claim_is_not_offered(tmp_path: Path) -> None:
    registry = own()
    with pytest.raises(PluginError):
        registry.add(component(NzebRoom, "nzeb", Parameters), "stranger", "1.0")
    assert problems(SMALL, tmp_path, registry)
    assert marks(SMALL, registry) == ["room.use"]
