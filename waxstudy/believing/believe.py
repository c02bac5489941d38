"""What is believed of a record's room and loop: asked for, checked, and written into its dataset.toml."""

from __future__ import annotations

import os
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import tomli_w

from waxstudy.believing import shown, tables
from waxstudy.believing.questions import NO_GUESS, QUESTIONS, Question
from waxstudy.believing.tolerance import Widened, tolerance, widened
from waxstudy.dataset.channels import GLOBAL, PANELS
from waxstudy.dataset.description import FILES
from waxstudy.dataset.read import Dataset, read_dataset
from waxstudy.dataset.stand_ins import SUN
from waxstudy.dataset.tables import TRUSTED
from waxstudy.importing.asking import Ask, Proposed
from waxstudy.importing.asking import Question as Asked
from waxstudy.results.atomic import scratch_folder
from waxstudy.study.fragment import FROM
from waxstudy.study.problems import Problem, StudyError
from waxstudy.study.source import read_source

TAKEN = ("building", "room", "nominal", "site", "believe")  # tables that another file may give
SHOWN = "as the record shows"
STATED = "stated"
OF_ROOM = ("building", "room")
CURVE = "heating_curve_C"  # as it was written: a record that has grown may show another


@dataclass(frozen=True)
class Request:
    """What the user states; what is not stated is asked."""

    folder: Path
    stated: Mapping[str, str] = field(default_factory=dict)  # answers by key, as typed
    other: Path | None = None  # file to take what is believed from


@dataclass(frozen=True)
class Answer:
    """One answer, as typed, with what it is and where it comes from."""

    key: str
    text: str
    value: Any
    source: str
    is_guess: bool


@dataclass(frozen=True)
class Believed:
    """What is to be written, and why."""

    tables: Mapping[str, Mapping[str, Any]]  # of dataset.toml: what these keys become
    answers: Sequence[Answer]
    widened: Sequence[Widened]
    command: str
    told: Sequence[str]  # sentences for the user
    curve_C: Any = None  # that the record shows, or the usual one

    @property
    def room_tolerance(self) -> float:
        return tolerance(self.widened)


def believe(request: Request, ask: Ask) -> Believed:
    """Return what is believed of a dataset's room and loop; raise `StudyError` for what cannot be used."""
    values = read_source(request.folder / "dataset.toml").values
    taken = _of_other(request, values)
    whole = {**values, **taken}
    earlier = _earlier(whole)
    record = _read(request.folder, {**whole, "nominal": {}, "building": {}, "room": {}})
    asked = [each for each in QUESTIONS if _is_open(each, whole, earlier, record)]
    _refuse_kept(request, asked)
    answers = _answers(request, asked, earlier, record, ask)
    known = {answer.key: answer.value for answer in answers}
    curve_C = shown.heating_curve_C(record)
    made = _made(known, asked, curve_C, whole, request.folder)
    curve_C = made.get("building", {}).get(CURVE)
    is_known = all(each.key in earlier.values for each in asked if each.table == "building")
    before = _made(earlier.values, asked, earlier.curve_C or curve_C, whole, request.folder) if is_known else {}
    made, told = _with_edits(made, before, whole)
    checked = _read(request.folder, {**whole, **{name: _joined(whole.get(name, {}), made[name]) for name in made}})
    guessed = {answer.key for answer in answers if answer.is_guess}
    room = checked.room if "building" in made else None
    own = {each.name: each.sd for each in room.component.uncertainties(room.parameters)} if room else {}  # type: ignore[attr-defined]
    return Believed({**taken, **made}, answers, widened(guessed, own), _command(request, answers), told, curve_C)


# --- what is there ------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Earlier:
    """Answers of an earlier time, as [believe] holds them."""

    values: Mapping[str, Any] = field(default_factory=dict)
    stated: Mapping[str, str] = field(default_factory=dict)  # as typed, those that somebody gave
    curve_C: Any = None


