"""`waxstudy fit actuator`"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from waxstudy.cli.errors import USAGE, CommandError
from waxstudy.cli.existing import Existing, Written
from waxstudy.cli.fit.common import (
    beside,
    column_option,
    failures,
    printed,
    refuse_targets,
    refuse_unwritable,
    write,
)
from waxstudy.cli.output import Command, print_out

if TYPE_CHECKING:
    from waxstudy.identification.description import Described
    from waxstudy.identification.result import ActuatorFit

PRODUCT = "Product of records of which none is told, and the one that is written  [default: each gets a file]"
OUT = "TOML file that a study can take its actuator from; a page and all figures as JSON go beside it."
UNNAMED = "unnamed"
UNSAFE = r"[^\w.-]+"  # in the name of a file


@click.command("actuator", cls=Command)
@click.argument("records", nargs=-1, required=True, type=Existing())
@click.option("--product", metavar="NAME", help=PRODUCT)
@column_option
@click.option("--out", required=True, type=Written(), metavar="FILE.toml", help=OUT)
@click.option("--seed", type=click.IntRange(min=0), default=1, show_default=True, help="Seed of resampling.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON instead of the summary.")
def command(
    records: Sequence[Path], product: str | None, columns: dict[str, str], out: Path, seed: int, as_json: bool
) -> None:
    """Find the characteristic times in displacement records, and how they depend on what was before.

    RECORDS are CSV or parquet files, or folders of them; records.toml beside them says what each is of. A study takes
    the result as actuator = { from = "FILE.toml" }. A page, which is named before them, and figures as JSON lie beside.
    Without --json, the last lines printed are the files.
    """
    refuse_unwritable(out)
    with failures():
        known = _known(records, columns)
        planned = _files(sorted({each.product or product or UNNAMED for each in known}), product, out)
        refuse_targets((*planned.values(), out, *beside(out)), _read(records, known))
        found = _fit(known, product, seed)
    written = _files(found.model.products, product, out)
    write(_texts(found, written, out))
    files = "".join(f"{path}\n" for path in written.values())
    print_out(_json(found) if as_json else f"{_summary(found)}{out.with_suffix('.html')}\n{files}")


def _known(paths: Sequence[Path], columns: dict[str, str]) -> list[Described]:
    from waxstudy.identification.description import described

    known = [replace(each, columns={**each.columns, **columns}) for each in described(paths)]
    if not known:
        raise CommandError("there is no displacement record in these folders", USAGE)
    return known


def _read(paths: Sequence[Path], known: Sequence[Described]) -> list[Path]:
    """Return all files that are read, or would be read the next time."""
    from waxstudy.identification.description import DESCRIPTION

    folders = {each.path.parent for each in known} | {path for path in paths if path.is_dir()}
    return [*(each.path for each in known), *paths, *(folder / DESCRIPTION for folder in folders)]


def _fit(known: Sequence[Described], product: str | None, seed: int) -> ActuatorFit:
    from waxstudy.identification.records import read_records
    from waxstudy.identification.result import fit

    return fit(read_records(known, product or UNNAMED), seed)


def _files(products: Sequence[str], product: str | None, out: Path) -> dict[str, Path]:
    """Return the file of each product that is written; names that come to the same get a number."""
    if product is not None and product not in products:
        raise CommandError(f"--product {product}: the records are of {', '.join(products)}", USAGE)
    if product is not None or len(products) == 1:
        return {product or products[0]: out}
    files: dict[str, Path] = {}
    taken = {out.name.lower()}
    for each in products:
        stem = f"{out.stem}-{re.sub(UNSAFE, '-', each)}"
        names = (f"{stem}{number}{out.suffix}" for number in ("", *(f"-{n}" for n in range(2, len(products) + 2))))
        name = next(name for name in names if name.lower() not in taken)
        taken.add(name.lower())
        files[each] = out.with_name(name)
    return files


def _texts(found: ActuatorFit, files: dict[str, Path], out: Path) -> dict[Path, str]:
    from waxstudy.report.identification.page import actuator_page

    texts = {path: found.fragment(product) for product, path in files.items()}
    page, figures = beside(out)
    return texts | {page: actuator_page(found), figures: _json(found)}


def _json(found: ActuatorFit) -> str:
    from waxstudy.results.json_text import json_text

    return json_text(found.described())


def _summary(found: ActuatorFit) -> str:
    from waxstudy.report.identification.tables import actuator_tables, notes

    return printed(actuator_tables(found), notes(found))
