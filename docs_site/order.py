"""The order of the site's pages."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

FURTHER = "Further pages"


def with_further_pages(nav: Sequence[Any], pages: Iterable[str]) -> list[Any]:
    """Return a navigation with the pages that it does not name under a heading of their own, so that none is lost.

    >>> with_further_pages([{"Start": "index.md"}], ["tuning.md", "index.md"])
    [{'Start': 'index.md'}, {'Further pages': ['tuning.md']}]
    """
    named = set(_paths(nav))
    further = sorted(set(pages) - named)
    return [*nav, *([{FURTHER: further}] if further else [])]


def _paths(nav: Any) -> Iterator[str]:
    if isinstance(nav, str):
        yield nav
    else:
        for inner in nav.values() if isinstance(nav, dict) else nav:
            yield from _paths(inner)
