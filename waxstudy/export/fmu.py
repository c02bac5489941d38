"""A model as an FMU: its description and, for each platform, a library of the model in the shell."""

from __future__ import annotations

import re
import zipfile
from collections.abc import Sequence
from importlib.resources import as_file, files
from pathlib import Path

from waxstudy.export.compiler import PLATFORMS, require_compiler, shared_library
from waxstudy.export.model import Model
from waxstudy.export.model_description import model_description
from waxstudy.export.tables import chain_tables, model_tables
from waxstudy.results.atomic import scratch_folder, whole_file

SHELL = files("waxstudy.export").joinpath("shell")
DAY = (1980, 1, 1, 0, 0, 0)  # of every file in it: the same model is the same file


def write_fmu(path: Path, model: Model, *, fmi: int, platforms: Sequence[str]) -> None:
    """Write an FMU of a chain; raise `BackendMissing`, `CompilerFailed` or `OSError`, and then write nothing."""
    with scratch_folder("waxstudy-fmu-") as folder:
        tables = folder / "tables.c"
        tables.write_text(model_tables(model) + chain_tables(model), encoding="utf-8")
        codes = [folder / f"{stage.symbol}.ll" for stage in model.stages if stage.symbol]
        for code, stage in zip(codes, (each for each in model.stages if each.symbol), strict=True):
            code.write_text(stage.code, encoding="utf-8")
        with as_file(SHELL) as shell:
            pack(path, model, [tables, shell / "chain.c", *codes], fmi=fmi, platforms=platforms)


def pack(path: Path, model: Model, sources: Sequence[Path], *, fmi: int, platforms: Sequence[str]) -> None:
    """Write an FMU of any model of which these sources give the tables and `model_step` of `shell/model.h`."""
    require_compiler()
    identifier = identifier_of(path)
    with scratch_folder("waxstudy-fmu-") as folder, as_file(SHELL) as shell:
        members = {"modelDescription.xml": model_description(model, identifier, fmi).encode()}
        for each in (PLATFORMS[name] for name in platforms):
            library = folder / f"{identifier}{each.ending}"
            shared_library([*sources, shell / "instance.c", shell / f"fmi{fmi}.c"], shell, each, library)
            place = each.folder2 if fmi == 2 else each.folder3
            members[f"binaries/{place}/{library.name}"] = library.read_bytes()
        with whole_file(path) as temporary, zipfile.ZipFile(temporary, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, data in members.items():
                archive.writestr(zipfile.ZipInfo(name, DAY), data, zipfile.ZIP_DEFLATED)


def identifier_of(path: Path) -> str:
    """Return the name of a file as one that C and every file system knows.

    >>> identifier_of(Path("data/my motor-B.fmu")), identifier_of(Path("2nd.fmu"))
    ('my_motor_B', 'm2nd')
    """
    name = re.sub(r"\W", "_", path.stem, flags=re.ASCII) or "model"
    return f"m{name}" if name[0].isdigit() else name