def _earlier(values: Mapping[str, Any]) -> Earlier:
    about = values.get("believe")
    answers = about.get("answers", {}) if isinstance(about, dict) else {}
    given = about.get("stated", []) if isinstance(about, dict) else []
    read: dict[str, Any] = {}
    for question in QUESTIONS:
        try:
            read |= {question.key: question.read(answers[question.key])} if question.key in answers else {}
        except (ValueError, AttributeError):  # somebody edited it: it is asked again
            continue
    curve_C = about.get(CURVE) if isinstance(about, dict) else None
    return Earlier(read, {key: answers[key] for key in read if key in given}, curve_C)


def _is_open(question: Question, values: Mapping[str, Any], earlier: Earlier, record: Dataset) -> bool:
    """Whether a question is this command's to ask: not where somebody wrote the table, nor where the record tells."""
    names = OF_ROOM if question.table == "building" else (question.table,)
    is_ours = any(each.table == question.table and each.key in earlier.values for each in QUESTIONS)
    if any(values.get(name) for name in names) and not is_ours:
        return False
    if question.key == "setpoint_C":
        return "setpoint_C" not in record.values
    if question.key == "panels":
        return PANELS in record.values and not {SUN, GLOBAL} & set(record.values)
    return question.key != "place" or SUN not in record.values


def _refuse_kept(request: Request, asked: Sequence[Question]) -> None:
    open_keys = {question.key for question in asked}
    path = str(request.folder / "dataset.toml")
    wrong = "cannot be set: the record tells it, or its table was written by hand and stays; change it there"
    if kept := [key for key in request.stated if key not in open_keys]:
        raise StudyError([Problem(path, 0, "", f"--set {key}", "", wrong) for key in kept])


