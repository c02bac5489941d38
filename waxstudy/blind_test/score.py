"""The score: truths opened and checked, answers marked, figures by stratum, failures listed."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from waxstudy.blind_test.answer import Answer, NoAnswer
from waxstudy.blind_test.box import open_box
from waxstudy.blind_test.draw import drawn
from waxstudy.blind_test.figures import Figure, mean, median, share
from waxstudy.blind_test.goals import HALF, WHERE, described_goals, where_of
from waxstudy.blind_test.key import Key, KeyProblem, canonical
from waxstudy.blind_test.make import FORMAT, BlindTestError, Place
from waxstudy.blind_test.marks import Mark, Truth, relative_errors, with_probabilities
from waxstudy.blind_test.record import digest_of
from waxstudy.blind_test.solve import LEAVE_ONE_OUT, OURS, WITHOUT_BASELINES, answer_path, is_answered, stored
from waxstudy.plugin.files import read_file
from waxstudy.plugin.trial import Unmakeable

CLOSE = 0.2  # of a parameter
BINS = 5  # of stated probability
OVER = ((0.0, 1.0), (1.0, 2.0), (2.0, 4.0), (4.0, 10.0), (10.0, float("inf")))


@dataclass(frozen=True)
class Opened:
    """Truths by record, and what is wrong with the seals."""

    boxes: Mapping[str, Mapping[str, Any]]
    broken: Sequence[str] = field(default_factory=list)


def opened(place: Place, key: Key) -> Opened:
    """Draw every case again from the key, open its box, and hold both against the seals.

    Raises `KeyProblem` for another key, `BlindTestError` where records are not all made.
    """
    place.check_key(key)
    plan, sealed = place.plan, place.sealed["records"]
    boxes, broken = {}, []
    for index, slot in enumerate(plan.slots(key)):
        name = key.record_name(index)
        try:
            boxes[name] = open_box(key, name, read_file(place.box(name)))
        except (OSError, KeyProblem) as error:
            broken.append(f"{name}: {error}")
            continue
        seal, box = sealed.get(name, {}), boxes[name]
        if key.seal_of(name, box) != seal.get("truth"):
            broken.append(f"{name}: its truth is not the one that was sealed")
        if _digest(place, name) != box["files"]:
            broken.append(f"{name}: its files are not those that were sealed")
        if not _is_drawn(key, slot, index, plan.is_judged, box):
            broken.append(f"{name}: the key draws another case")
    return Opened(boxes, broken)


def _digest(place: Place, name: str) -> str:
    try:
        return digest_of(place.record(name))
    except OSError:
        return ""


def _is_drawn(key: Key, slot: Any, index: int, is_judged: bool, box: Mapping[str, Any]) -> bool:
    """Whether the key draws the case of a box."""
    try:
        case = drawn(key, slot, index, box["attempt"], is_judged)
    except Unmakeable:
        return False
    return all(canonical(box[name]) == canonical(value) for name, value in case.described().items())


def diagnosers(place: Place) -> list[str]:
    """Return whose answers are there; raise `BlindTestError` where nobody's are."""
    folder = place.folder / "answers"
    found = sorted(path.name for path in folder.iterdir() if path.is_dir()) if folder.is_dir() else []
    if not found:
        raise BlindTestError(f"{place.folder}: nobody has answered: run `blind-test solve` first")
    return found


def marks(place: Place, who: str, truths: Mapping[str, Truth]) -> list[Mark]:
    """Return the marks of all records that a diagnoser has answered."""
    found = []
    for name, truth in truths.items():
        path = answer_path(place, who, name)
        if is_answered(path):
            said = stored(path)
            saw = truth.has_baseline and not who.endswith(WITHOUT_BASELINES)
            found.append(Mark(truth, _answer(said["answer"]), said.get("seconds", 0.0), saw))
    return found


def _answer(said: Any) -> Answer:
    try:
        return Answer.failed() if said is None else Answer.read(said)
    except NoAnswer:
        return Answer.failed()


