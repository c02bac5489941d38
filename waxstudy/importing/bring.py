"""The whole import but for its folder: sources, clock, room, channels, grid."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from waxstudy.dataset.channels import CHANNELS, SHOW_ROOM
from waxstudy.dataset.notes import Notes
from waxstudy.dataset.zones import is_zone, zone_hint
from waxstudy.importing import units
from waxstudy.importing.asking import NONE, Ask, Question
from waxstudy.importing.channels import channels_of
from waxstudy.importing.joining import joined
from waxstudy.importing.layouts import readings_of
from waxstudy.importing.left_out import without_lone, without_modes
from waxstudy.importing.limits import FRACTION, NAMED
from waxstudy.importing.matching import Match, is_kept_by_unit, matched
from waxstudy.importing.names import CHANNEL_NAMES, OTHERS, is_contact, is_of_room, plain, rooms_of, says
from waxstudy.importing.reading import Logged, NoStamps, Readings, Table, Unordered, problem, refusal
from waxstudy.importing.request import Imported, Request
from waxstudy.importing.seen import Seen, is_plausible, seen
from waxstudy.importing.sources import files_of, tables_of
from waxstudy.importing.words import numbers_of
from waxstudy.importing.zone import in_standard_time, without_unset, zone_told
from waxstudy.plugin.registry import hint, nearest
from waxstudy.study.problems import StudyError, listed

OUTDOORS = "outdoor_temperature_C"
LONGEST_WORD = 20  # letters of a reading that a message shows
NO_OUTDOORS = (
    "no outdoor temperature was found: without it nothing can be said of a room. A history of a weather service does "
    "as well, or a weather file (EPW) that was measured on those days, as one more SOURCE"
)


def bring(request: Request, ask: Ask) -> Imported:
    """Return the channels of an import; raise `StudyError` for what cannot be used."""
    notes = Notes(str(request.sources[0]))
    readings = _read(request)
    zone = _zone(request, readings, ask)
    readings, said = in_standard_time(readings, zone)
    readings = joined(readings)
    _refuse_other_days(readings)
    places = {each.entity: each.place for each in readings if each.place}
    # a column of stamps says the same of all that stands beside it
    notes.assumptions += said + list(dict.fromkeys(sentence for each in readings for sentence in each.notes))
    request = replace(request, timezone=zone)
    worded, blank = list[str](), list[str]()
    logged = [found for each in readings if (found := _logged(each, notes, worded, blank)) is not None]
    del readings
    if worded:
        notes.warn(f"not used, because the readings are unknown words: {listed(worded, NAMED)}")
    if blank:
        notes.warn(f"not used, because no reading is a value: {listed(blank, NAMED)}")
    logged = without_modes(logged, list(request.entities.values()), notes)
    logged = without_lone(logged, list(request.entities.values()), notes)
    request, logged = _of_room(request, logged, ask)
    entities = seen(logged, dict(request.units))
    _refuse_unknown(request, entities)
    request, matches = _decided(request, entities, ask, notes)
    if OUTDOORS not in matches and OUTDOORS not in request.entities:
        raise _no_outdoors(request, entities, matches, blank)
    _tell_unseen_room(request, entities, matches, notes)
    _tell_unknown_units(entities, matches, notes)
    _tell_other_units(entities, matches, notes)
    imported = channels_of(request, matches, entities, notes, ask)
    taken = [places[match.seen.entity] for match in matches.values() if match.seen.entity in places]
    return replace(imported, place=taken[0]) if taken else imported


# --- sources ------------------------------------------------------------------------------------------


def _read(request: Request) -> list[Readings]:
    files = files_of(request.sources)
    found: list[Readings] = []
    unordered: list[tuple[Path, Unordered]] = []
    for file in files:
        try:
            found += _of_file(request, file)
        except Unordered as error:
            unordered.append((file, error))
    found += [each for file, error in unordered for each in _of_their_days(request, file, error, found)]
    found = [without_unset(each) for each in found if len(each.times)]
    if not found:
        raise refusal(str(request.sources[0]), "holds no readings")
    return found


def _of_their_days(request: Request, file: Path, error: Unordered, others: Sequence[Readings]) -> list[Readings]:
    """Return a lone reading, whose day may be its month, where that puts it among the others; else raise the error."""
    times = [each.times.tz_localize(None) for each in others if len(each.times) and each.place is None]
    if not times:
        raise error
    first, last = min(each.min() for each in times), max(each.max() for each in times)
    fitting = []
    for form in error.forms:
        read = _of_file(replace(request, time_format=form), file)
        if all(len(each.times) == 1 and first <= each.times.tz_localize(None)[0] <= last for each in read):
            said = f"{file.name}: its stamp is taken as {form}, as the other files are of those days."
            fitting.append([replace(each, notes=(*each.notes, said)) for each in read])
    if len(fitting) != 1:
        raise error
    return fitting[0]


def _of_file(request: Request, file: Path) -> list[Readings]:
    """Return what a file holds; of several tables those without stamps are left out, as long as one has some."""
    found: list[Readings] = []
    without: list[NoStamps] = []
    for each in tables_of(file):
        try:
            found += readings_of(each, file, request.time_format, request.begin) if isinstance(each, Table) else [each]
        except NoStamps as error:
            without.append(error)
    if without and not found:
        raise without[0]
    said = tuple(f"{error.problems[0].file} is left out: it has no column of stamps." for error in without)
    return [replace(each, notes=(*each.notes, *said)) for each in found] if said else found


def _zone(request: Request, readings: Sequence[Readings], ask: Ask) -> str:
    if request.timezone is not None:
        return request.timezone
    told = zone_told(readings)
    if told is not None:
        return told

    def allowed(answer: str) -> str:
        return "" if is_zone(answer) else f"'{answer}' is no time zone{zone_hint(answer)}"

    text = "Stamps are in UTC. In which time zone is the room (as Europe/Tallinn)"
    return ask(Question(text, (), None, "--timezone ", readings[0].where, "UTC", allowed))


def _logged(readings: Readings, notes: Notes, worded: list[str], blank: list[str]) -> Logged | None:
    """Return readings as numbers; note what is none, and add the name of what has words, with the first, or nothing."""
    numbers = numbers_of(readings.written)
    if not numbers.is_readable:
        if numbers.bad:
            worded.append(f"{readings.entity} ('{numbers.bad[1][:LONGEST_WORD]}')")
        else:
            blank.append(readings.entity)
        return None
    if numbers.bad:
        row, text = numbers.bad
        first = f"the first is '{text}' in row {row}"
        notes.warn(
            f"{readings.where}: {readings.entity}: {numbers.bad_count} readings are no values ({first}): missing"
        )
    _refuse_units(readings, numbers.units)
    values = numbers.values
    if numbers.is_passage and is_contact(readings.entity):
        values = 1.0 - values
        notes.warn(f"{readings.where}: {readings.entity} is taken as on where it is closed, as a contact is")
    return Logged(
        entity=readings.entity,
        where=readings.where,
        ns=readings.times.as_unit("ns").asi8,
        values=values,
        rows=readings.written.index.to_numpy(),
        unit=readings.unit or numbers.unit,
        is_words=numbers.is_words,
        is_mean=readings.is_mean,
        said=numbers.said if np.isfinite(numbers.said).any() else None,
        is_of_house=readings.place is None,
    )


def _refuse_units(readings: Readings, written: Sequence[str]) -> None:
    """Refuse readings with several units behind them, as a page shows them that fits each to its size."""
    known = sorted({units.plain_unit(one): one for one in written if units.fitting(one, list(units.BASE))}.values())
    if len(known) > 1:
        wrong = f"{readings.entity} has readings in {listed(known, NAMED)}"
        raise refusal(readings.where, wrong, "export its values as they are, without units behind them")


def _refuse_other_days(readings: Sequence[Readings]) -> None:
    """Refuse weather of other days than the house's."""
    own = [each for each in readings if each.place is None]
    if not own:
        raise refusal(readings[0].where, "is weather alone", "name the house's own record as a SOURCE, too")
    first, last = min(each.times.min() for each in own), max(each.times.max() for each in own)
    for each in readings:
        if each.place and (each.times.max() < first or each.times.min() > last):
            has = f"{each.times.min():%Y-%m-%d} to {each.times.max():%Y-%m-%d}"
            wrong = f"is weather of {has}, and the record is of {first:%Y-%m-%d} to {last:%Y-%m-%d}"
            raise refusal(each.where, wrong, "take measured weather of those days")


