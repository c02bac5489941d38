"""Call a fleet of loops."""

from __future__ import annotations

import os
from pathlib import Path

from waxstudy.fleet.result import Activated, read_activated
from waxstudy.fleet.run import run
from waxstudy.report.fleet.page import as_html
from waxstudy.report.fleet.tables import as_csv
from waxstudy.results.atomic import whole_file
from waxstudy.simulation.run import Progress
from waxstudy.study.model import Study


def activate(
    study: Study, folder: Path, *, workers: int | None = None, jit: bool = True, progress: Progress | None = None
) -> Activated:
    """Call the fleet of a study, and return what came out; batches that the folder holds are not computed again.

    The folder gets the page and the table as CSV as well. Raises what `waxstudy.fleet.run.run` raises.
    """
    run(study, folder, workers or os.cpu_count() or 1, progress or Progress(), jit)
    found = read_activated(folder)
    for name, text in (("activation.csv", as_csv(found)), ("report.html", as_html(found))):
        with whole_file(folder / name) as path:
            path.write_text(text, encoding="utf-8")
    return found
