"""What a correct study file means."""

import json
import math
import re
from collections.abc import Callable
from pathlib import Path

import pytest
import tomli_w

from docs_site.keys import study_keys
from waxstudy.plugin.registry import Registry, installed
from waxstudy.results.kpis import TRACE_CHANNELS
from waxstudy.study.model import Case, Comfort, Ensemble, Output, Study, StudyTable
from waxstudy.study.read import StudyError, read_study

Read = Callable[[str], Study]

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "studies" / "table5.toml"
HEAD = """
[study]
name = "s"
[room]
use = "nzeb"
[weather.january]
use = "tallinn-week"
month = "january"
"""
LADDER = HEAD + '[ladder.a]\nreference = "C_0"\nstart = { id = "C_0", controller = { use = "on-off" } }\n'


def parameters(case: Case, kind: str) -> dict[str, object]:
    return case.blocks[kind].parameters.model_dump()


@pytest.fixture
def study(registry: Registry) -> Study:
    return read_study(EXAMPLE, registry)


def test_ladders_weeks_and_cases_keep_the_order_of_the_file(study: Study) -> None:
    assert study.ladders["on-off"].cases == ["O_0", "O_CP", "O_D", "O_VC", "O_WM"]
    assert list(study.cases) == [id for ladder in study.ladders.values() for id in ladder.cases]
    assert list(study.weeks) == ["january", "february"]
    assert {ladder.name: ladder.reference for ladder in study.ladders.values()} == {"on-off": "O_WM", "pi": "P_WM"}


def test_a_step_without_use_changes_only_the_named_parameters(study: Study) -> None:
    assert parameters(study.cases["P_CP"], "controller") == {
        "gain": 18.0,
        "integration_time_s": 2300.0,
        "tracking_time_s": 30.0,
    }


def test_a_step_with_another_use_replaces_the_block(study: Study) -> None:
    assert [study.cases[id].blocks["valve"].component.name for id in ("P_D", "P_VC", "P_WM")] == [
        "linear",
        "quick-opening",
        "quick-opening",
    ]


def test_a_replaced_block_keeps_nothing_of_the_one_before(read: Read) -> None:
    text = LADDER + 'steps = [{ id = "C_1", controller = { use = "pi", gain = 5.0 } },\n'
    text += '{ id = "C_2", controller = { use = "on-off", dead_band_K = 0.1 } },\n'
    text += '{ id = "C_3", controller = { use = "pi" } }]\n'
    assert parameters(read(text).cases["C_3"], "controller")["gain"] == 0.3


def test_the_same_use_given_again_changes_only_the_named_parameters(read: Read) -> None:
    text = LADDER + 'steps = [{ id = "C_1", controller = { use = "pi", gain = 5.0 } },\n'
    text += '{ id = "C_2", controller = { use = "pi", tracking_time_s = 9.0 } }]\n'
    case = read(text).cases["C_2"]
    assert parameters(case, "controller") == {"gain": 5.0, "integration_time_s": 300.0, "tracking_time_s": 9.0}


def test_a_case_holds_only_the_kinds_that_are_present_in_the_order_of_the_chain(study: Study) -> None:
    assert list(study.cases["O_0"].blocks) == ["controller", "valve"]
    assert list(study.cases["P_WM"].blocks) == ["sensor", "controller", "modulator", "actuator", "valve"]


def test_a_ladder_may_have_no_steps(read: Read) -> None:
    assert list(read(LADDER).cases) == ["C_0"]


def test_steps_may_be_written_as_an_array_of_tables(read: Read) -> None:
    text = LADDER + '[[ladder.a.steps]]\nid = "C_1"\ncontroller.dead_band_K = 1\n'
    assert parameters(read(text).cases["C_1"], "controller") == {"dead_band_K": 1.0}


def test_tables_that_are_left_out_have_their_defaults(read: Read) -> None:
    study = read(LADDER)
    assert (study.step_s, study.comfort, study.ensemble, study.output) == (5.0, Comfort(), Ensemble(), Output())


@pytest.mark.parametrize(
    ("step_s", "interval_s"), [(5, 60.0), (8, 64.0), (45, 90.0), (0.1, 60.0), (7.2, 64.8), (60, 60.0)]
)
def test_traces_are_kept_each_minute_or_at_the_next_multiple_of_the_step(
    read: Read, step_s: float, interval_s: float
) -> None:
    study = read(LADDER.replace('name = "s"', f'name = "s"\nstep_s = {step_s}'))
    assert math.isclose(study.output.trace_interval_s, interval_s)


