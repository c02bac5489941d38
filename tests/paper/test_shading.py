"""Claims about external shading: it holds back the windows' sun when it is drawn, and nothing else."""

from __future__ import annotations

import numpy as np
import pytest

from waxstudy.plugin import WeatherRecord
from waxstudy.plugin.registry import installed
from waxstudy.simulation.recorded import sun_W
from waxstudy_paper.room.conditions import Shading
from waxstudy_paper.room.nzeb import NzebRoom
from waxstudy_paper.room.surfaces import SurfacesRoom

HOURS = np.arange(48)
SOUTH = "azimuth 180 tilt 90"


def sunny(irradiance_W_m2: float = 400.0, first_day: str = "2001-01-31") -> WeatherRecord:
    sun = {name: np.full(48, irradiance_W_m2) for name in (SOUTH, "azimuth 270 tilt 90")}
    return WeatherRecord(3600.0, first_day, np.zeros(48), sun)


def drawn(**stated: object) -> np.ndarray:
    """In which hours of 31 January and 1 February half of 400 W/m2 passes."""
    passed = Shading(passes=0.5, **stated).passed(sunny(), SOUTH)
    assert set(passed) <= {200.0, 400.0}
    return np.flatnonzero(passed == 200.0)


def test_it_is_drawn_by_irradiance_hour_and_month() -> None:
    assert np.array_equal(drawn(), HOURS)
    assert not drawn(above_W_m2=400.0).size
    assert np.array_equal(drawn(from_hour=10.0, to_hour=12.0), [10, 11, 34, 35])
    assert np.array_equal(drawn(months=(2, 7)), HOURS[24:])


def test_the_room_gets_the_share_that_passes_and_no_wall_less_sun() -> None:
    def of(passes: float, absorptance: float) -> np.ndarray:
        stated = NzebRoom.description(NzebRoom.Parameters())
        walls = [
            s.model_copy(update={"solar_absorptance": absorptance, "azimuth_deg": 180.0})
            if s.name == "south wall"
            else s
            for s in stated.surfaces
        ]
        shading = Shading(passes=passes, above_W_m2=0.0)
        room = SurfacesRoom.build(stated.model_copy(update={"surfaces": tuple(walls), "shading": shading}))
        return sun_W(room, sunny())

    assert np.allclose(of(0.2, 0.0), 0.2 * of(1.0, 0.0))
    on_wall = of(1.0, 0.6) - of(1.0, 0.0)
    assert on_wall.min() > 0.0
    assert np.allclose(of(0.2, 0.6) - of(0.2, 0.0), on_wall)


def test_without_it_the_room_is_what_it_was() -> None:
    room = NzebRoom.build(NzebRoom.Parameters())
    assert not any("shading" in each.name for each in room.inputs)
    shaded = NzebRoom.build(NzebRoom.Parameters(shading=Shading(passes=0.0, above_W_m2=500.0)))
    dim = sunny()
    assert np.allclose(sun_W(shaded, dim), sun_W(room, dim))  # not drawn: all the sun
    assert np.array_equal(shaded.conductance_W_K, room.conductance_W_K)


def test_energyplus_is_told_the_same_sun() -> None:
    inputs = pytest.importorskip("waxstudy_energyplus.inputs")
    description = NzebRoom.description(NzebRoom.Parameters(shading=Shading(passes=0.3, above_W_m2=0.0)))
    bare = description.model_copy(update={"shading": Shading()})
    with_it, without = (inputs.inputs(room, sunny()) for room in (description, bare))
    assert np.allclose(with_it["sun to air"], 0.3 * without["sun to air"])
    assert np.allclose(with_it["sun on floor"], 0.3 * without["sun on floor"])


@pytest.mark.parametrize(
    ("stated", "wrong"),
    [
        ({"from_hour": 12.0, "to_hour": 10.0}, "from_hour = 12 must lie before to_hour = 10"),
        ({"months": (0,)}, "months: at least one of 1 to 12"),
        ({"months": ()}, "months: at least one of 1 to 12"),
    ],
)
def test_what_cannot_be_is_refused(stated: dict[str, object], wrong: str) -> None:
    with pytest.raises(ValueError, match=wrong):
        Shading(**stated)


def test_a_room_for_studies_takes_it_as_a_table() -> None:
    room = installed().get("room", "nzeb").Parameters.model_validate_json('{"shading": {"passes": 0.2, "months": [5]}}')
    assert room.shading.months == (5,)
