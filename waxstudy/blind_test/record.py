"""Writing a record so that nothing but its values tells anything, and reading it back with and without noise."""

from __future__ import annotations

import hashlib
import os
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import tomli_w

from waxstudy.blind_test.draw import Measured
from waxstudy.dataset.channels import CHANNELS, GLOBAL, Channel
from waxstudy.dataset.read import Dataset, read_dataset
from waxstudy.plugin import FloatArray
from waxstudy.plugin.files import DATA_BYTES, read_file
from waxstudy.plugin.trial import Staged
from waxstudy.results.atomic import scratch_folder, whole_folder
from waxstudy.synthetic.instruments import DECIMALS, rows

if TYPE_CHECKING:
    import pandas as pd

NAME, ORIGIN = "record", "a record of a blind test"  # the same for all
WIDTH = 11  # letters of a cell: a number's size would show in the file's
PAGE_BYTES = 32_768  # dataset.toml is filled up to a multiple
FILES = ("dataset.toml", "data.csv")
BASELINE = "baseline"  # folder of the healthy record of the same loop, within the record's
LONG_AGO_S = 946_684_800  # 2000-01-01, the time of every file


Seen = tuple[Staged, Measured]  # what happened, and how it is measured


def write_record(folder: Path, staged: Staged, measured: Measured, baseline: Seen | None = None) -> None:
    """Write a record's folder whole, with that of its baseline; raise `RealityError` or `OSError`."""
    with whole_folder(folder) as place:
        _write(place, staged, measured, {"baseline": {"path": BASELINE}} if baseline else {})
        if baseline:
            (place / BASELINE).mkdir()
            _write(place / BASELINE, *baseline, {})
    set_times(folder)


def _write(folder: Path, staged: Staged, measured: Measured, tables: Mapping[str, Any]) -> None:
    table = shown(staged, measured)
    (folder / "data.csv").write_text(text_of(table), encoding="utf-8")
    (folder / "dataset.toml").write_bytes(_padded({**_described(table, staged, measured), **tables}))


def shown(staged: Staged, measured: Measured, noise: bool = True) -> pd.DataFrame:
    """Return what the instruments show of what happened."""
    return rows(
        staged.channels, staged.step_s, staged.first_day, measured.instruments(noise and not staged.is_measured)
    )


def _described(table: pd.DataFrame, staged: Staged, measured: Measured) -> dict[str, Any]:
    instruments = measured.instruments()
    names = [str(name) for name in table.columns[1:]]
    noise = {} if staged.is_measured else {name: instruments.noise_of(CHANNELS[name]) for name in names}
    about = {
        "name": NAME,
        "interval_s": measured.interval_s,
        "origin": ORIGIN,
        "inputs": [name for name in staged.inputs if name in names],
    }
    tables = {name: each for name, each in staged.described.items() if name != "site" or GLOBAL in names}
    about |= tables.pop("dataset", {})
    return {"dataset": about, **tables, "noise": {name: sd for name, sd in noise.items() if sd > 0.0}}


def _padded(tables: Mapping[str, Any]) -> bytes:
    text = tomli_w.dumps(tables).encode()
    space = -(len(text) + 3) % PAGE_BYTES
    return text + b"# " + b"." * space + b"\n"


def text_of(table: pd.DataFrame) -> str:
    """Return a table as CSV whose cells are equally long."""
    columns = [table["time"].astype(str).tolist()]
    columns += [_cells(CHANNELS[str(name)], table[name].to_numpy(dtype=float)) for name in table.columns[1:]]
    header = ",".join(map(str, table.columns))
    return "\n".join([header, *map(",".join, zip(*columns, strict=True))]) + "\n"


def _cells(channel: Channel, values: FloatArray) -> list[str]:
    step = channel.resolution
    decimals = DECIMALS if not step else len(f"{step:.10f}".rstrip("0").split(".")[1])
    blank = " " * WIDTH
    return [f"{value:{WIDTH}.{decimals}f}" if value == value else blank for value in values.tolist()]


def without_noise(staged: Staged, measured: Measured) -> Dataset:
    """Return the record as perfect instruments would show it."""
    table = shown(staged, measured, noise=False)
    with scratch_folder("waxstudy-record-") as place:
        folder = place / NAME
        folder.mkdir()
        table.to_csv(folder / "data.csv", index=False, lineterminator="\n")
        (folder / "dataset.toml").write_bytes(tomli_w.dumps(_described(table, staged, measured)).encode())
        return read_dataset(folder)


def set_times(folder: Path) -> None:
    """Give all files of a folder, and itself, one time."""
    for path in (*folder.rglob("*"), folder):
        os.utime(path, (LONG_AGO_S, LONG_AGO_S))


def files_of(folder: Path) -> tuple[str, ...]:
    """Return the files of a record, those of its baseline behind its own."""
    has_baseline = (folder / BASELINE).is_dir()
    return (*FILES, *(f"{BASELINE}/{name}" for name in FILES)) if has_baseline else FILES


def copy_record(record: Path, folder: Path) -> None:
    """Copy a record into a folder that is there, file by file."""
    for name in files_of(record):
        (folder / name).parent.mkdir(exist_ok=True)
        _copy(record / name, folder / name)


def copy_without_baseline(record: Path, folder: Path) -> None:
    """Copy a record as if it had none."""
    _copy(record / "data.csv", folder / "data.csv")
    tables = tomllib.loads(read_file(record / "dataset.toml").decode())
    tables.pop("baseline", None)
    (folder / "dataset.toml").write_bytes(_padded(tables))


def _copy(path: Path, to: Path) -> None:
    to.write_bytes(read_file(path, DATA_BYTES))


def digest_of(folder: Path) -> str:
    """Return the hash of a record's files."""
    found = hashlib.sha256()
    for name in files_of(folder):
        found.update(read_file(folder / name, DATA_BYTES))
    return found.hexdigest()