# --- room ---------------------------------------------------------------------------------------------


def _of_room(request: Request, logged: list[Logged], ask: Ask) -> tuple[Request, list[Logged]]:
    """Return the entities of the room that is asked for, and those of none; stated ones stay, wherever they are."""
    rooms = rooms_of([each.entity for each in logged])
    names = sorted(set(rooms.values()))
    room = request.room
    if room is None and len(names) > 1 and not set(request.entities) & {"sensor_temperature_C", "air_temperature_C"}:
        room = ask(Question("Readings of several rooms. Which one", names, None, "--room ", logged[0].where))
    if room is None or not logged:
        return request, logged
    if not any(is_of_room(each.entity, room) for each in logged):
        near = f"rooms: {listed(names)}" if names else f"names: {listed([each.entity for each in logged], NAMED)}"
        raise refusal(logged[0].where, f"no name says that it is of the room '{room}'{hint(room, names)}", near)
    stated = set(request.entities.values())

    def is_wanted(each: Logged) -> bool:
        return each.entity in stated or is_of_room(each.entity, room) or each.entity not in rooms

    return replace(request, room=room), [each for each in logged if is_wanted(each)]


def _refuse_unknown(request: Request, entities: Sequence[Seen]) -> None:
    names = [each.entity for each in entities]
    asked = [("--map", entity) for entity in request.entities.values() if entity]
    asked += [("--unit", entity) for entity in request.units]
    for entity, unit in request.units.items():
        try:
            units.conversion(unit, "level")
        except ValueError as error:
            allowed = "a unit such as degC, 0.1degC, %, L/h"
            raise refusal(str(request.sources[0]), str(error), allowed, key=f"--unit {entity}") from error
    if wrong := [
        replace(
            problem(
                str(request.sources[0]),
                "no such name with readings in it",
                f"names: {listed(names, NAMED)}",
                key=option,
                value=entity,
            ),
            near=nearest(entity, names),
        )
        for option, entity in asked
        if entity not in names
    ]:
        raise StudyError(wrong)


