"""Compute the golden results again: `make golden`. A change of them belongs into CHANGELOG.md."""

from __future__ import annotations

import tempfile
from pathlib import Path

from tests.golden.results import GOLDEN, fleet, looped, season, swept, table, traces, tuned


def main() -> None:
    GOLDEN.mkdir(parents=True, exist_ok=True)
    traces().to_csv(GOLDEN / "traces.csv", index=False)
    looped().to_csv(GOLDEN / "loop.csv", index=False)
    with tempfile.TemporaryDirectory() as folder:
        table(Path(folder) / "run").to_csv(GOLDEN / "table5.csv", index=False)
        fleet(Path(folder) / "fleet").to_csv(GOLDEN / "activation.csv", index=False)
        season(Path(folder)).to_csv(GOLDEN / "season.csv", index=False)
        tuned(Path(folder) / "tuned").to_csv(GOLDEN / "tune.csv", index=False)
        swept(Path(folder) / "sweep").to_csv(GOLDEN / "sweep.csv", index=False)


if __name__ == "__main__":
    main()
