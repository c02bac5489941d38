"""The whole way by the command line: bench, actuator, valve, and a study that runs with both."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path

import pandas as pd
import pytest

from tests.cli.conftest import Entry
from tests.cli.conftest import entry as entry
from tests.conftest import SMALL, Waxstudy, call
from tests.fit.conftest import STEADY, table_of
from tests.report.test_page import Page
from waxstudy.plugin.registry import installed
from waxstudy.study.read import read_study

PROGRAMME = """\
combination,product,exemplar,valve,on_min,off_min,duration_min,measured
A1,A,1,no,15,15,180,displacement
A1,A,1,no,15,45,360,displacement
A1,A,1,no,5,25,180,displacement
A1,A,1,no,8,12,180,displacement
B1,B,1,no,15,15,180,displacement
B1,B,1,no,15,45,360,displacement
B1,B,1,no,10,10,180,displacement
B1,B,1,no,30,30,360,displacement
B1,B,1,no,5,5,60,displacement
B2m,B,2,yes,15,15,240,flow
"""


@pytest.fixture(scope="module")
def fits(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which the three commands have run; not to be changed."""
    folder = tmp_path_factory.mktemp("fits")
    (folder / "programme.csv").write_text(PROGRAMME)
    for command in (
        "rig bench --programme programme.csv",
        "fit actuator bench --out motor.toml",
        "fit valve bench/B2m_15-15.csv --actuator motor-B.toml --pressure-drops 2.9 30 --out valve.toml",
    ):
        done = call(folder, *command.split())
        assert (done.returncode, done.stderr) == (0, ""), command
        (folder / f"{command.split()[1]}.txt").write_text(done.stdout)
    return folder


def test_each_product_gets_a_fragment_a_page_and_its_figures(fits: Path) -> None:
    told = (fits / "actuator.txt").read_text()
    assert told.splitlines()[-3:] == ["motor.html", "motor-A.toml", "motor-B.toml"]
    assert "SIMULATED" in told
    figures = json.loads((fits / "motor.json").read_text())
    for product in "AB":
        fragment = tomllib.loads((fits / f"motor-{product}.toml").read_text())
        assert fragment["actuator"] == figures["products"][product]["actuator"]
        assert fragment["fit"]["product"] == product
        assert {each["file"] for each in fragment["fit"]["records"]} == {each["file"] for each in figures["records"]}
        assert all(re.fullmatch("[0-9a-f]{64}", each["sha256"]) for each in fragment["fit"]["records"])
    assert {each["name"]: each["cycles"] > 0 for each in figures["records"]}["A1_8-12"]


def test_a_study_takes_the_fitted_actuator_and_valve_and_runs(fits: Path, tmp_path: Path) -> None:
    valve, actuator = '{ from = "valve.toml" }', '{ from = "motor-B.toml" }'
    study = SMALL.replace('{ use = "quick-opening" }', valve).replace('{ use = "variable-times" }', actuator)
    (fits / "fitted.toml").write_text(study)
    done = call(fits, "run", "fitted.toml", "--out", str(tmp_path / "run"))
    assert done.returncode == 0, done.stderr
    assert "O_WM" in done.stdout
    blocks = read_study(fits / "fitted.toml", installed()).cases["O_WM"].blocks
    fragment = tomllib.loads((fits / "motor-B.toml").read_text())["actuator"]
    assert {**fragment, "form": "continuous"} == blocks["actuator"].described()
    assert blocks["valve"].described()["authority"] == pytest.approx(0.0967, abs=1e-4)


def test_the_pages_say_that_they_are_simulated_and_show_the_paper_s_figures(fits: Path) -> None:
    for name, numbers in (("motor.html", range(9, 15)), ("valve.html", (15, 16))):
        text = (fits / name).read_text(encoding="utf-8")
        page = Page(text)
        assert "simulated" in text.partition("</title>")[0]
        assert any("SIMULATED" in words for words in page.words)
        assert not re.search(r"Not drawn|https?://(?!www\.w3\.org)|<script", text)
        for number in numbers:
            assert any(f"figure {number})" in heading for heading in page.headings), number


def test_the_page_tells_what_json_and_summary_tell(fits: Path) -> None:
    page = Page((fits / "motor.html").read_text(encoding="utf-8"))
    figures = json.loads((fits / "motor.json").read_text())
    words = " ".join(page.words)
    for sentence in (*figures["untold"], *figures["steps"], *figures["warnings"]):
        assert sentence in words
    rows = {row[0]: row for row in page.texts}
    for record in figures["records"]:
        assert rows[record["name"]][-2] == f"{record['mae']:.3f}"


def test_where_a_given_authority_comes_from_is_said_below_the_table(fits: Path) -> None:
    told = (fits / "valve.txt").read_text()
    assert re.search(r"authority +0\.097 +given +authority of the valve", told)
    assert "note: the authority is from pressure drops of 2.9 kPa in the valve and 30 kPa of the pump\n" in told