# --- channels -----------------------------------------------------------------------------------------


def _decided(request: Request, entities: Sequence[Seen], ask: Ask, notes: Notes) -> tuple[Request, dict[str, Match]]:
    """Return which entity is which channel; what is doubtful is asked one by one, as an answer may settle others."""
    stated = dict(request.entities)
    taken: dict[str, Match] = {}
    while True:
        found = matched(entities, stated, request.room or "")
        doubtful = next((match for match in found.values() if not match.is_sure), None)
        if doubtful is None:
            return replace(request, entities=stated), found | taken
        stated[doubtful.channel] = _answered(doubtful, entities, ask, notes)
        if stated[doubtful.channel] == doubtful.seen.entity and not doubtful.rivals:
            taken[doubtful.channel] = replace(doubtful, why=f"{doubtful.why}; taken as proposed")


def _answered(match: Match, entities: Sequence[Seen], ask: Ask, notes: Notes) -> str:
    """Return the entity of a channel that is in doubt, "" for none."""
    fitting = [match.seen.entity, *match.rivals]
    option = f"--map {match.channel}="
    if match.rivals and match.is_by_values:
        notes.warn(
            f"{match.channel} may be any of {listed(fitting, NAMED)}, by their values alone: none is taken; "
            f"say {option}NAME"
        )
        return ""
    if match.rivals:
        text = f"{listed(fitting, NAMED)} fit {match.channel} equally well. Which one"
    else:
        text = f"Is {match.seen.entity} {match.channel}? Sure by {match.confidence:.0%}: {match.why}. Which one"
        text += _or_output(match)
    choices = [*fitting, *(each.entity for each in entities if each.entity not in fitting), NONE]
    proposal = None if match.rivals else match.seen.entity
    answer = ask(Question(text, choices, proposal, option, match.seen.logged.where, fitting[0]))
    return "" if answer == NONE else answer


