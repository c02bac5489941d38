"""Run a notebook's cells without Jupyter: lines with `!` are commands of waxstudy, figures are kept."""

from __future__ import annotations

import json
import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tests.conftest import ROOT, call

if TYPE_CHECKING:
    from matplotlib.figure import Figure

NOTEBOOKS = ROOT / "docs" / "notebooks"
PICTURES = ROOT / "docs" / "images"
NAMES = sorted(path.stem for path in NOTEBOOKS.glob("*.ipynb"))


def code_of(name: str) -> list[str]:
    """Return the code cells of a notebook."""
    cells = json.loads((NOTEBOOKS / f"{name}.ipynb").read_text(encoding="utf-8"))["cells"]
    return ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]


def executed(name: str, folder: Path) -> tuple[dict[str, Any], list[Figure]]:
    """Run a notebook in a folder, which is the current one; return its names, and the figures it made."""
    import matplotlib as mpl

    mpl.use("svg")
    import matplotlib.pyplot as plt

    def command(line: str) -> None:
        done = call(folder, *shlex.split(line)[1:])
        assert done.returncode == 0, f"{line}: {done.stderr}"

    names: dict[str, Any] = {"__command__": command}
    for cell in code_of(name):
        lines = [f"__command__({line[1:]!r})" if line.startswith("!") else line for line in cell.splitlines()]
        exec("\n".join(lines), names)
    figures = [names["figure"]] if "figure" in names else []
    plt.close("all")
    return names, figures


def draw(name: str, folder: Path) -> None:
    """Write the picture of a notebook that the pages show."""
    _, figures = executed(name, folder)
    for figure in figures:
        figure.savefig(PICTURES / f"notebook-{name}.svg", metadata={"Date": None})


if __name__ == "__main__":
    import os
    import sys
    from tempfile import TemporaryDirectory

    for each in sys.argv[1:] or NAMES:
        with TemporaryDirectory() as place:
            os.chdir(place)
            draw(each, Path(place))
