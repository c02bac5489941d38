"""`waxstudy rig`"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from waxstudy.cli.errors import FAILED, INVALID, PLUGIN, USAGE, CommandError, taken
from waxstudy.cli.existing import Existing, Written
from waxstudy.cli.output import Command, print_out
from waxstudy.cli.pairs import pairs

if TYPE_CHECKING:
    from waxstudy.rig.instruments import Bench

SET = "Parameter of the actuator; repeatable."
BENCH = "Parameter of the bench, as noise_mm=0.01 (docs/bench.md lists them); repeatable."
PROGRAMME = "CSV file of the records to make  [default: those of the paper's Table A1, and one of flow]"


@click.command("rig", cls=Command)
@click.argument("folder", metavar="DIR", type=Written())
@click.option("--actuator", default="variable-times", show_default=True, metavar="NAME", help="Actuator on the bench.")
@click.option("--set", "values", multiple=True, callback=pairs, metavar="KEY=VALUE", help=SET)
@click.option("--valve", default="quick-opening", show_default=True, metavar="NAME", help="Valve of the flow record.")
@click.option("--bench", multiple=True, callback=pairs, metavar="KEY=VALUE", help=BENCH)
@click.option("--programme", type=Existing(dir_okay=False), help=PROGRAMME)
@click.option("--seed", type=click.IntRange(min=0), default=1, show_default=True, help="Seed of scatter and noise.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def command(
    folder: Path,
    actuator: str,
    values: dict[str, Any],
    valve: str,
    bench: dict[str, Any],
    programme: Path | None,
    seed: int,
    as_json: bool,
) -> None:
    """Make displacement and flow records of an actuator on a virtual test bench.

    DIR gets the records and records.toml, which says what each is of. All are simulated and say so. The truth goes to
    DIR-truth.json, beside the folder.
    """
    from waxstudy.plugin.registry import PluginError, installed
    from waxstudy.rig.bench import Motors
    from waxstudy.synthetic.write import truth_beside

    truth = truth_beside(folder)
    if os.path.lexists(folder):
        raise taken(folder)
    try:
        motors = Motors(actuator, values, valve, _bench(bench), seed)
        _make(folder, motors, programme)
    except PluginError as error:
        # an unknown name is the plugins' fault only if one of them is broken
        raise CommandError(str(error), PLUGIN if installed().broken else USAGE) from error
    print_out(json.dumps({"records": str(folder), "truth": str(truth)}) + "\n" if as_json else f"{truth}\n{folder}\n")


def _bench(values: dict[str, Any]) -> Bench:
    from waxstudy.plugin.parameters import checked
    from waxstudy.plugin.registry import hint
    from waxstudy.rig.instruments import Bench

    known = list(Bench.model_fields)
    for key in values:
        if key not in known:
            raise CommandError(
                f"--bench {key}: the bench has no such parameter{hint(key, known)} (it has: {', '.join(known)})", USAGE
            )
    try:
        return checked(Bench, values)
    except ValueError as error:
        raise CommandError(f"--bench {error}", USAGE) from error


def _make(folder: Path, motors: Any, programme: Path | None) -> None:
    from waxstudy.plugin import SimulationError
    from waxstudy.rig.programme import read_programme, table_a1
    from waxstudy.rig.write import write_rig
    from waxstudy.study.problems import StudyError
    from waxstudy.synthetic.write import OtherTruth

    try:
        write_rig(folder, motors, read_programme(programme) if programme else table_a1())
    except StudyError as error:
        raise CommandError(str(error), INVALID, label="") from error
    except ValueError as error:
        raise CommandError(f"actuator '{motors.actuator}': {error}", USAGE) from error
    except SimulationError as error:
        raise CommandError(str(error), FAILED) from error
    except OtherTruth as error:
        raise taken(Path(str(error))) from error
    except OSError as error:
        reason = os.strerror(error.errno) if error.errno else str(error)
        raise CommandError(f"{folder}: the records cannot be written: {reason}", FAILED) from error
