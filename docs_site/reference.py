"""The generated pages of the reference, by their path in the site."""

from __future__ import annotations

from collections.abc import Callable, Mapping

PAGES: Mapping[str, Callable[[], str]] = {}
