"""Compute the golden results again: `make golden`. A change of them belongs into CHANGELOG.md."""

from __future__ import annotations

import tempfile
from pathlib import Path

from tests.golden.results import GOLDEN, fleet, swept, table, traces


def main() -> None:
    GOLDEN.mkdir(parents=True, exist_ok=True)
    traces().to_csv(GOLDEN / "traces.csv", index=False)
    with tempfile.TemporaryDirectory() as folder:
        table(Path(folder) / "run").to_csv(GOLDEN / "table5.csv", index=False)
        fleet(Path(folder) / "fleet").to_csv(GOLDEN / "activation.csv", index=False)
        swept(Path(folder) / "sweep").to_csv(GOLDEN / "sweep.csv", index=False)


if __name__ == "__main__":
    main()
