"""What a second worker is worth in a sweep of 200 room-weeks: `python -m benchmarks.sweep`, a part of `make bench`."""

from __future__ import annotations

import tempfile
from pathlib import Path

from benchmarks.commands import HEADINGS, command_figure

STUDY = Path(__file__).parents[1] / "studies" / "table5.toml"
ROOMS, CASES_OF_ROOM = 100, ("O_0", "O_WM")  # together 200 room-weeks


def sweep_figure(folder: Path) -> None:
    """100 rooms, two cases each in one week."""
    study, sweep = folder / "rooms.toml", folder / "rooms-sweep.toml"
    whole = STUDY.read_text(encoding="utf-8")
    ladder = f"""
[ladder.on-off]
reference = "{CASES_OF_ROOM[1]}"
start = {{ id = "{CASES_OF_ROOM[0]}", controller = {{ use = "on-off" }} }}
steps = [{{ id = "{CASES_OF_ROOM[1]}", valve = {{ use = "quick-opening" }}, actuator = {{ use = "variable-times" }} }}]
"""
    study.write_text(whole[: whole.index("[weather.february]")] + "[ensemble]\nmembers = 1\n" + ladder)
    vary = "room.window_U_W_m2K = { low = 0.6, high = 1.2 }"
    sweep.write_text(f'[sweep]\nmethod = "latin-hypercube"\nsamples = {ROOMS}\n[vary]\n{vary}\n')
    weeks = ROOMS * len(CASES_OF_ROOM)
    print(f"\na sweep of {weeks} room-weeks, one member, in processes\n{HEADINGS}")
    options = ["run", str(study), "--sweep", str(sweep), "--executor", "processes"]
    one, two = (
        command_figure(f"workers: {n}", [*options, "--workers", str(n), "--out", str(folder / f"rooms-{n}")], "").wall_s
        for n in (1, 2)
    )
    print(f"{'':40} two workers are {one / two:.2f} times as fast as one (at least 1.7)")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        sweep_figure(Path(place))
