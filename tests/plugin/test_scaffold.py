"""Claims about a package that `plugins new` begins: it loads, conforms, passes its own tests, and its study runs."""

from __future__ import annotations

import json
import keyword
import os
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from tests.conftest import Waxstudy
from waxstudy import plugin
from waxstudy.conformance import assert_conforms
from waxstudy.plugin import CHAIN, KINDS, Reference
from waxstudy.plugin.registry import Registry, installed
from waxstudy.plugin.scaffold import LONGEST_NAME, NewPlugin, write
from waxstudy.plugin.structure import NAME
from waxstudy.study.read import read_study

EACH_KIND = pytest.mark.parametrize("kind", KINDS)


def begun(kind: str, place: Path) -> Path:
    """Begin a plugin and stand in for its installation with what an installer would write."""
    new = NewPlugin(f"my-{kind}", kind)
    folder = place / new.package
    write(new.files(), folder)
    project = tomllib.loads((folder / "pyproject.toml").read_text())["project"]
    about = folder / f"{new.module}-{project['version']}.dist-info"
    about.mkdir()
    (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {project['name']}\nVersion: {project['version']}\n")
    points = "".join(f"{name} = {module}\n" for name, module in project["entry-points"]["waxstudy"].items())
    (about / "entry_points.txt").write_text(f"[waxstudy]\n{points}")
    return folder


@pytest.fixture
def package(kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A package of this kind, begun and installed."""
    folder = begun(kind, tmp_path)
    monkeypatch.syspath_prepend(str(folder))
    installed.cache_clear()
    yield folder
    sys.modules.pop(NewPlugin(f"my-{kind}", kind).module, None)
    installed.cache_clear()


@EACH_KIND
def test_the_component_is_registered_by_its_package_and_keeps_the_contract(kind: str, package: Path) -> None:
    registry = installed()
    assert f"my-{kind}" not in registry.broken
    component = registry.get(kind, f"my-{kind}")
    assert str(registry.package_of(component)) == f"{kind} 'my-{kind}' of waxstudy-my-{kind} 0.1.0"
    assert_conforms(component)


@EACH_KIND
def test_the_study_is_valid_and_uses_the_component(kind: str, package: Path) -> None:
    study = read_study(package / "study.toml", installed())
    component = installed().get(kind, f"my-{kind}")
    (ladder,) = study.ladders.values()
    if kind in CHAIN:
        users = [id for id, case in study.cases.items() if any(c.component is component for c in case.blocks.values())]
        assert users == [ladder.cases[-1]] == [ladder.reference]
    elif issubclass(component, Reference):
        assert study.against == component.name
        assert {(row.case, row.week) for row in component.rows()} == {("O_0", "january"), ("O_CP", "january")}
        assert set(study.cases) == {"O_0", "O_CP"}
    elif kind != "effect":  # which no study names
        used = study.room if kind == "room" else study.weeks["example"]
        assert used.component is component
    assert study.ensemble.members == 2


def test_invented_figures_say_so_where_they_are_read() -> None:
    files = NewPlugin("rival", "reference").files()
    assert "# PLACEHOLDERS: these figures are invented." in files["waxstudy_rival.py"]
    assert "PLACEHOLDER" in files["README.md"]


@pytest.fixture(scope="module")
def every_package(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    place = tmp_path_factory.mktemp("begun")
    return [begun(kind, place) for kind in KINDS]


def test_the_files_are_formatted_and_have_no_lint(every_package: list[Path]) -> None:
    for arguments in (["check"], ["format", "--check"]):
        command = [sys.executable, "-m", "ruff", *arguments, "--no-cache", *map(str, every_package)]
        done = subprocess.run(command, cwd=every_package[0].parent, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout


def test_the_test_of_the_contract_holds_for_another_model_and_that_of_the_model_says_what_to_edit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = begun("actuator", tmp_path)
    module = folder / "waxstudy_my_actuator.py"
    text = module.read_text(encoding="utf-8")
    for old, new in (
        ("dead_time_s", "delay_s"),
        ("Parameters = MyActuatorParameters", "Parameters = Times"),
        ("class MyActuatorParameters", "class Times"),
        ("x.opening = min(1.0,", "x.opening = min(0.9,"),
    ):
        assert old in text
        text = text.replace(old, new)
    module.write_text(text, encoding="utf-8")
    monkeypatch.syspath_prepend(str(folder))
    namespace: dict[str, Any] = {}
    exec((folder / "tests" / "test_conformance.py").read_text(encoding="utf-8"), namespace)
    namespace["test_it_keeps_the_contract"]()
    for kind in set(KINDS) - {"reference"}:
        assert "EDIT THIS WITH THE MODEL" in NewPlugin("mine", kind).files()["tests/test_model.py"]
    sys.modules.pop("waxstudy_my_actuator")


@pytest.mark.slow
def test_the_packages_own_tests_pass(every_package: list[Path]) -> None:
    tests = [str(folder / "tests") for folder in every_package]
    env = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, every_package))}
    command = [sys.executable, "-m", "pytest", "-q", "-W", "error", "-p", "no:cacheprovider"]
    # one process for all; their files have the same name, which the usual way of importing would not bear
    command += ["--import-mode=importlib", f"--rootdir={every_package[0].parent}", *tests]
    done = subprocess.run(command, cwd=every_package[0].parent, env=env, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout
    assert f"{2 * len(KINDS) + 1} passed" in done.stdout  # two each, and one more of the reference


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["actuator", "room", "weather", "effect"])
def test_check_and_study_run_on_the_command_line(kind: str, tmp_path: Path, waxstudy: Waxstudy) -> None:
    folder = begun(kind, tmp_path)
    env = {"PYTHONPATH": str(folder)}
    checked = waxstudy("plugins", "check", f"my-{kind}", env=env)
    assert checked.returncode == 0, checked.stdout
    ran = waxstudy("run", folder / "study.toml", "--json", env=env)
    assert (ran.returncode, ran.stderr) == (0, "")
    rows = json.loads(ran.stdout)["rows"]
    assert [row["case"] for row in rows] == (["O_0", "O_CP", "O_NEW"] if kind in CHAIN else ["O_0", "O_CP"])
    for row in rows:
        assert row["hours_below_per_week"]["mean"] == pytest.approx(33.0, abs=0.5)  # equal comfort is within reach
        assert 0.5 < row["heat_kWh_m2_week"]["mean"] < 10.0
        assert row["cycles_per_week"]["mean"] > 2.0


# --- names -----------------------------------------------------------------------------------------

names = st.from_regex(NAME, fullmatch=True).filter(lambda name: len(name) <= LONGEST_NAME)


@settings(max_examples=25)
@given(names, st.sampled_from(KINDS))
@example("none", "actuator")
@example("actuator", "actuator")
@example("linear-room", "room")
@example("parameters", "sensor")
@example("w" * LONGEST_NAME, "valve")
def test_every_allowed_name_gives_a_module_that_python_reads(name: str, kind: str) -> None:
    new = NewPlugin(name, kind)
    assert list(new.problems(Registry())) == []
    assert new.class_name.isidentifier()
    assert not keyword.iskeyword(new.class_name)
    assert not hasattr(plugin, new.class_name)  # what the module imports stays what it is
    files = new.files()
    namespace: dict[str, object] = {"__name__": new.module}
    sys.modules[new.module] = sys.modules[__name__]  # dataclasses look their module up
    try:
        exec(compile(files[f"{new.module}.py"], new.module, "exec"), namespace)
    finally:
        del sys.modules[new.module]
    component = namespace[new.class_name]
    assert isinstance(component, type)
    assert (getattr(component, "name", ""), getattr(component, "kind", "")) == (name, kind)
    assert tomllib.loads(files["pyproject.toml"])["project"]["name"] == f"waxstudy-{name}"
    assert tomllib.loads(files["study.toml"])["study"]["name"] == name


@given(st.text().filter(lambda name: not NAME.fullmatch(name)))
@example("my_wax")
@example("wax-")
@example("2wax")
@example("wax\n")
@example("w" * (LONGEST_NAME + 1))
def test_any_other_name_is_refused_in_one_line(name: str) -> None:
    (problem,) = NewPlugin(name, "actuator").problems(Registry())
    assert "cannot be a name: lower-case letters" in problem
    assert problem.isprintable()


# --- writing ---------------------------------------------------------------------------------------


def test_a_failure_half_way_leaves_nothing_behind(tmp_path: Path) -> None:
    with pytest.raises(OSError, match=r"module\.py"):
        write({"module.py": "", "module.py/beneath": ""}, tmp_path / "package")
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_holds_something_is_never_written_over(tmp_path: Path) -> None:
    (tmp_path / "package").mkdir()
    (tmp_path / "package" / "mine").touch()
    with pytest.raises(OSError, match="package"):
        write({"module.py": ""}, tmp_path / "package")
    assert [file.name for file in tmp_path.rglob("*")] == ["package", "mine"]
