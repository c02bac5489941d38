"""Claims about what the records give away, and what their seals tell."""

from __future__ import annotations

import base64
import json
import os
import shutil
import subprocess
import sys
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.blind_test.conftest import CASES, NONE, answered_by, copied
from tests.cli.conftest import Entry
from tests.conftest import call
from waxstudy.blind_test import make, truth
from waxstudy.blind_test.box import BOX_BYTES, MAGIC, OVERHEAD_BYTES, close_box, open_box
from waxstudy.blind_test.draw import Case, drawn
from waxstudy.blind_test.key import Key, KeyProblem
from waxstudy.blind_test.make import Place
from waxstudy.blind_test.plan import Plan, Slot, available
from waxstudy.blind_test.record import FILES, PAGE_BYTES, WIDTH, digest_of
from waxstudy.plugin.trial import Unmakeable

Scored = Callable[..., tuple[int, str]]

DRAWS = 500
STAMP = len("2021-01-01T00:01:00")


def test_names_are_random_and_all_files_have_one_time(place: Place) -> None:
    names = place.names()
    assert len(names) == CASES == len(list(place.records.iterdir()))
    files = [path for folder in place.records.iterdir() for path in (folder, *folder.iterdir())]
    boxes = [place.box(name) for name in names]
    assert {path.name for path in files if path.is_file()} == set(FILES)
    assert len({path.stat().st_mtime for path in [*files, *boxes]}) == 1 or os.name != "posix"


@pytest.mark.skipif(sys.platform != "linux", reason="only stat of Linux tells when a file was born")
def test_files_are_born_in_the_order_of_their_names_whatever_took_long_to_make(finished_test: Path) -> None:
    place = Place(finished_test / "test")
    files = [p for name in place.names() for p in (*(place.record(name) / f for f in FILES), place.box(name))]
    said = subprocess.run(["stat", "--format=%.9W", *map(str, files)], capture_output=True, text=True, check=True)
    born_s = [float(line) for line in said.stdout.split()]
    if not any(born_s):
        pytest.skip("this file system does not say when a file was born")
    assert born_s == sorted(born_s)
    assert max(born_s) - min(born_s) < 1.0


