"""The gallery: one picture for each capability, and the command that made it: `python -m docs_site.gallery FOLDER`.

FOLDER is where the commands of the gallery were run; the pages that they wrote hold the figures.
"""

from __future__ import annotations

import io
import re
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from PIL.Image import Image as Picture

IMAGES = Path(__file__).parent.parent / "docs" / "images"
PAGE = IMAGES.parent / "gallery.md"
WIDTH, COLOURS = 760, 48  # pixels; so few that a picture stays small
MAP, PART = "gap", "gallery-gap-part.png"  # of its rows the start page shows two, those of motor and valve


class Shown(NamedTuple):
    """A capability, the page that explains it, its commands, and a figure of a page that they write."""

    name: str
    title: str
    says: str
    explained: str
    commands: Sequence[str]
    page: str = ""  # without one the picture is drawn by what `explained` tells
    figure: str = ""

    @property
    def picture(self) -> str:
        return f"gallery-{self.name}.png" if self.page else self.figure


TABLE5 = "waxstudy run studies/table5.toml"
FLOW = (
    "waxstudy reality studies/table5.toml --case O_WM --effect max-flow --set factor=0.7 --without displacement \\\n"
    "  --out data/room-flow",
    "waxstudy diagnose data/room-flow --quick --out results/room-flow",
)
ENTRIES = (
    Shown(
        "comparison",
        "What each detail does",
        "Heat and temperature error of eleven control chains, and which differences are resolved.",
        "study-file.md",
        [TABLE5, "waxstudy report results/table5 --against paper --out table5.html"],
        "table5.html",
        "figure-overview",
    ),
    Shown(
        "order",
        "A step in every order",
        "How much of a step's effect is its place in the ladder.",
        "attribution.md",
        [TABLE5, "waxstudy report results/table5 --attribution --format html --out attribution.html"],
        "attribution.html",
    ),
    Shown(
        "gap",
        "Where a model and a record disagree",
        "The gap of each stage by regime, in multiples of its noise.",
        "diagnose.md",
        [
            "waxstudy reality studies/table5.toml --case O_WM --effect max-flow --set factor=0.7 --out data/first",
            "waxstudy diagnose data/first --quick --out results/first",
        ],
        "results/first/report.html",
        "figure-map",
    ),
    Shown(
        "switchings",
        "When a motor or valve moves",
        "All switchings of a record, aligned: measured, believed and found.",
        "diagnose.md",
        FLOW,
        "results/room-flow/report.html",
        "figure-switchings",
    ),
    Shown(
        "ranking",
        "What causes it",
        "Every effect that was tried, and why all but one are not named.",
        "diagnosis-tutorial-flow.md",
        FLOW,
        "results/room-flow/report.html",
        "figure-ranking",
    ),
    Shown(
        "motor",
        "A motor from its records",
        "Characteristic times of a wax motor, with intervals.",
        "fit.md",
        ["waxstudy rig data/bench", "waxstudy fit actuator data/bench --out data/motor.toml"],
        "data/motor.html",
        "figure-times",
    ),
    Shown(
        "valve",
        "A valve's curve",
        "Flow over opening, with the authority taken out.",
        "fit.md",
        [
            "waxstudy fit valve data/bench/B2m_15-15.csv --actuator data/motor-B.toml --pressure-drops 2.9 30"
            " --out data/valve.toml"
        ],
        "data/valve.html",
        "figure-curve",
    ),
    Shown(
        "standby",
        "Pulses that keep a valve warm",
        "Full activation after a pause, and the margin before the piston moves.",
        "enthalpy-standby.md",
        ["python -m waxstudy_enthalpy.standby --figure standby.svg"],
        figure="enthalpy-standby.svg",
    ),
    Shown(
        "blind",
        "How often a diagnosis is right",
        "Shares of the newest judged run beside their goals.",
        "blind_test_table.md",
        ["waxstudy blind-test score judged --key-file judged.key"],
        figure="blind-test.svg",
    ),
    Shown(
        "notebook",
        "From Python",
        "A ladder in ten lines of a notebook.",
        "python.md",
        ["jupyter lab docs/notebooks/ladder.ipynb"],
        figure="notebook-ladder.svg",
    ),
)


def page() -> str:
    """The gallery's page."""
    parts = [
        "# Gallery\n\nThis page shows what waxstudy can do: one picture each, the command that made it, and the page "
        "that explains it.\n"
    ]
    for each in ENTRIES:
        commands = "\n".join(each.commands)
        parts.append(
            f"## {each.title}\n\n{each.says} [How]({each.explained}).\n\n"
            f"[![{each.title}](images/{each.picture})]({each.explained})\n\n```console\n{commands}\n```\n"
        )
    return "\n".join(parts)


def figure_of(text: str, id: str) -> str:
    """Return a page's figure, the first without an id, as a page of its own."""
    found = re.search(
        rf'<svg id="{re.escape(id)}-whole".*?</svg>' if id else r'<svg id="[^"]*-whole".*?</svg>', text, re.S
    )
    if not found:
        raise SystemExit(f"the page has no figure {id or 'at all'}")
    svg = re.sub(r'(<svg [^>]*?)width="[^"]*" height="[^"]*"', rf'\1width="{WIDTH}"', found[0], count=1)
    return f"<!DOCTYPE html><body style='margin:0;background:#fff'>{svg}</body>"


def draw(entry: Shown, folder: Path) -> None:
    """Write the picture of an entry from the page that its commands wrote."""
    from PIL import Image, ImageChops

    browser = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if browser is None:
        raise SystemExit("needs chromium or google-chrome")
    with TemporaryDirectory() as place:
        source, shot = Path(place, "figure.html"), Path(place, "shot.png")
        source.write_text(figure_of((folder / entry.page).read_text(encoding="utf-8"), entry.figure), encoding="utf-8")
        options = ["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", f"--screenshot={shot}"]
        subprocess.run(
            [browser, *options, f"--window-size={WIDTH},1200", source.as_uri()], check=True, capture_output=True
        )
        image = Image.open(io.BytesIO(shot.read_bytes())).convert("RGB")
    blank = Image.new("RGB", image.size, "white")
    box = ImageChops.difference(image, blank).getbbox() or (0, 0, *image.size)
    cut = image.crop((0, 0, WIDTH, min(image.height, box[3] + 8))).quantize(COLOURS)
    cut.save(IMAGES / entry.picture, optimize=True)
    if entry.name == MAP:
        part(cut.convert("RGB")).quantize(COLOURS).save(IMAGES / PART, optimize=True)


def part(image: Picture) -> Picture:
    """Return the rows of motor and valve of a gap map, and its legend: the fourth and fifth row, and the last two."""
    from PIL import Image

    is_drawn = np.asarray(image.convert("L")).min(axis=1) < 250
    starts = [int(y) for y in np.flatnonzero(is_drawn[1:] & ~is_drawn[:-1]) + 1]
    rows, legend = (starts[3] - 4, starts[5] - 4), (starts[-2] - 10, image.height)
    both = Image.new("RGB", (image.width, rows[1] - rows[0] + legend[1] - legend[0]), "white")
    both.paste(image.crop((0, rows[0], image.width, rows[1])), (0, 0))
    both.paste(image.crop((0, legend[0], image.width, legend[1])), (0, rows[1] - rows[0]))
    return both


if __name__ == "__main__":
    if len(sys.argv) > 1:
        for one in ENTRIES:
            if one.page:
                draw(one, Path(sys.argv[1]))
    PAGE.write_text(page(), encoding="utf-8", newline="\n")