def test_one_product_of_several_can_be_asked_for(entry: Entry, fits: Path) -> None:
    done = entry("fit", "actuator", fits / "bench", "--product", "A", "--out", "a.toml", "--json")
    assert done.code == 0
    assert tomllib.loads(Path("a.toml").read_text())["fit"]["product"] == "A"
    assert set(json.loads(done.stdout)["products"]) == {"A", "B"}
    refused = entry("fit", "actuator", fits / "bench", "--product", "C", "--out", "c.toml")
    assert (refused.code, Path("c.toml").exists()) == (2, False)
    assert "the records are of A, B" in refused.stderr


def test_a_lab_s_own_columns_are_named_by_options_or_by_records_toml(entry: Entry) -> None:
    own = table_of(STEADY).set_axis(["Zeit", "Weg", "U"], axis="columns")
    own.to_csv("lab.csv", sep=";", decimal=",", index=False)
    names = {"time": "Zeit", "displacement": "Weg", "signal": "U"}
    options = [text for what, name in names.items() for text in ("--column", f"{what}={name}")]
    first = entry("fit", "actuator", "lab.csv", "--product", "X", *options, "--out", "first.toml", "--json")
    assert first.code == 0, first.stderr
    Path("records.toml").write_text(
        "[columns]\n"
        + "".join(f'{what} = "{name}"\n' for what, name in names.items())
        + '[record.steady]\nfile = "lab.csv"\nproduct = "X"\nexemplar = "7"\n'
    )
    second = entry("fit", "actuator", ".", "--out", "second.toml", "--json")
    found = [json.loads(each.stdout)["products"]["X"]["actuator"] for each in (first, second)]
    assert found[0] == found[1]
    assert json.loads(second.stdout)["records"][0]["exemplar"] == "7"
    assert not json.loads(second.stdout)["simulated"]


def test_files_of_a_folder_are_described_however_they_are_named_and_flow_is_passed_over(
    entry: Entry, fits: Path
) -> None:
    files = sorted((fits / "bench").glob("*.csv"))
    devious = [fits / "bench" / ".." / "bench" / path.name for path in files]
    found = json.loads(entry("fit", "actuator", *devious, "--out", "m.toml", "--json").stdout)
    assert {each["product"] for each in found["records"]} == {"A", "B"}
    assert "B2m_15-15" not in {each["name"] for each in found["records"]}
    alone = entry("fit", "actuator", fits / "bench" / "B2m_15-15.csv", "--out", "n.toml")
    assert (alone.code, "displacement: no column has this name" in alone.stderr) == (3, True)
    swapped = entry("fit", "valve", fits / "bench" / "B1_15-15.csv", "--actuator", fits / "motor-B.toml")
    assert (swapped.code, "flow: no column has this name" in swapped.stderr) == (3, True)


def test_records_of_the_same_name_in_two_folders_are_two_records(entry: Entry) -> None:
    for seed, day in enumerate(("monday", "tuesday")):
        Path(day).mkdir()
        table_of(STEADY, seed=seed).to_csv(f"{day}/a.csv", index=False)
    done = entry("fit", "actuator", "monday/a.csv", "tuesday/a.csv", "--product", "X", "--out", "m.toml", "--json")
    records = json.loads(done.stdout)["records"]
    assert [(each["name"], each["cycles"]) for each in records] == [("monday/a", 8), ("tuesday/a", 8)]


def test_parquet_is_read_as_csv_is(entry: Entry) -> None:
    table = table_of(STEADY)
    stamps = pd.Timestamp("2024-03-01") + pd.to_timedelta(table.pop("time_s"), unit="s")
    table.assign(time=stamps).to_parquet("steady.parquet")
    done = entry("fit", "actuator", "steady.parquet", "--out", "motor.toml", "--json")
    assert (done.code, json.loads(done.stdout)["records"][0]["cycles"]) == (0, 8)


def test_problems_of_records_end_with_exit_code_3_and_write_nothing(entry: Entry) -> None:
    table_of(STEADY).assign(displacement_mm=8.0).to_csv("flat.csv", index=False)
    done = entry("fit", "actuator", "flat.csv", "--out", "motor.toml")
    assert (done.code, done.stdout) == (3, "")
    assert done.stderr == "flat.csv: displacement: has no stroke: it stays within 8 and 8, as noise does\n"
    table_of(STEADY).iloc[:1200].to_csv("half.csv", index=False)
    half = entry("fit", "actuator", "half.csv", "--out", "motor.toml")
    assert (half.code, half.stderr) == (3, "half.csv: no cycle can be used: cut off by the end (1)\n")
    assert not list(Path().glob("motor*"))


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (("fit", "actuator", "nothing.csv", "--out", "m.toml"), 2, "nothing.csv"),
        (("fit", "actuator", ".", "--out", "m.toml"), 2, "there is no displacement record in these folders"),
        (("fit", "actuator", ".", "--out", "no/where/m.toml"), 2, "is no folder to write to"),
        (("fit", "actuator", ".", "--column", "force=F", "--out", "m.toml"), 2, "is not one of time, signal"),
        (("fit", "valve", "flow.csv", "--actuator", "motor.toml"), 2, "does not exist"),
    ],
)
def test_what_is_asked_wrongly_is_told(entry: Entry, arguments: tuple[str, ...], code: int, said: str) -> None:
    done = entry(*arguments)
    assert (done.code, done.stdout) == (code, "")
    assert said in done.stderr
    assert "Traceback" not in done.stderr


