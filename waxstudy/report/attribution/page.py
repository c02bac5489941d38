"""The attribution as one self-contained HTML page."""

from __future__ import annotations

from waxstudy.report.attribution.figure import figure_shares
from waxstudy.report.attribution.notes import notes
from waxstudy.report.attribution.render import tables
from waxstudy.report.attribution.shares import PERCENT, Attribution, OrderFree
from waxstudy.report.html import filled, provenance
from waxstudy.report.words import counted


def as_html(found: OrderFree) -> str:
    """Return the attribution as one page."""
    return filled(
        "attribution.html.j2",
        found=found,
        summary=summary(found),
        findings=[_of_heat(of) for of in found.attributions],
        figure=figure_shares.plot(found),
        tables=tables(found),
        notes=notes(found),
        provenance=provenance(found.run),
    )


def summary(found: OrderFree) -> str:
    """What was averaged, over what."""
    counts = [
        f"{s.ladder.name}: {counted(len(s.steps), 'step')}, {counted(len(s.case), 'set')} of them"
        for s in found.ladders
    ]
    return (
        "What each step of a ladder adds, averaged over all orders in which the steps may be taken, beside the "
        f"ladder's one order ({'; '.join(counts)}; {counted(found.members, 'member')} per case)."
    )


def _of_heat(of: Attribution) -> str:
    """A ladder and week in one sentence."""
    heat = of.differences[PERCENT]
    resolved = sum(bool(share.order_free.resolved) for share in heat.shares)
    moved = sum(bool(share.of_its_place.resolved) for share in heat.shares)
    return (
        f"Ladder {of.name}: all steps together change the heat by {heat.total.mean:+.1f} %; "
        f"resolved are {resolved} of {len(heat.shares)} shares and {moved} of {len(heat.shares)} differences from the "
        "ladder's order."
    )
