"""What EnergyPlus is told each minute: the record's weather and the room's use, as the fast room has them."""

from __future__ import annotations

import numpy as np

from waxstudy.plugin import FloatArray, WeatherRecord
from waxstudy_energyplus import objects
from waxstudy_energyplus.described import EXCHANGE_C, OUTDOOR
from waxstudy_energyplus.model import exchange_W_K
from waxstudy_paper.room.assembly import AIR_J_L_K, drive, inputs_of, sun_shares
from waxstudy_paper.room.description import RoomDescription, facade_name


def inputs(room: RoomDescription, weather: WeatherRecord) -> dict[str, FloatArray]:
    """Return one value per weather interval of each input: schedules by their names in the model, temperatures, and
    the exchange of air in W/K.

    The sun through the windows goes to the surfaces as in the fast room: EnergyPlus' own sun would need the direct and
    diffuse parts, which a record does not hold, and would let through another amount.
    """
    slow, supply_C = drive(room, weather)
    columns = dict(zip(inputs_of(room), slow.T, strict=True))
    outdoor_C, air = columns["outdoor_C"], room.air
    supplied_W_K = air.ventilation_L_s * AIR_J_L_K
    warmer_K = supplied_W_K / max(exchange_W_K(room), 1e-9) * (air.ventilation_supply_C - outdoor_C)
    return {
        OUTDOOR: outdoor_C,
        EXCHANGE_C: outdoor_C + warmer_K,
        objects.EXCHANGE: np.full(len(outdoor_C), exchange_W_K(room)),
        objects.SUPPLY: supply_C,
        objects.GAINS: columns["gains_W"],
        **_sun(room, weather),
    }


def _sun(room: RoomDescription, weather: WeatherRecord) -> dict[str, FloatArray]:
    through_W, panes_W = np.zeros((2, len(weather.outdoor_C)))
    for window in room.windows:
        gain_W = window.area_m2 * window.g * room.shading.passed(weather, facade_name(window.facade))
        through_W += gain_W * (1 - window.secondary_share) * (1 - room.sun.reflected_share)
        panes_W += gain_W * window.secondary_share
    on_surfaces_W = through_W * (1 - room.sun.air_share)
    shares = sun_shares(room)
    outside = {
        objects.sun_outside(s.name): s.solar_absorptance * weather.irradiance_W_m2[facade_name(s.facade)]
        for s in room.surfaces
        if s.facade is not None
    }
    inside = {objects.sun_on(s.name): on_surfaces_W * shares[s.name] / s.area_m2 for s in room.surfaces}
    return {objects.SUN_TO_AIR: through_W * room.sun.air_share, objects.SUN_TO_PANES: panes_W, **inside, **outside}