def test_a_gap_that_no_draw_makes_large_enough_leaves_the_last_that_could_be_had(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def tried(place: Place, key: Key, slot: Slot, index: int, attempt: int, is_judged: bool) -> Any:
        if attempt % 2:
            raise Unmakeable("an odd one")
        return attempt, None, None

    monkeypatch.setattr(make, "_tried", tried)
    monkeypatch.setattr(truth, "sizes", lambda *said, **how: [None])
    slot = Slot("goal", "fast-room", "single", least_over=2.0)
    case, _, sizes = make.settled(Place(tmp_path), Key(1, "a" * 32), slot, 0, is_judged=True)
    assert (case, sizes) == (make.ATTEMPTS - 2, [None])


def test_a_record_that_a_reader_would_refuse_is_drawn_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    written, first = make.write_record, ["supply_temperature_C", "return_temperature_C"]

    def swapped_at_first(folder: Path, *of: Any) -> None:
        written(folder, *of)
        text = (folder / "data.csv").read_text()
        if first:
            one, other = (first.pop() for _ in range(2))
            (folder / "data.csv").write_text(text.replace(one, "@", 1).replace(other, one, 1).replace("@", other, 1))

    monkeypatch.setattr(make, "write_record", swapped_at_first)
    monkeypatch.setattr(truth, "sizes", lambda *said, **how: [None])
    place, slot = Place(tmp_path), Slot("null", "fast-room", "null")
    place.records.mkdir()
    case, *_ = make.settled(place, Key(1, "a" * 32), slot, 0, is_judged=True)
    assert (first, case.attempt) == ([], 1)


def test_a_file_is_as_long_as_its_rows_and_columns_make_it(place: Place) -> None:
    for name in place.names():
        folder = place.record(name)
        header, *rows = (folder / "data.csv").read_text().splitlines()
        columns = len(header.split(",")) - 1
        assert {len(row) for row in rows} == {STAMP + columns * (WIDTH + 1)}
        assert (folder / "dataset.toml").stat().st_size % PAGE_BYTES == 0
        assert place.box(name).stat().st_size == BOX_BYTES + OVERHEAD_BYTES
    assert len({(place.record(name) / "dataset.toml").stat().st_size for name in place.names()}) == 1


def cases(count: int) -> list[Case]:
    """Return what a key draws, in its own order."""
    key, plan = Key(5, "b" * 32), Plan(cases=count, engines=available(is_judged=False))
    found = []
    for index, slot in enumerate(plan.slots(key)):
        try:
            found.append(drawn(key, slot, index, 0, is_judged=False))
        except Unmakeable:
            continue
    return found


def shown_of(case: Case, place: int) -> list[float]:
    """Return all that a folder gives away: name, place among the others, and sizes, which rows and columns make."""
    rows = case.measured.days * 86_400 / case.measured.interval_s
    letters = [int(letter, 16) for letter in case.name]
    return [place, rows, np.log(rows), *letters]


def accuracy(features: np.ndarray, labels: np.ndarray, neighbours: int = 9) -> float:
    """Return how often the nearest others, by what is shown, have a record's own label."""
    scaled = (features - features.mean(axis=0)) / features.std(axis=0)
    distance = np.sum((scaled[:, None] - scaled[None]) ** 2, axis=2)
    np.fill_diagonal(distance, np.inf)
    near = labels[np.argsort(distance, axis=1)[:, :neighbours]]
    votes = [np.argmax(np.bincount(row)) for row in near]
    return float(np.mean(votes == labels))


@pytest.mark.parametrize("what", ["kind", "stage"])
def test_folder_order_and_sizes_predict_the_truth_no_better_than_chance(what: str) -> None:
    """Permutation test: the nearest neighbours' vote, against the same with the labels shuffled 200 times.

    Channels are left out: they are drawn by themselves, and a record cannot hide which it has.
    """
    found = cases(DRAWS)
    words = [case.kind if what == "kind" else (case.causes[0].stages[0] if case.causes else "") for case in found]
    labels = np.unique(words, return_inverse=True)[1]
    order = np.argsort([case.name for case in found])
    features = np.array([shown_of(found[place], number) for number, place in enumerate(order)])
    labels = labels[order]
    random = np.random.default_rng(1)
    chance = [accuracy(features, random.permutation(labels)) for _ in range(200)]
    assert accuracy(features, labels) <= max(chance)


def test_such_a_vote_would_see_a_leak() -> None:
    random = np.random.default_rng(2)
    labels = random.integers(0, 4, DRAWS)
    features = np.column_stack([labels + random.normal(0.0, 0.6, DRAWS), random.normal(size=DRAWS)])
    chance = [accuracy(features, random.permutation(labels)) for _ in range(50)]
    assert accuracy(features, labels) > max(chance)


def test_what_is_told_to_everybody_says_nothing_of_a_record(place: Place) -> None:
    said = json.dumps([place.about, place.sealed])
    assert not any(word in said for word in ("cause", "let-by", "sensor", "null", "single"))


def test_the_same_key_draws_the_same_and_another_salt_does_not() -> None:
    plan = Plan(cases=20, engines=available(is_judged=False))
    slots = [[slot for slot in plan.slots(Key(7, salt * 32))] for salt in "aab"]
    assert slots[0] == slots[1] != slots[2]
    assert Key(7, "a" * 32).record_name(3) != Key(7, "b" * 32).record_name(3)


def test_a_box_opens_with_its_own_key_only_and_unchanged_only(key: Key) -> None:
    box = close_box(key, "x", {"causes": []})
    assert open_box(key, "x", box) == {"causes": []}
    changed = [box[:place] + bytes([box[place] ^ 1]) + box[place + 1 :] for place in (0, 9, 30, len(box) - 1)]
    for each in (*changed, b"", box[:40]):
        with pytest.raises(KeyProblem):
            open_box(key, "x", each)
    with pytest.raises(KeyProblem):
        open_box(Key(key.seed, "0" * 32), "x", box)


def test_a_box_is_its_record_s_and_opens_for_no_other(key: Key) -> None:
    with pytest.raises(KeyProblem):
        open_box(key, "y", close_box(key, "x", {"causes": []}))


def test_a_box_that_was_moved_to_another_record_is_told(answered: Path, scored: Scored) -> None:
    place = Place(answered)
    first, second = place.names()[:2]
    shutil.copy(place.box(first), place.box(second))
    code, said = scored("--key-file", "key")
    assert (code, f"{second}: the sealed truth of {second} does not open" in said) == (1, True)


def test_only_what_seals_or_opens_a_box_loads_the_cipher() -> None:
    loaded = "import sys, waxstudy, waxstudy.cli.blind_test.solve, waxstudy.blind_test.make; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", loaded], capture_output=True, text=True, check=True)
    assert "waxstudy.blind_test.box" in done.stdout.split()
    assert not {"cryptography", "setproctitle"} & set(done.stdout.split())


def test_two_truths_under_one_key_and_name_have_nothing_in_common(key: Key) -> None:
    """A keystream that is used twice gives away the XOR of what it hides."""
    first, second = (close_box(key, "x", {"causes": name}) for name in ("a", "b"))
    mixed = bytes(one ^ other for one, other in zip(first, second, strict=True))
    assert mixed.count(0) < len(mixed) / 100 + len(MAGIC)
    assert close_box(key, "x", 1) != close_box(key, "x", 1)


