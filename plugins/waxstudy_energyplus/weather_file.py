"""The weather file that EnergyPlus wants; what matters of the weather is written over it every minute."""

from __future__ import annotations

from calendar import monthrange

from waxstudy_energyplus.model import FIRST_YEAR

# dry bulb, dew point, humidity, pressure, four extraterrestrial and sky radiations, seven of sun and light, wind ...
HOUR = "0,-20,19,101325,0,0,315,0,0,0,0,0,0,0,0,0,0,0,9999,77777,9,999999999,0,0.1,0,88,0,0,0"
HEADER = """\
LOCATION,none,-,-,waxstudy,000000,59.4,24.8,2.0,0.0
DESIGN CONDITIONS,0
TYPICAL/EXTREME PERIODS,0
GROUND TEMPERATURES,0
HOLIDAYS/DAYLIGHT SAVINGS,No,0,0,0
COMMENTS 1,a year without weather: temperature and sun are given every minute by the run
COMMENTS 2,
DATA PERIODS,1,1,Data,Monday, 1/ 1,12/31
"""


def still_year() -> str:
    """Return a year of darkness at 0 C without wind; leap days do not occur."""
    days = ((month, day) for month in range(1, 13) for day in range(1, monthrange(FIRST_YEAR, month)[1] + 1))
    flags = "?9?9?9?9E0?9?9?9?9?9?9?9?9?9?9?9?9?9?9?9*9*9?9?9?9"
    rows = (f"{FIRST_YEAR},{m},{d},{hour},60,{flags},{HOUR}\n" for m, d in days for hour in range(1, 25))
    return HEADER + "".join(rows)