def _tell_unseen_room(request: Request, entities: Sequence[Seen], matches: Mapping[str, Match], notes: Notes) -> None:
    """Say that nothing shows the room, or what a controller reads alone, which does not; unless that was stated."""
    of_flow = {"flow_L_h", "return_temperature_C"}
    if set(SHOW_ROOM) & set(matches) or of_flow <= set(matches) or SHOW_ROOM[0] in request.entities:
        return
    lone = matches.get("sensor_temperature_C")
    if lone is None:
        own = [each for each in entities if request.room and is_of_room(each.entity, request.room)]
        option, others = f"--map {SHOW_ROOM[0]}=NAME", _that_may_be(SHOW_ROOM[0], own or entities, matches)
        may_be = f"may it be {others}? then" if others else "if one is there,"
        notes.warn(f"no thermometer of the room was found, as {SHOW_ROOM[0]}: {may_be} say {option}")
    else:
        option = shlex.join(["--map", f"{SHOW_ROOM[0]}={lone.seen.entity}"])
        also = f"{lone.seen.entity} became sensor_temperature_C, what the controller reads"
        notes.warn(f"a room is judged by {SHOW_ROOM[0]}: {also}; if it is all that shows the room, say {option}")


def _tell_unknown_units(entities: Sequence[Seen], matches: Mapping[str, Match], notes: Notes) -> None:
    """Say of what is not used because nobody knows its unit."""
    used = {match.seen.entity for match in matches.values()}
    if unknown := [f"{each.entity} ('{each.unit}')" for each in entities if each.entity not in used and _is_odd(each)]:
        notes.warn(
            f"not used, because the unit is none that is known: {listed(unknown, NAMED)}; to use one, say "
            "--unit NAME=UNIT"
        )


def _tell_other_units(entities: Sequence[Seen], matches: Mapping[str, Match], notes: Notes) -> None:
    """Say of what is called as a channel why it is none, where its unit is that of something else."""
    used = {match.seen.entity for match in matches.values()}
    others = [each for each in entities if each.entity not in used and each.is_unit_written and not _is_odd(each)]
    if found := [f"{each.entity} ('{each.unit}')" for each in others if is_kept_by_unit(each)]:
        notes.warn(
            f"not used, because the unit is of something else than the name: {listed(found, NAMED)}; if it is misread, "
            "say --unit NAME=UNIT"
        )


def _is_odd(each: Seen) -> bool:
    try:
        units.conversion(each.unit, "level")
    except ValueError:
        return bool(each.unit)
    return False


def _or_output(match: Match) -> str:
    """Say what else a signal may be that nothing but its values tells."""
    if match.channel != "heating_signal" or not match.is_by_values:
        return ""
    return f" (if a controller asks for it, say {shlex.join(['--map', f'control_output={match.seen.entity}'])})"


def _no_outdoors(
    request: Request, entities: Sequence[Seen], matches: Mapping[str, Match], blank: Sequence[str]
) -> StudyError:
    others = _that_may_be(OUTDOORS, entities, matches)
    may_be = f"may it be {others}? then say --map {OUTDOORS}=NAME; " if others else ""
    lost = f"no reading of {listed(blank, NAMED)} is a value; " if blank else ""
    mend = f"{lost}{may_be}--map {OUTDOORS}= says that there is none"
    return refusal(str(request.sources[0]), NO_OUTDOORS, mend)


def _that_may_be(channel: str, entities: Sequence[Seen], matches: Mapping[str, Match]) -> str:
    """Return what is not used and may be a temperature by its values, in words; "" for nothing."""
    used = {match.seen.entity for match in matches.values()}
    found = [each.entity for each in entities if each.entity not in used and _may_be(channel, each)]
    return listed(found, NAMED) if found else ""


def _may_be(channel: str, each: Seen) -> bool:
    is_like = is_plausible(each, CHANNELS[channel].quantity) and each.distinct > 2
    is_share = each.low >= 0.0 and each.high <= FRACTION
    return bool(is_like) and (each.is_unit_written or not (is_share or _names_no_temperature(plain(each.entity))))


def _names_no_temperature(name: str) -> bool:
    """Whether a name says clearly that an entity is something else than a temperature."""
    others = [words.clear for channel, words in CHANNEL_NAMES.items() if not channel.endswith("_C")]
    return any(says(name, words) for words in (*others, OTHERS)) and not says(name, "temp\\w*")
