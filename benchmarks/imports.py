"""Time and memory of the import of a year, a row a minute and 12 channels: `python -m benchmarks.imports`.

The same year as a wide and as a long CSV. The limits are 60 s and 2 GB; seconds of processor stand beside those by the
clock, as others may be at work.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from benchmarks.commands import HEADINGS, command_figure
from benchmarks.house import write_year

LIMIT = "60 s, 2 GB"


def import_figures(folder: Path) -> None:
    print(f"\na year at 1 min, 12 channels\n{HEADINGS}")
    for file in write_year(folder):
        arguments = ["import", str(file), "--timezone", "Europe/Tallinn", "--yes", "--out", str(folder / file.stem)]
        command_figure(f"import of a {file.stem} CSV", arguments, LIMIT)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory(prefix="waxstudy-imports-") as place:
        import_figures(Path(place))