def score(place: Place, opened: Opened, shrinkages: Mapping[str, Mapping[str, float]]) -> dict[str, Any]:
    """Return the score of everybody who answered; `shrinkages` are true ones by diagnoser and record."""
    truths = {name: Truth.read(box) for name, box in opened.boxes.items()}
    everybody = [name for name in diagnosers(place) if name != LEAVE_ONE_OUT]
    left_out = marks(place, LEAVE_ONE_OUT, truths)
    told = {}
    for name in everybody:
        own = marks(place, name, truths)
        also = left_out if name == OURS else []
        told[name] = scored(own, len(truths), also, shrinkages.get(name, {}))
    about = place.about
    return {
        "format": FORMAT,
        "plan": about["plan"],
        "key_fingerprint": about["key_fingerprint"],
        "records": len(truths),
        "kinds": _counts([truth.kind for truth in truths.values()]),
        "strata": _counts([truth.stratum for truth in truths.values()]),
        "engines": _counts([truth.engine for truth in truths.values()]),
        "broken_seals": list(opened.broken),
        "diagnosers": told,
    }


def _counts(words: Sequence[str]) -> dict[str, int]:
    return {word: words.count(word) for word in sorted(set(words))}


def scored(own: Sequence[Mark], records: int, left_out: Sequence[Mark], shrinks: Mapping[str, float]) -> dict[str, Any]:
    """Return what is told of one diagnoser."""
    return {
        "answered": len(own),
        "records": records,
        "failed": [mark.truth.name for mark in own if mark.answer.has_failed],
        "seconds": _figure(median([mark.seconds for mark in own])),
        "goals": described_goals(own, left_out, shrinks),
        "posterior": posteriors(own),
        "all": _described(own),
        "by": {name: _split(own, of) for name, of in SPLITS.items()},
        "parameters": _parameters(own),
        "confusion": _confusion(own),
        "failures": [_failure(mark) for mark in own if not mark.is_right],
        "left_out": [_failure(mark) for mark in left_out if not mark.left_out_honestly],
    }


# --- figures of some marks ---


def figures(own: Sequence[Mark]) -> dict[str, Figure]:
    """Return every figure, each over the records that it can be had of."""
    singles = [m for m in own if m.truth.kind == "single"]
    pairs = [m for m in own if m.truth.kind == "pair"]
    families = [m for m in own if m.truth.kind == "family"]
    caused = [m for m in own if m.truth.causes]
    claims = [claim for m in own for _, claim in m.right_claims]
    said = [each for m in own for each in m.parameters]
    errors = relative_errors(said)
    answered = [m for m in own if not m.answer.has_failed]
    return {
        "detection": share([m.detected for m in caused]),
        "right_group": share([m.right_group for m in singles]),
        "group_size": mean([len(claim.group) for claim in claims]),
        "top_1": share([m.top_1 for m in singles if m.is_nameable]),
        "stage": share([m.right_stage for m in singles]),
        "false_alarm": share([m.false_alarm for m in answered if m.truth.kind == "null"]),
        "misdiagnosis": share([m.misdiagnosis for m in answered if m.truth.kind in ("single", "pair")]),
        "over_claim": share([m.over_claim for m in answered if m.truth.kind == "single"]),
        "unknown_found": share([m.unknown_found for m in families]),
        "unknown_claimed": share([m.unknown_claimed for m in answered if m.truth.kind != "family"]),
        "both": share([m.right_group for m in pairs]),
        "one_of_two": share([bool(m.right_claims) for m in pairs]),
        "apart": share([m.has_apart for m in own if m.truth.departs]),
        "coverage": share([low <= true <= high for _, true, (_, low, high) in said]),
        "parameter_error": median(errors),
        "parameter_close": share([error <= CLOSE for error in errors]),
        "shrinkage": median([claim.shrink for claim in claims if claim.shrink is not None]),
        "brier": mean([m.brier for m in with_probabilities(own) if m.brier is not None]),
        "log_score": mean([m.log_score for m in with_probabilities(own) if m.log_score is not None]),
        "when": share([found >= HALF for m in own for _, found in m.overlaps]),
        "when_of_some": share([found >= HALF for m in own for is_timed, found in m.overlaps if is_timed]),
    }


# --- probabilities ---


def posteriors(own: Sequence[Mark]) -> dict[str, Any]:
    """Return by where a record counts what stated probabilities are worth; nothing where no answer has any.

    `every` has all hypotheses that are given one, `first` the likeliest of each answer.
    """
    found = {}
    for where in WHERE:
        said = [m for m in with_probabilities(own) if where_of(m) == where]
        if said:
            every = [each for m in said for each in m.stated]
            found[where] = {
                "answers": len(said),
                "failed": sum(m.answer.has_failed for m in said),
                "brier": _figure(mean([m.brier for m in said if m.brier is not None])),
                "log_score": _figure(mean([m.log_score for m in said if m.log_score is not None])),
                "every": _binned(every),
                "first": _binned([m.stated[0] for m in said if m.stated]),
            }
    return found