def test_a_path_is_relative_to_the_study_file(
    tmp_path: Path, registry: Registry, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "studies"
    folder.mkdir()
    (folder / "own.epw").touch()
    week = 'use = "tallinn-week"\nmonth = "january"'
    (folder / "x.toml").write_text(LADDER.replace(week, 'use = "epw"\npath = "own.epw"'))
    monkeypatch.chdir(tmp_path)
    study = read_study(Path("studies/x.toml"), registry)
    assert study.weeks["january"].parameters.model_dump()["path"] == str(folder / "own.epw")

    (tmp_path / "run.toml").write_text(tomli_w.dumps(study.described()))
    assert read_study(tmp_path / "run.toml", registry) == study, "a run folder is elsewhere"

    (folder / "own.epw").unlink()
    with pytest.raises(StudyError, match="no such file"):
        read_study(tmp_path / "run.toml", registry)
    assert read_study(tmp_path / "run.toml", registry, needs_files=False) == study, "enough for a report"


def order(study: Study) -> list[object]:
    blocks = [(id, list(case.blocks)) for id, case in study.cases.items()]
    return [list(study.weeks), [(ladder.name, list(ladder.cases)) for ladder in study.ladders.values()], blocks]


NESTED = """
surfaces = [{ area_m2 = 4, layers = [{ thickness_m = 0.1 }, { thickness_m = 0.2, material = "concrete" }] }]
curve = [1, 2]
"""
ROUND_TRIPS = {
    "small": LADDER,
    "nested": LADDER.replace('use = "nzeb"', 'use = "nzeb"' + NESTED),
    "there and back": LADDER + 'steps = [{ id = "C_1", actuator = { use = "variable-times", product = "A" } },\n'
    '{ id = "C_2", controller = { use = "pi", gain = 5.0 } }, { id = "C_3", controller = { use = "on-off" } }]\n',
    "odd step": LADDER.replace('name = "s"', 'name = "s"\nstep_s = 7.2'),
}


@pytest.mark.parametrize("text", ROUND_TRIPS.values(), ids=ROUND_TRIPS.keys())
def test_the_resolved_study_reads_as_the_same_study(read: Read, text: str) -> None:
    study = read(text)
    again = read(tomli_w.dumps(study.described()))
    assert again == study
    assert order(again) == order(study)
    assert again.described() == study.described()


def test_the_resolved_study_of_the_paper_reads_as_the_same_study(tmp_path: Path) -> None:
    study = read_study(EXAMPLE, installed())
    path = tmp_path / "study.toml"
    path.write_text(tomli_w.dumps(study.described()), encoding="utf-8")
    again = read_study(path, installed())
    assert again == study
    assert order(again) == order(study)


def test_the_resolved_study_has_every_default_filled_in(read: Read) -> None:
    described = read(LADDER).described()
    assert described["room"] == {
        "use": "nzeb",
        "height_m": 2.6,
        "surfaces": [],
        "storeys": 1,
        "heated": True,
        "flow": "design",
    }
    assert described["ladder"]["a"]["start"]["controller"] == {"use": "on-off", "dead_band_K": 2.0}
    assert described["comfort"]["hours_below_per_week"] == 33.0


@pytest.mark.parametrize(
    ("model", "page_of_it"),
    [
        (StudyTable, "study-file.md"),
        (Comfort, "study-comparison.md"),
        (Ensemble, "study-comparison.md"),
        (Output, "study-problems.md"),
    ],
)
def test_the_reference_gives_every_key_with_its_default_and_a_page_names_it(
    model: type[StudyTable], page_of_it: str
) -> None:
    reference, page = study_keys(), (ROOT / "docs" / page_of_it).read_text(encoding="utf-8")
    for name, declared in model.model_fields.items():
        row = re.search(rf"^\| `{name}` \|.*$", reference, re.MULTILINE)
        assert row, name
        has_default = not declared.is_required() and declared.default is not None
        given = f"`{json.dumps(declared.default)}`" if has_default else "required" if declared.is_required() else ""
        assert f"| {given} |" in row[0], row[0]
        assert f"`{name}`" in page


def test_the_reference_page_names_the_components_that_come_along() -> None:
    page = (ROOT / "docs" / "study-file.md").read_text(encoding="utf-8")
    for (kind, name), entry in installed().components.items():
        if entry.package == "waxstudy" and kind not in ("effect", "reference"):
            assert re.search(rf"^\| {kind} \|.*`{name}`", page, re.MULTILINE), (kind, name)


def test_the_page_of_traces_names_every_channel_of_them() -> None:
    page = (ROOT / "docs" / "study-problems.md").read_text(encoding="utf-8")
    assert [name for name in TRACE_CHANNELS if f"`{name}`" not in page] == []


def test_the_study_on_the_reference_page_reads(tmp_path: Path) -> None:
    page = (ROOT / "docs" / "study-file.md").read_text(encoding="utf-8")
    [text] = [each for each in re.findall(r"```toml\n(.*?)```", page, re.DOTALL) if each.startswith("[study]")]
    (tmp_path / "x.toml").write_text(text)
    assert list(read_study(tmp_path / "x.toml", installed()).cases) == ["O_0", "O_CP", "O_D"]
