"""Studies and records that are spoilt: each ends in finite results, or in an error that names the file."""

from __future__ import annotations

import json
from pathlib import Path
from random import Random

from tests.attack.campaign import Ground
from tests.attack.mutations import mutated, spoilt
from tests.attack.verdict import DONE, not_finite, wrong_with
from tests.conftest import SMALL

LIMIT_S = 120.0  # for what takes a second or two on an idle machine

STUDY = SMALL.replace('name = "small"\n', 'name = "small"\nstep_s = 30.0\n').replace("members = 2", "members = 1")


def study(ground: Ground, folder: Path, number: int, random: Random) -> str:
    (folder / "s.toml").write_bytes(mutated(STUDY, random))
    ended = ground.worker.call(folder, "run", "s.toml", "--quiet", "--json", "--out", "run", limit_s=LIMIT_S)
    if wrong := wrong_with(ended, ["s.toml"]):
        return wrong
    if ended.code == DONE:
        json.loads(ended.stdout)
        return not_finite(folder / "run" / "kpis.csv")
    return ""


def _made(ground: Ground) -> Path:
    """Records that are good: of a loop for four days, and of a motor on the bench."""

    def make(folder: Path) -> None:
        (folder / "s.toml").write_text(STUDY)
        call = ground.worker.call
        days = ("--days", "4", "--interval-s", "300", "--out", "room")
        assert call(folder, "reality", "s.toml", "--case", "O_WM", *days, limit_s=LIMIT_S).code == DONE
        assert call(folder, "rig", "bench", limit_s=LIMIT_S).code == DONE

    return ground.once("records", make)


def record(ground: Ground, folder: Path, number: int, random: Random) -> str:
    """Every third one is of a motor, the others of a loop: of two in three of them the data are spoilt."""
    made = _made(ground)
    if number % 3 == 0:
        name = random.choice(sorted(path.name for path in (made / "bench").glob("B1_*.csv")))
        (folder / name).write_bytes(spoilt((made / "bench" / name).read_text(), random))
        ended = ground.worker.call(folder, "fit", "actuator", name, "--out", "motor.toml", limit_s=LIMIT_S)
        return wrong_with(ended, [name])
    room = folder / "room"
    room.mkdir()
    about, data = (made / "room" / name for name in ("dataset.toml", "data.csv"))
    of_data = random.random() < 2 / 3
    (room / "data.csv").write_bytes(spoilt(data.read_text(), random) if of_data else data.read_bytes())
    (room / "dataset.toml").write_bytes(about.read_bytes() if of_data else mutated(about.read_text(), random))
    # the room itself is long to judge: what reads a record is asked, and what judges the chain
    without = random.random() < 0.9
    if without:
        _leave_out_room(room)
    command = ("diagnose", "room", "--quick", "--quiet", "--json")
    ended = ground.worker.call(folder, *command, limit_s=LIMIT_S if without else 3 * LIMIT_S)
    if wrong := wrong_with(ended, ["room/dataset.toml", "room/data.csv"]):
        return wrong
    if ended.code == DONE:
        found = json.loads(ended.stdout, parse_constant=lambda word: f"!{word}")
        return f"{found}" if "!NaN" in str(found) else ""
    return ""


def _leave_out_room(room: Path) -> None:
    """Drop the outdoor temperature's name, without which no room can be driven."""
    data = (room / "data.csv").read_bytes()
    (room / "data.csv").write_bytes(data.replace(b"outdoor_temperature_C", b"not_outdoors", 1))