def _binned(stated: Sequence[tuple[float, bool]]) -> list[dict[str, Any]]:
    """Return for each of five bins of stated probability how many there are, their mean, and the share that is true."""
    bins = []
    for place in range(BINS):
        inside = [each for each in stated if min(BINS - 1, int(BINS * each[0])) == place]
        ends = {"from": place / BINS, "to": (place + 1) / BINS}
        mean_stated = sum(value for value, _ in inside) / len(inside) if inside else None
        true = _figure(share([is_true for _, is_true in inside]))
        bins.append({**ends, "count": len(inside), "stated": mean_stated, "true": true})
    return bins


def _described(own: Sequence[Mark]) -> dict[str, Any]:
    return {name: _figure(figure) for name, figure in figures(own).items()}


def _figure(figure: Figure) -> dict[str, Any]:
    return figure.described()


def _over(mark: Mark) -> str:
    low, high = next((low, high) for low, high in OVER if low <= mark.truth.over < high)
    return f"{low:g} to {high:g}" if high < float("inf") else f"above {low:g}"


def _noise(mark: Mark) -> str:
    factor = mark.truth.noise_factor
    return "nominal" if factor == 1.0 else ("less" if factor < 1.0 else "more")


SPLITS: Mapping[str, Callable[[Mark], str]] = {
    "cause": lambda mark: mark.truth.label if mark.truth.kind != "pair" else "two effects",
    "gap over floor": _over,
    "channels": lambda mark: mark.truth.channels,
    "noise": _noise,
    "engine": lambda mark: mark.truth.engine,
    "interval": lambda mark: f"{mark.truth.interval_s:g} s",
    "days": lambda mark: "3 to 5" if mark.truth.days < 6 else ("6 to 9" if mark.truth.days < 10 else "10 to 14"),
    "stratum": lambda mark: mark.truth.stratum,
}


def _split(own: Sequence[Mark], of: Callable[[Mark], str]) -> dict[str, Any]:
    groups: dict[str, list[Mark]] = {}
    for mark in own:
        groups.setdefault(of(mark), []).append(mark)
    return {name: {"records": len(groups[name]), **_described(groups[name])} for name in sorted(groups, key=_place)}


def _place(part: str) -> tuple[float, str]:
    """Parts that begin with a number stand in its order."""
    number = part.split()[0]
    return (float(number) if number.isdigit() else float("inf"), part)


def _parameters(own: Sequence[Mark]) -> dict[str, Any]:
    """Return error and coverage by parameter."""
    said: dict[str, list[tuple[str, float, tuple[float, float, float]]]] = {}
    for mark in own:
        for each in mark.parameters:
            said.setdefault(each[0], []).append(each)
    return {
        name: {
            "error": _figure(median(relative_errors(said[name]))),
            "coverage": _figure(share([low <= true <= high for _, true, (_, low, high) in said[name]])),
        }
        for name in sorted(said)
    }


def _confusion(own: Sequence[Mark]) -> dict[str, dict[str, int]]:
    """Return true cause -> what was said -> how often; of a claimed group its own name counts."""
    found: dict[str, dict[str, int]] = {}
    for mark in (m for m in own if m.truth.kind != "pair"):
        said = [claim.name for claim in mark.claims] or [mark.outcome]
        row = found.setdefault(mark.truth.label, {})
        for name in said:
            row[name] = row.get(name, 0) + 1
    return {name: dict(sorted(found[name].items())) for name in sorted(found)}


def _failure(mark: Mark) -> dict[str, Any]:
    truth = mark.truth
    return {
        "record": truth.name,
        "stratum": truth.stratum,
        "engine": truth.engine,
        "channels": truth.channels,
        "interval_s": truth.interval_s,
        "days": truth.days,
        "noise_factor": truth.noise_factor,
        "truth": truth.label,
        "values": {cause.name: dict(cause.values) for cause in truth.causes},
        "over": round(truth.over, 2),
        "beyond": round(truth.beyond, 2),
        "alike": sorted(set().union(*(cause.alike for cause in truth.causes))),
        "said": mark.outcome,
        "open": sorted({"+".join(sorted(stages)) for stages in mark.open_stages}),
    }