def _of_other(request: Request, values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the tables of the other file that this one has not."""
    if request.other is None:
        return {}
    other = read_source(request.other)
    names = [name for name in TAKEN if isinstance(other.values.get(name), dict) and other.values[name]]
    if not set(names) & {*OF_ROOM, "nominal"}:
        wrong = "holds no [building], [room] or [nominal] to take"
        raise StudyError([Problem(str(request.other), 0, "", "", "", wrong, allowed="a dataset.toml or a study")])
    has_room = any(values.get(name) for name in OF_ROOM)
    found = {
        name: _moved(other.values[name], other.folder, request.folder)
        for name in names
        if not values.get(name) and not (has_room and name in OF_ROOM)
    }
    about = other.values.get("dataset")
    own = {key: about[key] for key in TRUSTED if key in about} if isinstance(about, dict) else {}
    if own.get("room_tolerance") == other.values.get("believe", {}).get("room_tolerance"):
        own.pop("room_tolerance", None)  # of guesses, which are weighed anew here
    kept = values.get("dataset") or {}
    return found | ({"dataset": {**own, **kept}} if own and not has_room else {})


def _moved(value: Any, here: Path, there: Path) -> Any:
    """Return a table whose files are named as seen from another folder."""
    if not isinstance(value, dict):
        return value
    return {
        key: _seen_from(there, here / each) if key == FROM and isinstance(each, str) else _moved(each, here, there)
        for key, each in value.items()
    }


def _seen_from(folder: Path, path: Path) -> str:
    try:
        return Path(os.path.relpath(path.resolve(), folder.resolve())).as_posix()
    except ValueError:  # on another drive
        return path.resolve().as_posix()


# --- answers ------------------------------------------------------------------------------------------


def _answers(request: Request, asked: Sequence[Question], earlier: Earlier, record: Dataset, ask: Ask) -> list[Answer]:
    found: dict[str, Answer] = {}
    known: dict[str, Any] = {}
    for question in asked:
        if question.key == "dead_band_K" and known.get("thermostat") != "on-off":
            continue
        if question.key == "panels" and known.get("place") is None:
            continue
        typed = request.stated.get(question.key, earlier.stated.get(question.key))
        answer = _told(request, question, typed) if typed is not None else _asked(request, question, known, record, ask)
        found[question.key], known[question.key] = answer, answer.value
    return list(found.values())


def _told(request: Request, question: Question, typed: str) -> Answer:
    try:
        return Answer(question.key, typed, question.read(typed), STATED, False)
    except ValueError as error:
        path = str(request.folder / "dataset.toml")
        raise StudyError([Problem(path, 0, "", f"--set {question.key}", typed, str(error))]) from error


def _asked(request: Request, question: Question, known: Mapping[str, Any], record: Dataset, ask: Ask) -> Answer:
    proposal = question.propose(known)
    flow_L_h = shown.full_flow_L_h(record) if question.key == "full_flow_L_h" else None
    if flow_L_h is not None:
        return Answer(question.key, f"{flow_L_h:g}", flow_L_h, SHOWN, False)

    def wrong(text: str) -> str:
        try:
            question.read(text)
        except ValueError as error:
            return str(error)
        return ""

    choices = sorted(question.choices, key=lambda each: each != proposal.text)
    where = str(request.folder / "dataset.toml")
    text = f"{question.text} [default {proposal.text}: {proposal.source}]"
    typed = ask(Asked(text, choices, proposal.text, f"--set {question.key}=", where, None, wrong))
    is_default = isinstance(typed, Proposed)  # who types the same knows it
    is_guess = is_default and question.key not in NO_GUESS
    return Answer(question.key, typed, question.read(typed), proposal.source if is_default else STATED, is_guess)


def _command(request: Request, answers: Sequence[Answer]) -> str:
    """Return what to type for the same again, without a question."""
    words = ["waxstudy", "believe", str(request.folder)]
    words += ["--from", str(request.other)] if request.other else []
    words += [w for each in answers if each.source == STATED for w in ("--set", f"{each.key}={each.text}")]
    return shlex.join(words + ["--yes"] * any(each.source not in (STATED, SHOWN) for each in answers))


# --- tables -------------------------------------------------------------------------------------------


def _made(
    known: Mapping[str, Any], asked: Sequence[Question], curve_C: Any, values: Mapping[str, Any], folder: Path
) -> dict[str, dict[str, Any]]:
    """Return the tables that answers make."""
    imported = values.get("import")
    zone = imported.get("timezone", "") if isinstance(imported, dict) else ""
    motor = str(known.get("motor", ""))
    motor_from = _seen_from(folder, Path(motor)) if motor.endswith(".toml") else ""
    made = {"nominal": dict(tables.nominal(known, motor_from)), "site": tables.site(known, str(zone))}
    if any(question.table == "building" for question in asked):
        made["building"] = tables.building(known, curve_C)
    return {name: table for name, table in made.items() if table}


def _with_edits(
    made: Mapping[str, Mapping[str, Any]], before: Mapping[str, Mapping[str, Any]], values: Mapping[str, Any]
) -> tuple[dict[str, dict[str, Any]], list[str]]:
    """Return tables without the keys that somebody changed by hand since, and a sentence about each.

    None stands for a key of an earlier time that is to go.
    """
    kept, told = {}, []
    for name in sorted({*made, *before}):
        there, earlier = values.get(name) or {}, before.get(name, {})
        table = {**dict.fromkeys(earlier), **made.get(name, {})}
        edited = [key for key in table if key in there and there[key] != earlier.get(key)]
        told += [f"[{name}] {key} = {there[key]} stays: it was written by hand" for key in edited]
        kept[name] = {key: value for key, value in table.items() if key not in edited}
    return kept, told


def _joined(there: Mapping[str, Any], made: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in {**there, **made}.items() if value is not None}


# --- checks -------------------------------------------------------------------------------------------


def _read(folder: Path, values: Mapping[str, Any]) -> Dataset:
    """Return the dataset that a description with these values makes; raise `StudyError` under the name of its file."""
    about = dict(values.get("dataset") or {})
    named = [about["file"]] if "file" in about else [name for name in FILES if (folder / name).exists()]
    if named:
        about["file"] = str((folder / named[0]).resolve())
    whole = {key: value for key, value in values.items() if key not in ("baseline", "dataset") and value != {}}
    whole |= {"dataset": about, "nominal": values.get("nominal", {})}
    with scratch_folder("waxstudy-believe-") as place:
        (place / "dataset.toml").write_bytes(tomli_w.dumps(_moved(whole, folder, place)).encode())
        try:
            return read_dataset(place)
        except StudyError as error:
            there, here = str(place / "dataset.toml"), str(folder / "dataset.toml")
            mended = [replace(each, file=here, line=0) if each.file == there else each for each in error.problems]
            raise StudyError(mended) from error
