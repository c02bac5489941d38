"""Time zones: their names, as people write them, and their standard time."""

from __future__ import annotations

import re
from datetime import datetime, timedelta, timezone, tzinfo
from zoneinfo import ZoneInfo, available_timezones

from waxstudy.plugin.registry import did_you_mean, hint, nearest

OFFSET = re.compile(r"(?:UTC|GMT)? ?([+-]\d{1,2})(?::?00)?")  # whole hours ahead of UTC
FIXED = re.compile(r"UTC([+-])(0\d|1[0-4]):([0-5]\d)")  # as `datetime.timezone` names itself
MONTH, SEASON = timedelta(days=30), 3  # so many months are one


def is_zone(name: str) -> bool:
    """Whether it names a zone, or an offset as `UTC+02:00`."""
    return name in available_timezones() or FIXED.fullmatch(name) is not None


def zone_of(name: str) -> tzinfo:
    """Return a zone by its name, or by its offset as `UTC+02:00`."""
    if found := FIXED.fullmatch(name):
        ahead = timedelta(hours=int(found[2]), minutes=int(found[3]))
        return timezone(ahead if found[1] == "+" else -ahead)
    return ZoneInfo(name)


def fixed_name(ahead: timedelta) -> str:
    """Return the name of what is always so far ahead of UTC, as `UTC+02:00`; `zone_of` reads it.

    >>> fixed_name(timedelta(hours=-3, minutes=-30)), fixed_name(timedelta())
    ('UTC-03:30', 'UTC+00:00')
    """
    minutes = round(ahead / timedelta(minutes=1))
    return f"UTC{'-' if minutes < 0 else '+'}{abs(minutes) // 60:02d}:{abs(minutes) % 60:02d}"


def standard_ahead(zone: tzinfo, at: datetime) -> timedelta:
    """Return how far a zone's standard time is ahead of UTC around an instant, or what the wall shows.

    Where a zone is said to have summer time in winter, of minus one hour (Dublin), winter has the standard time; a
    month of that (Ramadan in Casablanca) is none.

    >>> standard_ahead(ZoneInfo("Europe/Istanbul"), datetime(2015, 7, 1)) / timedelta(hours=1)
    2.0
    >>> standard_ahead(ZoneInfo("Europe/Dublin"), datetime(2024, 7, 1)) / timedelta(hours=1)
    0.0
    >>> standard_ahead(ZoneInfo("Africa/Casablanca"), datetime(2024, 7, 1)) / timedelta(hours=1)
    1.0
    """
    there = at.replace(tzinfo=zone) if at.tzinfo is None else at.astimezone(zone)
    year = [there + months * MONTH for months in range(-6, 7)]
    if sum((each.dst() or timedelta()) < timedelta() for each in year) >= SEASON:
        return min(each.utcoffset() or timedelta() for each in year)
    return (there.utcoffset() or timedelta()) - (there.dst() or timedelta())


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
