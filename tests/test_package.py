"""Claims about what is shipped: one version everywhere, and a wheel that works where nothing else of this folder is."""

from __future__ import annotations

import json
import site
import subprocess
import sys
import tomllib
import venv
import zipfile
from pathlib import Path

import pytest

import waxstudy
from tests.conftest import ROOT

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
