"""Values as they are written: numbers with a decimal comma or a unit, states in words, and none at all."""

from __future__ import annotations

import re
from typing import NamedTuple

import numpy as np
import pandas as pd

from waxstudy.dataset.columns import WORDS as STATES
from waxstudy.dataset.limits import CODES, LARGEST, UNREADABLE_SHARE
from waxstudy.importing.limits import NEAR_THOUSAND

# besides English: German, French, Dutch, Swedish, Danish, Finnish, Estonian, Italian, Spanish, Polish, Russian
ON = (
    "heat", "heating", "yes", "active", "running", "ein", "eingeschaltet", "an", "heizen", "ja", "wahr", "marche",
    "allumé", "allumée", "vrai", "aan", "på", "til", "tændt", "päällä", "sees", "acceso", "accesa", "encendido",
    "encendida", "włączony", "włączona", "włączone", "вкл", "включен", "включена", "включено",
)  # fmt: skip
OFF = (
    "idle", "no", "inactive", "standby", "aus", "ausgeschaltet", "nein", "cool", "falsch", "arrêt", "arret", "éteint",
    "éteinte", "faux", "uit", "av", "af", "fra", "slukket", "pois", "väljas", "spento", "spenta", "apagado", "apagada",
    "wyłączony", "wyłączona", "wyłączone", "выкл", "выключен", "выключена", "выключено",
)  # fmt: skip
OPEN = (
    "open", "auf", "offen", "geöffnet", "ouvert", "ouverte", "öppen", "öppet", "åben", "åbent", "åpen", "auki",
    "lahti", "avatud", "aperto", "aperta", "abierto", "abierta", "otwarty", "otwarta", "otwarte", "открыт", "открыта",
    "открыто",
)  # fmt: skip
SHUT = (
    "closed", "close", "zu", "geschlossen", "fermé", "fermée", "ferme", "fermee", "dicht", "gesloten", "stängd",
    "stängt", "lukket", "kiinni", "suljettu", "kinni", "suletud", "chiuso", "chiusa", "cerrado", "cerrada", "zamknięty",
    "zamknięta", "zamknięte", "закрыт", "закрыта", "закрыто",
)  # fmt: skip
WORDS = {**STATES, **dict.fromkeys((*ON, *OPEN), 1.0), **dict.fromkeys((*OFF, *SHUT), 0.0)}
# from here on nothing is known: what was read before is not held
NOTHING = ("unavailable", "unknown", "none", "nan", "null", "n/a", "na", "error", "fault", "offline", "-", "--", "")
SIGN = "[-+\u2212\u2013]?"  # also as typesetters write a minus
RAW = re.compile(r"\$?(?:[0-9A-F]{2} ?)+\s*\|\s*")  # of a telegram, as monitors of a bus write it before its value
MINUS = re.compile(r"^[\u2212\u2013]\s*(?=\d)")
# what goes on as a date, a time of day or a range has no unit
NUMBER = re.compile(
    r"(?P<number>[-+]?\d+(?:[.,]\d+)?(?:[eE][-+]?\d+)?)\s*(?P<unit>(?![:/-]\s*\d|-[A-Za-z])[^\d\s.,].*)?"
)
# of thousands: a second group, or another mark behind, tells that this is none of decimals; of these it is known
GROUPED = re.compile(
    r"[-+]?\d{1,3}(?P<mark>[,. ])(?:\d{3}(?P=mark))*\d{3}(?P<decimals>(?!(?P=mark))[.,]\d+)?(?![\d.,]).*"
)
# without decimals a mark is one of thousands where all cells with it are such, and others are whole and near a thousand
THOUSANDS = re.compile(r"-?[1-9]\d{0,2}(?:,\d{3})+")
NEVER_DECIMAL = re.compile(r"(?<=\d)['\u2019\u00a0\u202f](?=\d{3}(?!\d))")


class Numbers(NamedTuple):
    """Values of one entity; NaN where nothing is known."""

    values: np.ndarray  # (n,)
    units: tuple[str, ...]  # that stand behind numbers
    words: tuple[str, ...]  # that were read as 0 and 1
    said: np.ndarray  # (n,), what words say among other numbers, which `values` lack there; NaN where none does
    bad: tuple[object, str] | None  # row and text of the first cell that is no value
    bad_count: int

    @property
    def unit(self) -> str:
        """The unit of all numbers, "" where none is written or no single one."""
        return self.units[0] if len(self.units) == 1 else ""

    @property
    def is_words(self) -> bool:
        """Whether words say all that is known, but for numbers that are states as well."""
        return bool(self.words) and not np.isfinite(self.said).any()

    @property
    def is_passage(self) -> bool:
        """Whether all that is told is open and shut, of which a valve lets through the one, and a contact the other."""
        return self.is_words and {*self.words} <= {*OPEN, *SHUT}

    @property
    def is_readable(self) -> bool:
        known = int((np.isfinite(self.values) | np.isfinite(self.said)).sum())
        return known > 0 and self.bad_count <= UNREADABLE_SHARE * (known + self.bad_count)


