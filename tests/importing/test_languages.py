"""Claims about names and words of other languages, and about names of which a part alone says something else."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from tests.cli.conftest import Entry
from tests.importing.conftest import read
from tests.importing.test_bad_input import house, imported
from tests.importing.test_mistaken import channels_of
from tests.importing.test_names import course
from waxstudy.importing.words import numbers_of

WHAT = {
    "room": "sensor_temperature_C",
    "dial": "setpoint_C",
    "supply": "supply_temperature_C",
    "return": "return_temperature_C",
    "outdoors": "outdoor_temperature_C",
}
NAMES = {
    "dutch": ("Kamertemperatuur", "Gewenste temperatuur", "Aanvoer", "Retour", "Buiten"),
    "french": ("Température ambiante", "Consigne", "Température départ", "Température retour", "Extérieur"),
    "spanish": ("Temperatura ambiente", "Consigna", "Temperatura impulsión", "Temperatura retorno", "Exterior"),
    "italian": ("Temperatura ambiente", "Temperatura impostata", "Mandata", "Ritorno", "Temperatura esterna"),
    "polish": ("Temperatura pokojowa", "Zadana", "Zasilanie", "Powrót", "Temperatura zewnętrzna"),
    "swedish": ("Rumstemperatur", "Börvärde", "Framledning", "Returledning", "Utetemperatur"),
    "danish": ("Rumtemperatur", "Ønsket temperatur", "Fremløb", "Returløb", "Udetemperatur"),
    "finnish": ("Huonelämpötila", "Asetusarvo", "Menovesi", "Paluuvesi", "Ulkolämpötila"),
}  # fmt: skip


@pytest.mark.parametrize("names", NAMES.values(), ids=NAMES)
def test_names_of_a_loop_are_known_in_the_languages_of_its_words(names: tuple[str, ...]) -> None:
    told = dict(zip(names, WHAT, strict=True))
    assert channels_of(*((name, "°C", course(what)) for name, what in told.items())) == {
        name: WHAT[what] for name, what in told.items()
    }


@pytest.mark.parametrize("names", NAMES.values(), ids=NAMES)
def test_no_other_temperature_becomes_the_room_s(names: tuple[str, ...]) -> None:
    """Where the room has a name that says nothing of what it is."""
    found = channels_of(
        ("Anna", "°C", course("room")), (names[1], "°C", course("dial")), (names[2], "°C", course("room"))
    )
    assert {found.get(names[1]), found.get(names[2], "")} == {"setpoint_C", "supply_temperature_C"}
    assert found.get("Anna", "?").startswith("?")


@pytest.mark.parametrize("name", ["Return setpoint", "Rücklauf-Soll", "Vorlauf Sollwert", "Consigne départ"])
def test_a_setpoint_of_water_is_neither_a_room_s_nor_a_temperature(name: str) -> None:
    assert name not in channels_of((name, "", 35.0 + course("dial") - 21.0), ("Room temperature", "", course("room")))


@pytest.mark.parametrize(
    ("on", "off"),
    [("Til", "Fra"), ("Aperta", "Chiusa"), ("Abierta", "Cerrada"), ("otwarty", "zamknięty"), ("włączona", "wyłączona"),
     ("Ouverte", "Fermée"), ("geöffnet", "geschlossen"), ("Allumé", "Éteint"), ("öppet", "stängt"), ("åbent", "lukket"),
     ("avatud", "suletud"), ("auki", "suljettu"), ("eingeschaltet", "ausgeschaltet"), ("открыт", "закрыт")],
)  # fmt: skip
def test_states_are_read_in_every_gender(on: str, off: str) -> None:
    assert numbers_of(pd.Series([on, off, off.upper()], dtype=object)).values.tolist() == [1.0, 0.0, 0.0]


@pytest.mark.parametrize(
    ("name", "is_turned"), [("Relay contact", True), ("Heizung Relais", True), ("Heating valve contact", False)]
)
def test_a_closed_contact_is_on_and_a_closed_valve_off(entry: Entry, name: str, is_turned: bool) -> None:
    frame = house()
    is_on = frame.pop("heating_valve") > 0.5
    done = imported(entry, frame.assign(**{name: np.where(is_on ^ is_turned, "Open", "Closed")}), "--yes")
    assert done.code == 0, done.stderr
    assert (f"{name} is taken as on where it is closed, as a contact is" in done.stderr) is is_turned
    assert read(Path("living"))["heating_signal"].to_list() == is_on.astype(float).to_list()
