"""The commands of the README and of docs/ work as printed."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest

from docs_site.reference import PAGES as REFERENCE
from tests.conftest import DATA, ROOT, Waxstudy
from tests.importing.conftest import record, study
from tests.importing.exports import home_assistant_csv
from tests.importing.test_weather import weather_file
from tests.test_tutorial import TUTORIAL

__all__ = ["record", "study"]

PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
# of their outputs the diagnosis is compared, of the record that is made there
SHOWN = {ROOT / "docs" / "index.md": "data/first", ROOT / "docs" / "baseline.md": "data/room-10"}
# fewer members and longer steps than printed: attribution runs each member 44 times, and the sweep ten times the study
SHORTER = {"members = 16": "members = 2", "step_s = 5": "step_s = 30"}
DIAGNOSIS = (ROOT / "docs/diagnosis-tutorial.md", ROOT / "docs/diagnosis-tutorial-flow.md")  # their output is compared
SEASON = ROOT / "docs" / "season.md"  # it needs a weather year from outside the repository
HELSINKI = DATA / "weather" / "FIN_Helsinki.029740_IWEC.epw"
# two months of the season, one member in long steps
SHORT_SEASON = {
    '"09-01"': '"11-01"',
    "days = 273": "days = 61",
    "members = 4": "members = 1",
    "step_s = 5": "step_s = 60",
}
WIDTH = {"COLUMNS": "100"}  # as it says


def blocks(page: Path, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


def commands(program: str) -> list[str]:
    """Every command of a program in the shell blocks of the pages, without its comment, in order."""
    told = [block for page in PAGES if page not in (*TUTORIAL, *DIAGNOSIS, SEASON) for block in blocks(page, "sh")]
    lines = [line for block in told for line in block.replace("\\\n", "").splitlines()]
    return [line.split("  #")[0].strip() for line in lines if line.startswith(program)]


@pytest.mark.slow
def test_the_commands_of_the_pages_run_in_the_order_printed(
    waxstudy: Waxstudy, tmp_path: Path, record: pd.DataFrame
) -> None:
    shutil.copytree(ROOT / "studies", tmp_path / "studies")
    for file in (tmp_path / "studies" / name for name in ("table5.toml", "table5_smaller_floor.toml")):
        for as_printed, shorter in SHORTER.items():
            assert as_printed in file.read_text(encoding="utf-8")
            file.write_text(file.read_text(encoding="utf-8").replace(as_printed, shorter))
    standby = tmp_path / "studies" / "standby.toml"
    standby.write_text(
        standby.read_text(encoding="utf-8").replace("members = 8", "members = 2").replace("= 5\n", "= 20\n")
    )
    activation = tmp_path / "studies" / "activation.toml"
    activation.write_text(activation.read_text(encoding="utf-8").replace("loops = 1000", "loops = 20"))
    windows = tmp_path / "studies" / "sweeps" / "windows.toml"
    windows.write_text(windows.read_text(encoding="utf-8").replace("samples = 64", "samples = 2"))
    (thermostat,) = blocks(ROOT / "docs" / "first-study.md", "toml")
    (tmp_path / "thermostat.toml").write_text(thermostat)
    (fitted,) = blocks(ROOT / "docs" / "fit.md", "toml")
    (tmp_path / "fitted.toml").write_text(fitted)
    shutil.copytree(ROOT / "docs", tmp_path / "docs")
    assert home_assistant_csv(record, tmp_path).source.name == "history.csv"
    assert weather_file(f"{record.index[0]:%Y-%m-%d}", source="Actual", folder=tmp_path) == "tallinn.epw"
    printed = commands("waxstudy")
    assert len(printed) >= 4
    said: dict[str, str] = {}
    made_first = "waxstudy run studies/table5.toml"  # what `make run` calls
    for command in dict.fromkeys((made_first, *printed)):  # pages may share one
        done = waxstudy(*command.split()[1:], env=WIDTH)
        assert done.returncode == 0, f"{command}: {done.stderr}"
        said[command] = done.stdout
    assert said[made_first].splitlines()[-1] == "results/table5"
    for page, made in SHOWN.items():
        shown = page.read_text(encoding="utf-8")
        (diagnosis,) = re.findall(r"^waxstudy diagnose .*\n```\n```\n(.*?)^```", shown, re.MULTILINE | re.DOTALL)
        of_it = [command for command in printed if re.match(rf"waxstudy (reality|diagnose) .*{made}", command)]
        assert told("".join(said[command] for command in of_it)) == told(diagnosis)
    for block in blocks(ROOT / "docs" / "attribution.md", "python"):
        subprocess.run([sys.executable, "-c", block], cwd=tmp_path, check=True)
    assert (tmp_path / "results" / "table5.html").read_text(encoding="utf-8").startswith("<!DOCTYPE html>")


@pytest.mark.slow
def test_the_diagnosis_tutorial_prints_the_verdicts_and_causes_that_it_shows(
    waxstudy: Waxstudy, tmp_path: Path
) -> None:
    shutil.copytree(ROOT / "studies", tmp_path / "studies")
    pairs = [
        pair
        for page in DIAGNOSIS
        for pair in re.findall(r"^```sh\n(.*?)^```\n```\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S)
    ]
    assert len(pairs) == sum(len(blocks(page, "sh")) for page in DIAGNOSIS)
    for block, expected in pairs:
        done = [waxstudy(*line.split()[1:], env=WIDTH) for line in block.splitlines()]
        assert [each.returncode for each in done] == [0] * len(done), done[-1].stderr
        assert told("".join(each.stdout for each in done)) == told(expected)


@pytest.mark.slow
@pytest.mark.skipif(
    not HELSINKI.is_file(), reason=f"{HELSINKI} is not there; WAXSTUDY_DATA names the folder of the data"
)
def test_the_commands_of_the_season_run_and_two_months_have_its_differences(waxstudy: Waxstudy, tmp_path: Path) -> None:
    shutil.copytree(ROOT / "studies", tmp_path / "studies")
    file = tmp_path / "studies" / "season.toml"
    for as_printed, shorter in SHORT_SEASON.items():
        assert as_printed in file.read_text(encoding="utf-8")
        file.write_text(file.read_text(encoding="utf-8").replace(as_printed, shorter))
    (block,) = blocks(SEASON, "sh")
    for line in block.splitlines():
        done = waxstudy(*line.split("  #")[0].split()[1:], env={"WAXSTUDY_DATA": str(DATA)})
        assert done.returncode == 0, f"{line}: {done.stderr}"
    assert "Months and season" in (tmp_path / "season.html").read_text(encoding="utf-8")
    kpis = pd.read_csv(tmp_path / "results" / "season" / "kpis.csv").set_index("case")
    heat = kpis["heat_2001-11_kWh_m2"] + kpis["heat_2001-12_kWh_m2"]
    printed = {row[0].removesuffix(", %"): row for row in rows_of(SEASON) if row[0].endswith(", %") and len(row) == 10}
    for case, reference in (("O_0", "O_WM"), ("P_CP", "P_WM"), ("P_MC", "P_WM")):
        november, december = (float(printed[case][place].replace("−", "-")) for place in (3, 4))
        difference = 100.0 * (heat[case] / heat[reference] - 1.0)
        assert difference == pytest.approx((november + december) / 2.0, abs=1.0), case


def rows_of(page: Path) -> list[list[str]]:
    """The rows of a page's tables."""
    lines = [line for line in page.read_text(encoding="utf-8").splitlines() if line.startswith("| ")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


def told(printed: str) -> list[str]:
    """What must not change: verdicts, what they mean, and what is written where; not figures nor how lines are cut."""
    lines = [line for line in printed.splitlines() if re.match(r"data/|results/|cause |\S+: |[A-Z]", line)]
    return [re.sub(r"\d+(\.\d+)?", "0", line) for line in lines]


@pytest.mark.parametrize("command", sorted(set(commands("make")) | {"make golden", "make bench"}))
def test_every_make_target_of_the_pages_exists(command: str) -> None:
    tried = subprocess.run(["make", "-n", *command.split()[1:]], cwd=ROOT, capture_output=True, check=False)
    assert tried.returncode == 0


def test_every_link_between_the_pages_leads_somewhere() -> None:
    for page in [*PAGES, ROOT / "CHANGELOG.md", *(ROOT / "results" / "blind_test").rglob("*.md")]:
        for target, anchor in re.findall(r"\]\(([^)#:]*)#?([^):]*)\)", page.read_text(encoding="utf-8")):
            if target in REFERENCE:  # written while the site is built, which checks the rest
                continue
            to = page.parent / target if target else page
            assert to.exists(), f"{page.relative_to(ROOT)}: {target}"
            assert not anchor or anchor in anchors(to), f"{page.relative_to(ROOT)}: {target}#{anchor}"


def anchors(page: Path) -> set[str]:
    """The headings of a page as links name them."""
    headings = re.findall(r"^#+ (.+)", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}