def is_told_in_words(cell: str) -> bool:
    return cell.strip().lower() in WORDS or cell.strip().lower() in NOTHING


def is_reading(cell: str) -> bool:
    """Whether a cell is a number, with a unit or without, or a state, or says that nothing was read."""
    return is_told_in_words(cell) or NUMBER.fullmatch(cell.strip()) is not None


def numbers_of(written: pd.Series) -> Numbers:
    """Return values as numbers: states as 0 and 1, and what is written behind numbers as their units."""
    if pd.api.types.is_bool_dtype(written):
        written = written.map({True: "on", False: "off"})
    values = np.array(pd.to_numeric(written, errors="coerce").to_numpy(dtype=float, na_value=np.nan))
    left = np.flatnonzero(np.isnan(values) & written.notna().to_numpy())
    units: set[str] = set()
    words: set[str] = set()
    bad, count = None, 0
    said = np.full(len(values), np.nan)
    if len(left):
        texts = written.iloc[left].astype(str).str.strip()
        marks = _marks(texts, values[np.isfinite(values)])
        if "." in marks:  # what looks like a number may be grouped too
            left = np.flatnonzero(written.notna().to_numpy())
            texts = written.iloc[left].astype(str).str.strip()
        for text, group in texts.groupby(texts):
            value, unit, word = _read(str(text), marks)
            places = left[texts.index.get_indexer_for(group.index)] if texts.index.is_unique else left[texts == text]
            values[places] = value
            said[places] = value if word else np.nan
            units |= {unit} - {""}
            words |= {word} - {""}
            if np.isnan(value) and str(text).lower() not in NOTHING:
                count += len(group)
                bad = bad or (group.index[0], str(text))
    values[~(np.abs(values) <= LARGEST) | np.isin(values, CODES)] = np.nan
    is_number = np.isfinite(values) & np.isnan(said)
    if words and np.isin(values[is_number], (0.0, 1.0)).all():
        said[:] = np.nan
    values[np.isfinite(said)] = np.nan
    return Numbers(values, tuple(sorted(units)), tuple(sorted(words)), said, bad, count)


def _bare(unit: str) -> str:
    """Return a unit without brackets around it.

    >>> _bare("(Celsius)"), _bare("W/(m2)")
    ('Celsius', 'W/(m2)')
    """
    return unit.strip(" ()[]") if unit[:1] in ("(", "[") else unit


def _read(text: str, marks: frozenset[str]) -> tuple[float, str, str]:
    text = RAW.sub("", text, count=1) if "|" in text else text
    lower = text.lower()
    if lower in WORDS:
        return WORDS[lower], "", lower
    text = _ungrouped(MINUS.sub("-", text), marks)
    if lower not in NOTHING and (found := NUMBER.fullmatch(text)):
        return float(found["number"].replace(",", ".")), _bare((found["unit"] or "").strip()), ""
    return float("nan"), "", ""


def _marks(texts: pd.Series, others: np.ndarray) -> frozenset[str]:
    """Return the marks that some cells of a column have between thousands; `others` are numbers that have no mark."""
    found = (GROUPED.fullmatch(str(text)) for text in texts.unique())
    marks = {each["mark"] for each in found if each and (each["decimals"] or each[0].count(each["mark"]) > 1)}
    with_comma = [str(text) for text in texts.unique() if "," in str(text)]
    reaches = len(others) and float(np.abs(others).max()) >= NEAR_THOUSAND and bool((others == np.round(others)).all())
    if reaches and with_comma and all(THOUSANDS.fullmatch(text) for text in with_comma):
        marks.add(",")
    return frozenset(marks)


def _ungrouped(text: str, marks: frozenset[str]) -> str:
    """Return a number without marks between thousands: those of its column, and those that are never of decimals."""
    text = NEVER_DECIMAL.sub("", text)
    found = GROUPED.fullmatch(text)
    return text.replace(found["mark"], "") if found and found["mark"] in marks else text
