"""Names of time zones, as people write them."""

from __future__ import annotations

from zoneinfo import available_timezones

from waxstudy.plugin.registry import did_you_mean, hint, nearest


def zone_hint(word: str) -> str:
    """Return what a message on an unknown zone ends with: the zone of that city, one that is near, or "".

    >>> zone_hint("berlin"), zone_hint("Europe/Talinn")
    ("; did you mean 'Europe/Berlin'?", "; did you mean 'Europe/Tallinn'?")
    """
    zones = sorted(available_timezones(), key=lambda zone: ("/" in zone, zone))
    by_city: dict[str, list[str]] = {}
    for zone in zones:
        by_city.setdefault(zone.rpartition("/")[2].lower(), []).append(zone)
    city = nearest(word.strip().rpartition("/")[2].replace(" ", "_").lower(), by_city)
    if not city:
        return hint(word, zones)
    same = by_city[city]  # a city may stand in several regions, or in none as well
    return did_you_mean(("/" in word and nearest(word, same)) or same[-1])