def test_what_is_wrong_with_a_fragment_or_the_authority_is_told(entry: Entry, fits: Path) -> None:
    flow, motor = fits / "bench" / "B2m_15-15.csv", fits / "motor-B.toml"
    both = entry("fit", "valve", flow, "--actuator", motor, "--authority", "0.1", "--pressure-drops", "1", "2")
    assert (both.code, "give one of them" in both.stderr) == (2, True)
    larger = entry("fit", "valve", flow, "--actuator", motor, "--pressure-drops", "30", "2.9")
    assert (larger.code, "cannot take more than the pump gives" in larger.stderr) == (2, True)
    pascal = entry("fit", "valve", flow, "--actuator", motor, "--pressure-drops", "2900", "30000")
    assert (pascal.code, "in kPa, at most 1000" in pascal.stderr) == (2, True)
    wrong = entry("fit", "valve", flow, "--actuator", fits / "valve.toml")
    assert (wrong.code, "the file describes no actuator" in wrong.stderr) == (3, True)
    Path("odd.toml").write_text('[actuator]\nuse = "variable-times"\nproduct = "B"\nfall_s = -3.0\n')
    odd = entry("fit", "valve", flow, "--actuator", "odd.toml")
    assert (odd.code, "fall_s" in odd.stderr) == (3, True)


def test_a_misspelled_key_of_records_toml_is_told_with_its_line(entry: Entry) -> None:
    table_of(STEADY).to_csv("a.csv", index=False)
    Path("records.toml").write_text('[record.a]\nfile = "a.csv"\nprodukt = "X"\n')
    done = entry("fit", "actuator", "a.csv", "--out", "m.toml")
    assert done.code == 3
    assert "records.toml:3: [record.a] produkt: unknown key; did you mean 'product'?" in done.stderr


def test_records_of_the_bench_stay_simulated_without_their_description(entry: Entry, fits: Path) -> None:
    for name in ("B1_15-15", "B2m_15-15"):
        Path(f"{name}.csv").write_bytes((fits / "bench" / f"{name}.csv").read_bytes())
    assert json.loads(entry("fit", "actuator", "B1_15-15.csv", "--out", "m.toml", "--json").stdout)["simulated"]
    assert Path("m.toml").read_text().startswith("# SIMULATED")
    Path("n.toml").write_text('[actuator]\nuse = "variable-times"\nproduct = "B"\n')
    done = entry("fit", "valve", "B2m_15-15.csv", "--actuator", "n.toml", "--json")
    assert json.loads(done.stdout)["simulated"]


def test_what_is_read_is_never_overwritten(entry: Entry, fits: Path) -> None:
    table_of(STEADY).to_csv("a.csv", index=False)
    Path("records.toml").write_text('[record.a]\nfile = "a.csv"\nproduct = "X"\n')
    Path("a.toml").symlink_to("a.csv")
    before = {path.name: path.read_bytes() for path in Path().iterdir()}
    for out in ("records.toml", f"../{Path.cwd().name}/records.toml", "a.toml", "a.csv"):
        done = entry("fit", "actuator", ".", "--out", out)
        assert (done.code, done.stdout) == (2, ""), out
        assert out in done.stderr
    Path("motor.toml").write_bytes((fits / "motor-B.toml").read_bytes())
    flow = fits / "bench" / "B2m_15-15.csv"
    assert entry("fit", "valve", flow, "--actuator", "motor.toml", "--out", "motor.toml").code == 2
    assert Path("motor.toml").read_bytes() == (fits / "motor-B.toml").read_bytes()
    assert {name: Path(name).read_bytes() for name in before} == before


def test_a_folder_in_the_place_of_any_file_is_told_before_the_work(entry: Entry) -> None:
    for number in range(3):
        table_of(STEADY, seed=number).to_csv(f"{number}.csv", index=False)
    Path("records.toml").write_text(
        "".join(
            f'[record.r{n}]\nfile = "{n}.csv"\nproduct = "{p}"\n' for n, p in enumerate(("T/W 1", "T-W-1", "t-w-1"))
        )
    )
    for name in ("m.json", "m.html", "m-T-W-1.toml"):
        Path(name).mkdir()
        done = entry("fit", "actuator", ".", "--out", "m.toml")
        assert (done.code, f"{name}: this is a folder" in done.stderr) == (2, True)
        Path(name).rmdir()
    done = entry("fit", "actuator", ".", "--out", "m.toml")
    assert done.code == 0, done.stderr
    files = done.stdout.splitlines()[-3:]
    assert files == ["m-T-W-1.toml", "m-T-W-1-2.toml", "m-t-w-1-3.toml"]
    assert {tomllib.loads(Path(name).read_text())["fit"]["product"] for name in files} == {"T/W 1", "T-W-1", "t-w-1"}


def test_help_lists_both_fits(waxstudy: Waxstudy) -> None:
    told = waxstudy("fit", "--help").stdout
    assert "actuator" in told
    assert "valve" in told
