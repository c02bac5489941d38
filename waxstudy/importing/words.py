"""Values as they are written: numbers with a decimal comma or a unit, states in words, and none at all."""

from __future__ import annotations

import re
from typing import NamedTuple

import numpy as np
import pandas as pd

from waxstudy.dataset.columns import CODES, LARGEST, UNREADABLE_SHARE
from waxstudy.dataset.columns import WORDS as STATES

WORDS = {
    **STATES,
    **dict.fromkeys(("heat", "heating", "yes", "active", "running", "ein", "an", "auf", "offen", "heizen", "ja"), 1.0),
    # French, Dutch, Swedish and Danish, Finnish, Estonian, Italian, Spanish, Polish, Russian; and Excel's in German
    **dict.fromkeys(
        ("ouvert", "ouverte", "marche", "vrai", "aan", "på", "tændt", "päällä", "auki", "sees", "lahti"), 1.0
    ),
    **dict.fromkeys(("lahti", "acceso", "aperto", "encendido", "abierto", "włączone", "otwarte", "вкл", "wahr"), 1.0),
    **dict.fromkeys(("fermé", "fermée", "ferme", "arrêt", "faux", "uit", "dicht", "av", "af", "pois"), 0.0),
    **dict.fromkeys(("gesloten", "stängd", "lukket", "slukket", "kiinni", "arret", "fermee"), 0.0),
    **dict.fromkeys(("öppen", "åben"), 1.0),
    **dict.fromkeys(("väljas", "kinni", "spento", "chiuso", "apagado", "cerrado", "wyłączone", "zamknięte"), 0.0),
    **dict.fromkeys(("выкл", "falsch"), 0.0),
    **dict.fromkeys(("idle", "no", "inactive", "standby", "aus", "zu", "geschlossen", "nein", "cool", "close"), 0.0),
}
# from here on nothing is known: what was read before is not held
NOTHING = ("unavailable", "unknown", "none", "nan", "null", "n/a", "na", "error", "fault", "offline", "-", "--", "")
NUMBER = re.compile(r"(?P<number>[-+]?\d+(?:[.,]\d+)?(?:[eE][-+]?\d+)?)\s*(?P<unit>[^\d\s.,].*)?")
# of thousands: a second group, or another mark behind, tells that this is none of decimals; of these it is known
GROUPED = re.compile(
    r"[-+]?\d{1,3}(?P<mark>[,. ])(?:\d{3}(?P=mark))*\d{3}(?P<decimals>(?!(?P=mark))[.,]\d+)?(?![\d.,]).*"
)
NEVER_DECIMAL = re.compile(r"(?<=\d)['\u2019\u00a0\u202f](?=\d{3}(?!\d))")


class Numbers(NamedTuple):
    """Values of one entity; NaN where nothing is known."""

    values: np.ndarray  # (n,)
    unit: str  # that stands behind each number, "" where none does
    words: tuple[str, ...]  # that were read as 0 and 1
    bad: tuple[object, str] | None  # row and text of the first cell that is no value
    bad_count: int

    @property
    def is_readable(self) -> bool:
        known = int(np.isfinite(self.values).sum())
        return known > 0 and self.bad_count <= UNREADABLE_SHARE * (known + self.bad_count)


def is_told_in_words(cell: str) -> bool:
    return cell.strip().lower() in WORDS or cell.strip().lower() in NOTHING


def numbers_of(written: pd.Series) -> Numbers:
    """Return values as numbers: states as 0 and 1, and what is written behind all numbers as their unit."""
    if pd.api.types.is_bool_dtype(written):
        written = written.map({True: "on", False: "off"})
    values = np.array(pd.to_numeric(written, errors="coerce").to_numpy(dtype=float, na_value=np.nan))
    values[_may_be_grouped(written)] = np.nan
    left = np.flatnonzero(np.isnan(values) & written.notna().to_numpy())
    units: set[str] = set()
    words: set[str] = set()
    bad, count = None, 0
    if len(left):
        texts = written.iloc[left].astype(str).str.strip()
        marks = _marks(texts)
        for text, group in texts.groupby(texts):
            value, unit, word = _read(str(text), marks)
            places = left[texts.index.get_indexer_for(group.index)] if texts.index.is_unique else left[texts == text]
            values[places] = value
            units |= {unit} - {""}
            words |= {word} - {""}
            if np.isnan(value) and str(text).lower() not in NOTHING:
                count += len(group)
                bad = bad or (group.index[0], str(text))
    values[~(np.abs(values) <= LARGEST) | np.isin(values, CODES)] = np.nan
    return Numbers(values, units.pop() if len(units) == 1 else "", tuple(sorted(words)), bad, count)


def _read(text: str, marks: frozenset[str]) -> tuple[float, str, str]:
    lower = text.lower()
    if lower in WORDS:
        return WORDS[lower], "", lower
    text = _ungrouped(text, marks)
    if lower not in NOTHING and (found := NUMBER.fullmatch(text)):
        return float(found["number"].replace(",", ".")), (found["unit"] or "").strip(), ""
    return float("nan"), "", ""


def _marks(texts: pd.Series) -> frozenset[str]:
    """Return the marks that some cells of a column have between thousands, for certain."""
    found = (GROUPED.fullmatch(str(text)) for text in texts.unique())
    return frozenset(each["mark"] for each in found if each and (each["decimals"] or each[0].count(each["mark"]) > 1))


def _ungrouped(text: str, marks: frozenset[str]) -> str:
    """Return a number without marks between thousands: those of its column, and those that are never of decimals."""
    text = NEVER_DECIMAL.sub("", text)
    found = GROUPED.fullmatch(text)
    return text.replace(found["mark"], "") if found and found["mark"] in marks else text


def _may_be_grouped(written: pd.Series) -> np.ndarray:
    """Return cells (n,) that a point may part into thousands, where others of the column tell that it does."""
    if pd.api.types.is_numeric_dtype(written):
        return np.zeros(len(written), dtype=bool)
    texts = written.astype(str).str.strip()
    pointed = texts.str.fullmatch(r"[-+]?\d{1,3}(?:\.\d{3})+", na=False).to_numpy(dtype=bool)
    return pointed if pointed.any() and "." in _marks(texts[texts.str.contains(",", na=False)]) else pointed & False
