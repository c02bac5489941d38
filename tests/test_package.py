"""Claims about what is shipped: one version everywhere, and a wheel that works where nothing else of this folder is."""

from __future__ import annotations

import json
import re
import site
import subprocess
import sys
import tomllib
import venv
import zipfile
from pathlib import Path

import pytest

import waxstudy
from tests.conftest import ROOT, Waxstudy

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]


def test_all_that_describes_the_package_agrees() -> None:
    citation = (ROOT / "CITATION.cff").read_text().splitlines()
    code = json.loads((ROOT / "codemeta.json").read_text())
    assert f"version: {waxstudy.__version__}" in citation
    assert code["version"] == waxstudy.__version__
    assert f"license: {PROJECT['license']}" in citation
    assert code["license"].endswith(PROJECT["license"])
    assert code["description"] == PROJECT["description"]
    assert code["keywords"] == PROJECT["keywords"] == [line[4:] for line in citation if line.startswith("  - ")][1:6]


CONDA = ROOT / "packaging" / "conda" / "recipe.yaml"
CONDA_NAMES = {"matplotlib-base": "matplotlib"}  # where conda calls a package otherwise


def test_the_conda_recipe_renders_to_this_version_with_the_requirements_of_pyproject() -> None:
    conda = pytest.importorskip("rattler_build")
    (rendered,) = conda.Stage0Recipe.from_yaml(CONDA.read_text(encoding="utf-8")).render()
    recipe = rendered.recipe.to_dict()
    assert recipe["package"] == {"name": "waxstudy", "version": waxstudy.__version__}
    assert recipe["source"] == [{"path": f"../../dist/waxstudy-{waxstudy.__version__}.tar.gz"}]
    assert recipe["build"]["noarch"] == "python"
    python, *needed = (each.split(" ") for each in recipe["requirements"]["run"])
    assert python == ["python", PROJECT["requires-python"]]
    assert [CONDA_NAMES.get(name, name) + bounds for name, bounds in needed] == PROJECT["dependencies"]
    started = [f"{name} = {entry}" for name, entry in PROJECT["scripts"].items()]
    assert recipe["build"]["python"]["entry_points"] == started
    assert recipe["about"]["license"] == PROJECT["license"]


def test_what_is_run_with_the_oldest_dependencies_is_there_and_needs_no_more_than_is_installed_for_it() -> None:
    recipe = (ROOT / "Makefile").read_text(encoding="utf-8").split("\nlowest:")[1].split("\n\n")[0]
    installed = set(re.findall(r'"([a-z-]+)>=', recipe)) - {"uv"}
    of_dev = " ".join(PROJECT["optional-dependencies"]["dev"])
    assert [
        name for name in re.findall(r'"([a-z-]+>=[\d.]+)"', recipe) if name[:3] != "uv>" and name not in of_dev
    ] == []
    files = [file for name in (ROOT / "tests" / "lowest.txt").read_text().split() for file in _tests_below(ROOT / name)]
    imported = set(re.findall(r"^(?:import|from) (\w+)", "".join(file.read_text("utf-8") for file in files), re.M))
    own = {re.split(r"[<>=]", each)[0].replace("-", "_") for each in PROJECT["dependencies"]}
    ours = {
        "waxstudy",
        "waxstudy_paper",
        "waxstudy_effects",
        "waxstudy_enthalpy",
        "waxstudy_ramp",
        "tests",
        "docs_site",
    }
    assert imported - sys.stdlib_module_names - own - installed - ours == set()


def _tests_below(place: Path) -> list[Path]:
    found = sorted(place.rglob("*.py")) if place.is_dir() else [place]
    assert found, f"{place} holds no test"
    return found


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_shells_get_what_completes_commands_as_the_page_says(shell: str, waxstudy: Waxstudy) -> None:
    page = (ROOT / "docs" / "completion.md").read_text(encoding="utf-8")
    assert f"_WAXSTUDY_COMPLETE={shell}_source waxstudy" in page
    script = waxstudy(env={"_WAXSTUDY_COMPLETE": f"{shell}_source"}).stdout
    assert f"{shell}_complete" in script


def test_a_command_is_completed_with_its_options(waxstudy: Waxstudy) -> None:
    asked = {"_WAXSTUDY_COMPLETE": "bash_complete", "COMP_WORDS": "waxstudy diagnose --b", "COMP_CWORD": "2"}
    assert waxstudy(env=asked).stdout.split() == ["plain,--baseline", "plain,--baseline-days"]


@pytest.mark.slow
def test_a_wheel_from_the_source_archive_works_in_an_environment_of_its_own(tmp_path: Path) -> None:
    dist, fresh = tmp_path / "dist", tmp_path / "fresh"
    command = [sys.executable, "-m", "build", "--no-isolation", "--outdir", str(dist), str(ROOT)]
    subprocess.run(command, check=True, capture_output=True, timeout=300)
    assert [path.suffixes[-1] for path in sorted(dist.iterdir())] == [".whl", ".gz"]
    wheel = next(dist.glob("*.whl"))
    assert not [name for name in zipfile.ZipFile(wheel).namelist() if name.startswith(("tests", "plugins"))]
    venv.create(fresh, with_pip=True)
    python = fresh / ("Scripts" if sys.platform == "win32" else "bin") / "python"
    install = [python, "-m", "pip", "install", "--quiet", "--no-deps", "--no-index", wheel]
    subprocess.run(install, check=True, capture_output=True, timeout=300)
    # dependencies come from here, so that nothing is downloaded; the wheel's own code comes first
    where = subprocess.run(
        [python, "-c", "import site; print(site.getsitepackages()[0])"], capture_output=True, text=True
    )
    Path(where.stdout.strip(), "dependencies.pth").write_text("\n".join(site.getsitepackages()))
    asked = "import sys, waxstudy; print(waxstudy.__file__); from waxstudy.cli import main; main()"
    done = subprocess.run(
        [python, "-c", asked, "plugins", "list"], cwd=tmp_path, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(str(fresh))
    assert "variable-times" in done.stdout
