"""Names of months in other languages than English."""

from __future__ import annotations

import re

import pandas as pd

# in German, French, Dutch, Spanish and Italian, shortened and in full
MONTHS = {
    **dict.fromkeys(("jän", "ene", "gen", "janv"), "Jan"), **dict.fromkeys(("févr", "fév", "fev"), "Feb"),
    **dict.fromkeys(("mär", "mrz", "mrt", "mars"), "Mar"), **dict.fromkeys(("avr", "abr"), "Apr"),
    **dict.fromkeys(("mai", "mei", "mag", "mayo", "maggio"), "May"), **dict.fromkeys(("juin", "giu"), "Jun"),
    **dict.fromkeys(("juil", "lug"), "Jul"), **dict.fromkeys(("août", "aout", "ago"), "Aug"),
    **dict.fromkeys(("sept", "set"), "Sep"), **dict.fromkeys(("okt", "ott"), "Oct"),
    **dict.fromkeys(("dez", "déc", "dic"), "Dec"),
    **dict.fromkeys(("januar", "jänner", "janvier", "januari", "enero", "gennaio"), "January"),
    **dict.fromkeys(("februar", "février", "februari", "febrero", "febbraio"), "February"),
    **dict.fromkeys(("märz", "maart", "marzo"), "March"), **dict.fromkeys(("avril", "abril", "aprile"), "April"),
    **dict.fromkeys(("juni", "junio", "giugno"), "June"),
    **dict.fromkeys(("juli", "juillet", "julio", "luglio"), "July"),
    **dict.fromkeys(("augustus", "agosto"), "August"),
    **dict.fromkeys(("septembre", "septiembre", "settembre"), "September"),
    **dict.fromkeys(("oktober", "octobre", "octubre", "ottobre"), "October"),
    **dict.fromkeys(("novembre", "noviembre"), "November"),
    **dict.fromkeys(("dezember", "décembre", "diciembre", "dicembre"), "December"),
}  # fmt: skip
WORD = re.compile(r"[^\W\d_]{3,}[.]?")


def in_english(written: pd.Series) -> pd.Series:
    """Return texts with the names of months in English, those in full and shortened ones.

    >>> list(in_english(pd.Series(["02-Mär-2026", "3 juillet 2026", "4 Jan 2026"])))
    ['02-Mar-2026', '3 July 2026', '4 Jan 2026']
    """
    english: pd.Series = written.str.replace(WORD, _month, regex=True)
    return english


def _month(word: re.Match[str]) -> str:
    return MONTHS.get(word[0].rstrip(".").lower(), word[0])
