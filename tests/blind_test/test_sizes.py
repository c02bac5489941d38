"""Claims about true gaps, their floors, and what nobody could tell from a cause."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from tests.blind_test.test_engines import case_of, recorded
from waxstudy.blind_test.draw import Case
from waxstudy.blind_test.record import without_noise
from waxstudy.blind_test.sizes.record import Record
from waxstudy.blind_test.truth import Size, Stand, cut_of_effect, sizes
from waxstudy.plugin import Effect
from waxstudy.plugin.trial import Unmakeable

TRIES = 40
WITHOUT_DIAGNOSIS = """\
import sys
from pathlib import Path
sys.modules["waxstudy.diagnosis"] = None  # as if there were none
from tests.blind_test.test_sizes import size_of
print(size_of("let-by", Path(sys.argv[1])).channel)
"""


def drawn(cause: str, folder: Path, least: float = 2.0) -> Case:
    """Return the first case of the fast room with a cause that is so far above its floor."""
    for seed in range(TRIES):
        try:
            case = case_of("fast-room", [cause], seed)
            size = sized(case, folder)
        except Unmakeable:
            continue
        if size and size.over > least:
            return case
    raise AssertionError(f"{cause} never shows")


def sized(case: Case, folder: Path, with_alike: bool = False) -> Size | None:
    (size,) = sizes(case, *recorded(case, folder), with_alike=with_alike)
    return size


def size_of(cause: str, folder: Path) -> Size:
    size = sized(drawn(cause, folder), folder, with_alike=True)
    assert size
    return size


def test_sizes_need_nothing_of_the_diagnosis(tmp_path: Path) -> None:
    command = [sys.executable, "-c", WITHOUT_DIAGNOSIS, str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=Path(__file__).parents[2])
    assert (done.returncode, done.stdout) == (0, "flow_L_h\n"), done.stderr


def test_the_gap_of_a_bias_is_the_bias_and_its_floor_the_noise_of_a_smoothed_thermometer(tmp_path: Path) -> None:
    case = drawn("sensor-bias", tmp_path)
    size = sized(case, tmp_path)
    assert size
    assert size.channel == "sensor_temperature_C"
    assert size.gap == pytest.approx(abs(case.scene["causes"][0]["values"]["bias_K"]), rel=0.02)
    # a parabola through 25 samples leaves sqrt(9 / (4 * 25)) of 0.03 K, of the air and of the sensor
    assert size.floor == pytest.approx(0.03 * 0.3 * 2.0**0.5, rel=0.15)


def test_lost_samples_are_no_noise(tmp_path: Path) -> None:
    case = drawn("let-by", tmp_path)
    lost = replace(case, measured=replace(case.measured, missing=0.02))
    assert sized(lost, tmp_path) == sized(case, tmp_path)


def test_what_gives_the_same_flow_is_alike_and_what_does_not_is_told_apart(tmp_path: Path) -> None:
    size = size_of("let-by", tmp_path)
    assert "stuck-open" in size.alike
    assert not {"low-authority", "quick-opening", "let-by"} & set(size.alike)
    assert size.beyond == pytest.approx(size.over)  # nothing is unknown of a valve


def test_what_the_unknowns_of_a_room_explain_is_alike_with_every_effect_that_can_do_nothing(tmp_path: Path) -> None:
    size = size_of("thermal-mass", tmp_path)  # by less than anybody knows of furniture
    assert size.beyond < 1.0 < size.over
    assert {"infiltration", "solar-factor", "supply-offset"} <= set(size.alike)


@pytest.mark.parametrize(
    ("cause", "least"),
    [("slow-actuator", 2.0), ("dead-band", 2.0), ("quick-opening", 2.0), ("infiltration", 80.0), ("gain-shift", 60.0)],
)
def test_a_refit_finds_the_effect_that_made_a_record(cause: str, least: float, tmp_path: Path) -> None:
    """So what is not alike was not merely overlooked, however far the room's unknowns went without it."""
    case = drawn(cause, tmp_path, least)
    staged, seen = recorded(case, tmp_path)
    own, free = staged.effects[0], without_noise(staged, case.measured)
    assert own
    noisy = [Record.of(seen.values, seen, is_noisy=True)]
    stand = Stand(seen, Record.of(free.values, seen), noisy, staged.departures)
    stretch = stand.stretch_of(case.causes[0])
    assert stretch
    refit = stand.refit(stretch, stand.free, (), cut_of_effect(stand, stretch, [own], []).floors)
    assert issubclass(own.component, Effect)
    assert refit.beyond > 1.0
    assert refit.is_alike(own.component)
