"""`waxstudy export energyplus`"""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from waxstudy.cli.errors import FAILED, PLUGIN, USAGE, CommandError, taken
from waxstudy.cli.existing import Existing, Written
from waxstudy.cli.export.common import case_of, chosen
from waxstudy.cli.output import Command, print_out
from waxstudy.cli.pairs import pairs

if TYPE_CHECKING:
    from waxstudy.plugin import Choice

RADIANT = "Its ZoneHVAC:LowTemperatureRadiant:VariableFlow or ConstantFlow."
THERMOSTAT = "on-off"  # that a motor alone gets
DEAD_BAND_K = 0.5
BAND = f"Dead band of the thermostat that a motor alone gets [K]  [default: {DEAD_BAND_K:g}]"
POSITIVE = click.FloatRange(0.0, 1e6, min_open=True)


@click.command("energyplus", cls=Command)
@click.argument("file", metavar="[FILE.toml]", type=Existing(dir_okay=False), required=False)
@click.option("--use", metavar="NAME", help="An installed actuator instead of a file's.")
@click.option("--set", "values", multiple=True, callback=pairs, metavar="KEY=VALUE", help="Parameter; repeatable.")
@click.option("--case", metavar="ID", help="The whole chain of a case; FILE.toml is its study.")
@click.option("--zone", required=True, metavar="NAME", help="Zone of the EnergyPlus model.")
@click.option("--radiant", required=True, metavar="NAME", help=RADIANT)
@click.option("--full-flow-kg-s", required=True, type=POSITIVE, help="Water flow with the valve open [kg/s].")
@click.option("--setpoint-c", type=click.FloatRange(-50, 100), default=21.0, show_default=True, help="Setpoint [C].")
@click.option("--dead-band-k", type=click.FloatRange(0, 20), help=BAND)
@click.option("--step", "step_s", type=click.FloatRange(0.01, 60.0), help="Step of a motor alone [s]  [default: 5]")
@click.option("--out", type=Written(), required=True, metavar="FILE.py", help="The plugin to write.")
def command(
    file: Path | None,
    use: str | None,
    values: dict[str, Any],
    case: str | None,
    zone: str,
    radiant: str,
    full_flow_kg_s: float,
    setpoint_c: float,
    dead_band_k: float | None,
    step_s: float | None,
    out: Path,
) -> None:
    """Write a motor, or the whole chain of a case, as a Python plugin for EnergyPlus.

    FILE.toml is a fragment with an actuator, or with --case a study. The plugin is one file that needs no waxstudy.
    Printed are the objects to paste into the model, and last the file.
    """
    if out.suffix != ".py" or not out.stem.isidentifier():
        raise CommandError(f"--out {out}: the name of a plugin is letters, digits and '_', and ends with .py", USAGE)
    if os.path.lexists(out):
        raise taken(out)
    for option, name in (("--zone", zone), ("--radiant", radiant)):
        if not name.strip() or not name.isprintable() or any(mark in name for mark in ',;!"\\'):
            raise CommandError(f"{option} {name!r}: no name of EnergyPlus has , ; ! quotes or line breaks", USAGE)
    if case is not None and (file is None or use or values or step_s is not None):
        raise CommandError("--case takes a study and its step: leave --use, --set and --step out", USAGE)
    if case is not None and file is not None:
        blocks, step_s = case_of(file, case)
    else:
        blocks = {"actuator": chosen(file, use, "actuator" if use else None, values)}
        if (kind := blocks["actuator"].component.kind) != "actuator":
            raise CommandError(f"{file}: describes a {kind}; a motor is an [actuator], a whole chain a --case", USAGE)
    if "controller" in blocks and dead_band_k is not None:
        raise CommandError(f"--dead-band-k is of a motor alone: case '{case}' has a controller of its own", USAGE)
    if "controller" not in blocks:
        band_K = DEAD_BAND_K if dead_band_k is None else dead_band_k
        blocks = {**blocks, "controller": chosen(None, THERMOSTAT, "controller", {"dead_band_K": band_K})}
    _write(out, (blocks, step_s or 5.0), (zone, radiant, full_flow_kg_s, setpoint_c))


def _write(out: Path, chain: tuple[Mapping[str, Choice], float], where: tuple[str, str, float, float]) -> None:
    from waxstudy.export.energyplus import Place, objects, plugin
    from waxstudy.export.model import NotExportable
    from waxstudy.plugin import SimulationError
    from waxstudy.plugin.registry import PluginError
    from waxstudy.results.atomic import whole_file

    place = Place(*where)
    try:
        text = plugin(*chain, place, out.stem)
        with whole_file(out) as temporary:
            temporary.write_text(text, encoding="utf-8")
    except (NotExportable, PluginError) as error:
        raise CommandError(str(error), PLUGIN) from error
    except SimulationError as error:
        raise CommandError(str(error), FAILED) from error
    except OSError as error:
        raise CommandError(f"{out}: the plugin cannot be written: {error.strerror or error}", FAILED) from error
    print_out(f"{objects(place, out.stem)}\n{out}\n")
