"""`waxstudy export fmu`"""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from waxstudy.cli.errors import BACKEND, FAILED, PLUGIN, USAGE, CommandError, say, taken
from waxstudy.cli.existing import Existing, Written
from waxstudy.cli.export.common import block, chain
from waxstudy.cli.output import Command, print_out
from waxstudy.cli.pairs import pairs

if TYPE_CHECKING:
    from waxstudy.export.model import Model

PLATFORM = "linux64, win64, darwin64 or, for FMI 3.0, linux-arm64, darwin-arm64; repeatable  [default: this machine's]"
NAMES = ("linux64", "win64", "darwin64", "linux-arm64", "darwin-arm64")
STEP = "Step of the block inside [s]; that of the study with --case  [default: 5]"


@click.command("fmu", cls=Command)
@click.argument("file", metavar="[FILE.toml]", type=Existing(dir_okay=False), required=False)
@click.option("--use", metavar="NAME", help="An installed block instead of a file's.")
@click.option("--kind", metavar="KIND", help="Which kind of block, where several have the name.")
@click.option("--set", "values", multiple=True, callback=pairs, metavar="KEY=VALUE", help="Parameter; repeatable.")
@click.option("--case", metavar="ID", help="The whole chain of a case; FILE.toml is its study.")
@click.option("--out", type=Written(), required=True, metavar="FILE.fmu", help="The FMU to write.")
@click.option("--fmi", type=click.Choice(["2", "3"]), default="2", show_default=True, help="Version of FMI.")
@click.option("--step", "step_s", type=click.FloatRange(0.01, 60.0), help=STEP)
@click.option("--platform", "platforms", multiple=True, type=click.Choice(NAMES), metavar="NAME", help=PLATFORM)
def command(
    file: Path | None,
    use: str | None,
    kind: str | None,
    values: dict[str, Any],
    case: str | None,
    out: Path,
    fmi: str,
    step_s: float | None,
    platforms: tuple[str, ...],
) -> None:
    """Write a block, or the whole chain of a case, as an FMU for co-simulation.

    FILE.toml is a fragment with one block, as `waxstudy fit` writes it, or with --case a study. The FMU holds machine
    code of the same step that runs here and needs no Python. The last line printed is the FMU.
    """
    if out.suffix != ".fmu":
        raise CommandError(f"--out {out}: the name of an FMU ends with .fmu", USAGE)
    if os.path.lexists(out):
        raise taken(out)
    if case is not None:
        if file is None or use or kind or values or step_s is not None:
            raise CommandError("--case takes a study and its step: leave --use, --kind, --set and --step out", USAGE)
        model = _made(lambda: chain(file, case))
    else:
        if file is not None and kind:
            raise CommandError(f"--kind goes with --use: {file} says itself what it describes", USAGE)
        model = _made(lambda: block(file, use, kind, values, step_s or 5.0))
    _write(out, model, int(fmi), list(dict.fromkeys(platforms)))
    print_out(f"{out}\n")


def _made(make: Any) -> Model:
    from waxstudy.export.model import NotExportable
    from waxstudy.plugin import SimulationError
    from waxstudy.plugin.registry import PluginError

    try:
        model: Model = make()
    except (NotExportable, PluginError) as error:
        raise CommandError(str(error), PLUGIN) from error
    except SimulationError as error:
        raise CommandError(str(error), FAILED) from error
    return model


def _write(out: Path, model: Model, fmi: int, platforms: list[str]) -> None:
    from waxstudy.export.compiler import PLATFORMS, CompilerFailed, this_platform
    from waxstudy.export.fmu import write_fmu
    from waxstudy.plugin import BackendMissing

    if not platforms and not this_platform():
        raise CommandError(f"this machine is none of {', '.join(NAMES)}: name one with --platform", USAGE)
    chosen = platforms or [this_platform()]
    if fmi == 2 and (unnamed := [name for name in chosen if not PLATFORMS[name].folder2]):
        raise CommandError(f"FMI 2.0 has no name for {', '.join(unnamed)}: use --fmi 3", USAGE)
    if "win64" in chosen:
        say("the first FMU for win64 takes some minutes: its C library is compiled once")
    try:
        write_fmu(out, model, fmi=fmi, platforms=chosen)
    except BackendMissing as error:
        raise CommandError(str(error), BACKEND) from error
    except CompilerFailed as error:
        raise CommandError(str(error), FAILED) from error
    except OSError as error:
        raise CommandError(f"{out}: the FMU cannot be written: {error.strerror or error}", FAILED) from error
