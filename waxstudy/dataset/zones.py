"""Names of time zones, as people write them."""

from __future__ import annotations

import re
from zoneinfo import available_timezones

from waxstudy.plugin.registry import did_you_mean, hint, nearest

OFFSET = re.compile(r"(?:UTC|GMT)? ?([+-]\d{1,2})(?::?00)?")  # whole hours ahead of UTC


def fixed_zone(ahead_h: int) -> str:
    """Return the zone that is always so many hours ahead of UTC, whose name counts them the other way; "" if none is.

    >>> fixed_zone(2), fixed_zone(-5), fixed_zone(20)
    ('Etc/GMT-2', 'Etc/GMT+5', '')
    """
    zone = f"Etc/GMT{-ahead_h:+d}"
    return zone if zone in available_timezones() else ""


def zone_hint(word: str) -> str:
    """Return what a message on an unknown zone ends with: the zone of that offset or city, one that is near, or "".

    >>> zone_hint("berlin"), zone_hint("Europe/Talinn"), zone_hint("+01:00")
    ("; did you mean 'Europe/Berlin'?", "; did you mean 'Europe/Tallinn'?", "; did you mean 'Etc/GMT-1'?")
    """
    if found := OFFSET.fullmatch(word.strip().upper()):
        return did_you_mean(fixed_zone(int(found[1])))
    zones = sorted(available_timezones(), key=lambda zone: ("/" in zone, zone))
    by_city: dict[str, list[str]] = {}
    for zone in zones:
        by_city.setdefault(zone.rpartition("/")[2].lower(), []).append(zone)
    city = nearest(word.strip().rpartition("/")[2].replace(" ", "_").lower(), by_city)
    if not city:
        return hint(word, zones)
    same = by_city[city]  # a city may stand in several regions, or in none as well
    return did_you_mean(("/" in word and nearest(word, same)) or same[-1])
