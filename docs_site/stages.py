"""The stages of the conformance kit, as `waxstudy plugins check` runs them."""

from __future__ import annotations

from docs_site.tables import plain, table
from waxstudy.conformance.kit import BY_KIND, COMMON
from waxstudy.conformance.outside import OUTSIDE_STAGES
from waxstudy.plugin import CHAIN, KINDS

INTRO = (
    "What `waxstudy plugins check` holds a component against, in this order. "
    "[Plugins](../plugins-kit.md#the-conformance-kit) says how an exemption is declared.\n\n"
)


def stages() -> str:
    """Return the page of the stages of every kind."""
    of = {"all": COMMON, "block": BY_KIND[CHAIN[0]], **{kind: BY_KIND[kind] for kind in KINDS[len(CHAIN) :]}}
    of["outside room"] = OUTSIDE_STAGES
    rows = [
        (kind, stage.name, plain(stage.claim), "yes" if stage.exemptible else "")
        for kind, each in of.items()
        for stage in each
    ]
    return "# Stages of the conformance kit\n\n" + INTRO + table(("kind", "stage", "what it checks", "exempt?"), rows)
