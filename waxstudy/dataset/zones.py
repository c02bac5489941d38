"""Names of time zones, as people write them."""

from __future__ import annotations

from zoneinfo import available_timezones

from waxstudy.plugin.registry import did_you_mean, hint, nearest


def zone_hint(word: str) -> str:
    """Return what a message on an unknown zone ends with: the zone of that city, one that is near, or "".

    >>> zone_hint("berlin"), zone_hint("Europe/Talinn")
    ("; did you mean 'Europe/Berlin'?", "; did you mean 'Europe/Tallinn'?")
    """
    zones = sorted(available_timezones(), key=lambda zone: "/" in zone)
    by_city = {zone.rpartition("/")[2].lower(): zone for zone in zones}
    city = nearest(word.strip().rpartition("/")[2].replace(" ", "_").lower(), by_city)
    return did_you_mean(by_city[city]) if city else hint(word, zones)