def test_a_box_of_the_first_format_opens_still(key: Key) -> None:
    """Made by the code of the seventh judged run: key 7-aaaa..., record x."""
    box = zlib.decompress(base64.b64decode((Path(__file__).parent / "box_format_1.txt").read_text()))
    old = Key(7, "a" * 32)
    assert open_box(old, "x", box) == {"causes": ["let-by"]}
    for wrong, name in ((key, "x"), (old, "y")):
        with pytest.raises(KeyProblem):
            open_box(wrong, name, box)
    with pytest.raises(KeyProblem):
        open_box(old, "x", box[:-1] + b"!")


@pytest.fixture
def scored(entry: Entry) -> Scored:
    """Score the test in the present folder; return the exit code and what was said."""

    def score(*more: str) -> tuple[int, str]:
        done = entry("blind-test", "score", "test", *more)
        return done.code, done.stdout + done.stderr

    return score


@pytest.fixture(scope="module")
def answered_once(finished_test: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return answered_by(finished_test, tmp_path_factory.mktemp("answered"), "external", NONE)


@pytest.fixture
def answered(answered_once: Path, tmp_path: Path) -> Path:
    """The small test, answered by one who finds nothing; its key lies beside it."""
    return copied(answered_once, tmp_path)


def test_a_changed_record_and_a_changed_truth_are_told(answered: Path, scored: Scored, key: Key) -> None:
    place = Place(answered)
    first, second, third = place.names()[:3]
    data = place.record(first) / "data.csv"
    data.write_text(data.read_text().replace("1", "2", 1))
    sealed = json.loads((answered / "sealed.json").read_text())
    sealed["records"][first]["files"] = digest_of(place.record(first))  # anybody can write that
    (answered / "sealed.json").write_text(json.dumps(sealed))
    truth = open_box(key, second, place.box(second).read_bytes())
    place.box(second).write_bytes(close_box(key, second, {**truth, "attempt": 99}))
    place.box(third).write_bytes(b"nothing")
    code, said = scored("--key-file", "key")
    assert code == 1
    assert f"{first}: its files are not those that were sealed" in said
    assert f"{second}: its truth is not the one that was sealed" in said
    assert f"{third}: the sealed truth of {third} does not open" in said


def test_a_wrong_key_and_none_are_told(answered: Path, scored: Scored, key: Key) -> None:
    for text, said in (
        (str(Key(key.seed, "0" * 32)), "this is not the key of these records"),
        ("abc", "this is no key"),
    ):
        answered.with_name("other").write_text(text)
        code, told = scored("--key-file", "other")
        assert (code, told.startswith(f"error: {said}")) == (2, True)
    answered.with_name("noise").write_bytes(bytes(range(256)))
    assert scored("--key-file", "noise")[1].startswith("error: this is no key")
    assert "needs --key-file" in scored()[1]


def test_a_key_is_never_an_argument_and_never_below_the_set(
    answered: Path, entry: Entry, scored: Scored, key: Key
) -> None:
    """Arguments are seen by every process of the machine, and what lies with the records by whoever gets them."""
    for command in ("make", "solve", "score"):
        told = entry("blind-test", command, "--help").stdout
        assert "--key-file" in told
        assert "--key " not in told
    code, said = scored("--key", str(key))
    assert (code, said.endswith("Did you mean '--key-file'?\n")) == (2, True)
    (answered / "records" / "key").write_text(str(key))
    code, said = scored("--key-file", "test/records/key")
    assert (code, said) == (2, "error: test/records/key: a key does not lie with what it seals: move it out of test\n")
    (answered / "link").symlink_to(answered.with_name("key"))
    assert scored("--key-file", "test/link")[0] == 2
    done = entry("blind-test", "make", "--cases", "1", "--out", "new", "--key-file", "new/key")
    assert (done.code, (answered.parent / "new").exists()) == (2, False)
    done = call(answered.parent, "blind-test", "score", "test", "--key-file", "-", "--quiet", input=f"{key}\n")
    assert done.returncode == 0


def test_a_test_that_is_not_made_to_the_end_is_told(answered: Path, scored: Scored) -> None:
    (answered / "sealed.json").unlink()
    code, said = scored("--key-file", "key")
    assert (code, "not all records are made" in said) == (2, True)


def test_going_on_needs_the_key_and_the_same_plan(small_test: Path, entry: Entry) -> None:
    def made(*more: object) -> tuple[int, str]:
        done = entry("blind-test", "make", "--out", "test", *more)
        return done.code, done.stderr

    assert "give their --key-file" in made("--cases", CASES)[1]
    assert "another plan" in made("--cases", CASES + 1, "--key-file", "key")[1]
    shutil.rmtree(small_test / "boxes")
    shutil.rmtree(small_test / "records")
    (small_test / "blind-test.json").unlink()
    assert "something else" in made("--cases", CASES)[1]
