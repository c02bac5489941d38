"""Write docs/effect-list.md again: `python -m tests.effects.regenerate_list`."""

from __future__ import annotations

from tests.conftest import ROOT
from tests.effects.believed import EFFECTS
from waxstudy.plugin import STAGES, Effect, Prior
from waxstudy_paper.room.uncertain import UNKNOWNS

PAGE = ROOT / "docs" / "effect-list.md"
INTRO = """\
# The effects of the library

This page lists what a diagnosis looks for. The last column is where each parameter is looked for and, in brackets,
the least departure worth naming; `x` marks factors, looked for on a log scale. It is written by `make golden` from
`plugins/waxstudy_effects`; [effects.md](effects.md) explains it.

| effect | stage | what it is | looked for (noticeable) |
|---|---|---|---|
"""
OF_ROOMS = """
## What nobody knows of a room

[effects.md](effects.md#what-nobody-knows-of-a-room) says why.

| uncertain | what the number is | spread |
|---|---|---|
"""


def page() -> str:
    """The page as it should be: every effect with its range, in the order of the loop."""
    order = sorted(EFFECTS.values(), key=lambda effect: (STAGES.index(effect.stage), effect.name))
    uncertain = [
        f"| `{each.name}` | {'log of the ' * each.is_log}{each.description} | {each.sd:g} |\n" for each in UNKNOWNS
    ]
    return INTRO + "".join(map(_row, order)) + OF_ROOMS + "".join(uncertain)


def _row(effect: type[Effect]) -> str:
    said = " ".join((effect.__doc__ or "").split("\n\n")[0].split())
    cells = [f"`{effect.name}`", effect.stage, said, "; ".join(_range(*one) for one in effect.priors.items())]
    return f"| {' | '.join(cells)} |\n"


def _range(name: str, prior: Prior) -> str:
    times = "x " if prior.is_log else ""
    return f"`{name}` {prior.low:g} to {prior.high:g} ({times}{prior.noticeable:g})"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8", newline="\n")
