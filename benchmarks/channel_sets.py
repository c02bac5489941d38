"""What is lost where sun or gains were not recorded: `python -m benchmarks.channel_sets WEATHER.epw`.

Healthy loops, and loops with an effect of the chain above three noise floors, in January to March. Each record is
diagnosed with all channels, without sun, without gains, with neither, and with light on level ground in place of the
sun. The house strays from its papers in all that nobody knows of it; its people are others, at other hours. What is
done is kept: the same command goes on where it was ended.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from itertools import zip_longest
from pathlib import Path
from typing import Any

import tomli_w

from benchmarks.channel_sets_records import (
    GAINS,
    INTERVAL_S,
    LIGHT,
    SETS,
    SUN,
    House,
    Made,
    NoHeating,
    house,
    nulls,
    with_effect,
)
from benchmarks.self_consistency import ROOT, share, sources
from waxstudy.blind_test.sizes.record import Record
from waxstudy.blind_test.truth import Stand, cut_of_effect
from waxstudy.dataset.channels import CHANNELS
from waxstudy.dataset.read import Dataset, read_dataset
from waxstudy.diagnosis.diagnose import diagnose
from waxstudy.plugin import Effect
from waxstudy.plugin.trial import Cause
from waxstudy.results.atomic import whole_file
from waxstudy.synthetic.instruments import Instruments

FOLDER = ROOT / "results" / "channel-sets"
LEAST = 3.0  # true gap over its noise floor from which an effect must be named
FREE = Instruments(INTERVAL_S, noise=dict.fromkeys(CHANNELS, 0.0), resolution=dict.fromkeys(CHANNELS, 0.0))

Told = dict[str, Any]


def outcome(made: Made, folder: Path, sets: Sequence[str], quick: bool) -> Iterator[Told]:
    """Yield what the diagnosis says of a record with each channel set; what the folder has is taken from there."""
    paths = {name: folder / f"{made.name} {name}.json" for name in sets}
    missing = [name for name, path in paths.items() if not path.exists()]
    if missing:
        happened = house(made)
        size = _over_floor(made, happened)
        for name in missing:
            told = {"record": made.name, "set": name, "effect": made.effect, "over_floor": size}
            if made.effect and size < LEAST:
                told |= {"verdict": "too small", "named": [], "unexplained": []}
            else:
                told |= _diagnosed(happened, SETS[name], quick)
            with whole_file(paths[name]) as path:
                path.write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")
    for path in paths.values():
        yield json.loads(path.read_text(encoding="utf-8"))


def _diagnosed(happened: House, has: Sequence[str], quick: bool) -> Told:
    instruments = Instruments(INTERVAL_S, seed=happened.seed)
    table = happened.table(instruments).drop(columns=[name for name in (SUN, GAINS, LIGHT) if name not in has])
    begin = time.process_time()
    found = diagnose(_dataset(happened, table, instruments), quick=quick)
    return {
        "verdict": found.verdict,
        "named": [list(each.group) for each in found.effects],
        "unexplained": [each.stage for each in found.unexplained if each.is_finding],
        "processor_s": round(time.process_time() - begin, 1),
    }


def _dataset(happened: House, table: Any, instruments: Instruments) -> Dataset:
    with tempfile.TemporaryDirectory() as place:
        table.to_csv(Path(place) / "data.csv", index=False)
        (Path(place) / "dataset.toml").write_bytes(tomli_w.dumps(happened.dataset(table, instruments)).encode())
        return read_dataset(Path(place))


def _over_floor(made: Made, happened: House) -> float:
    """Return the true gap over its noise floor, of the channel where it stands out most; 0 of a null."""
    if not made.effect:
        return 0.0
    instruments = Instruments(INTERVAL_S, seed=happened.seed)
    seen, free = (_dataset(happened, happened.table(each).drop(columns=LIGHT), each) for each in (instruments, FREE))
    noisy = [Record.of(seen.values, seen, is_noisy=True)]
    stand = Stand(free, Record.of(free.values, free), noisy, happened.departures)
    effect = made.effects[0].component
    assert issubclass(effect, Effect)
    stretch = stand.stretch_of(Cause(effect.name, (effect.stage,)))
    assert stretch
    cut = cut_of_effect(stand, stretch, made.effects, [])
    return max(gap / cut.floors[channel] for channel, gap in cut.gaps.items())


def is_alarm(told: Mapping[str, Any]) -> bool:
    """Whether a null got a name, or the verdict that something unknown is there."""
    return bool(told["named"]) or told["verdict"] == "unknown"


def is_named(told: Mapping[str, Any]) -> bool:
    return any(told["effect"] in group for group in told["named"])


def summary(told: Sequence[Told], sets: Sequence[str]) -> Iterator[str]:
    """Yield the shares of each channel set, of the records that all of them have."""
    by_record: dict[str, dict[str, Told]] = {}
    for each in told:
        by_record.setdefault(each["record"], {})[each["set"]] = each
    whole = [each for each in by_record.values() if set(each) >= set(sets)]
    none = [each for each in whole if not each[sets[0]]["effect"]]
    large = [each for each in whole if each[sets[0]]["effect"] and each[sets[0]]["over_floor"] >= LEAST]
    yield f"{len(none)} nulls, {len(large)} records with an effect above {LEAST:g} floors"
    for name in sets:
        others = [each for each in large if each[name]["named"] and not is_named(each[name])]
        yield f"{name:11} false alarms or unknown {share(sum(is_alarm(each[name]) for each in none), len(none))}"
        yield f"{'':11} named                   {share(sum(is_named(each[name]) for each in large), len(large))}"
        yield f"{'':11} others named            {share(len(others), len(large))}"


def _line(told: Told) -> str:
    named = "; ".join(" | ".join(group) for group in told["named"])
    said = f"{told['verdict']:10} {named or '-'}"
    return f"{told['record']:26} {told['set']:11} {told['over_floor']:7.1f} {said} {' '.join(told['unexplained'])}"


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.channel_sets", description=__doc__)
    parser.add_argument("weather", type=Path, metavar="WEATHER.epw")
    parser.add_argument("--nulls", type=int, default=40, help="records without an effect  [default: 40]")
    parser.add_argument("--effects", type=int, default=40, help="records with one  [default: 40]")
    parser.add_argument("--days", type=int, default=7, help="length of each  [default: 7]")
    parser.add_argument("--sets", nargs="+", choices=SETS, default=list(SETS), help="channel sets  [default: all]")
    parser.add_argument("--folder", type=Path, default=FOLDER, help="where outcomes are kept, a folder per source")
    parser.add_argument("--quick", action="store_true", help="a third of the fits' effort, as `diagnose --quick`")
    parser.add_argument("--told", action="store_true", help="say only what is there")
    asked = parser.parse_args()
    folder = asked.folder / f"{sources()}-{asked.days}{'-quick' * asked.quick}"
    folder.mkdir(parents=True, exist_ok=True)
    none, some = (of(n, asked.weather, asked.days) for of, n in ((nulls, asked.nulls), (with_effect, asked.effects)))
    told: list[Told] = []
    for made in (each for pair in zip_longest(none, some) for each in pair if each):
        if asked.told and not all((folder / f"{made.name} {name}.json").exists() for name in asked.sets):
            continue
        try:
            for each in outcome(made, folder, asked.sets, asked.quick):
                told.append(each)
                print(_line(each), flush=True)
        except NoHeating as reason:
            print(f"left out: {reason}", flush=True)
    print("\n".join(summary(told, asked.sets)))


if __name__ == "__main__":
    main()
