"""Whatever is in a study file, it reads, or every problem is named with its place."""

import tomllib
from pathlib import Path
from typing import Any

import tomli_w
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from waxstudy.plugin.registry import Registry
from waxstudy.study.read import StudyError, read_study

EXAMPLE = (Path(__file__).parents[2] / "studies" / "table5.toml").read_bytes()

FIXTURES = settings(max_examples=200, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])

words = st.sampled_from(
    ["use", "id", "start", "steps", "path", "reference", "delay", "pi", "O_WM", "", "a.b", "x y", "é"]
)
values = st.recursive(
    st.one_of(st.booleans(), st.integers(-(2**63), 2**63), st.floats(), words, st.text(), st.datetimes(), st.dates()),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(words, inner, max_size=3),
    max_leaves=4,
)


def places(value: Any, place: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [(*place, key) for key, _ in inner] + [one for key, v in inner for one in places(v, (*place, key))]


@st.composite
def mutated_studies(draw: st.DrawFn) -> bytes:
    """The example with a few keys or values deleted, renamed, replaced or added."""
    study = tomllib.loads(EXAMPLE.decode())
    for _ in range(draw(st.integers(1, 4))):
        found = places(study)
        if not found:
            break
        *path, key = draw(st.sampled_from(found))
        table: Any = study
        for step in path:
            table = table[step]
        change = draw(st.sampled_from(["delete", "replace", "rename"]))
        old = table.pop(key)
        if change == "rename" and isinstance(table, dict):
            table[draw(words)] = old
        elif change != "delete":
            new = draw(values)
            table.insert(key, new) if isinstance(table, list) else table.update({key: new})
    return tomli_w.dumps(study).encode()


@st.composite
def damaged_texts(draw: st.DrawFn) -> bytes:
    """The example with a piece of it replaced by other bytes."""
    start = draw(st.integers(0, len(EXAMPLE)))
    end = draw(st.integers(start, min(start + 40, len(EXAMPLE))))
    piece = draw(
        st.binary(max_size=8) | st.sampled_from([b"[", b"{", b'"', b"'''", b"=", b"\n", b"[[", b"}", b"]", b"\\"])
    )
    return EXAMPLE[:start] + piece + EXAMPLE[end:]


def reads_or_names_the_place(data: bytes, folder: Path, registry: Registry) -> None:
    path = folder / "x.toml"
    path.write_bytes(data)
    try:
        resolved = read_study(path, registry).described()
    except StudyError as error:
        found = error
    else:
        path.write_text(tomli_w.dumps(resolved), encoding="utf-8")
        read_study(path, registry)
        return
    assert found.problems
    assert len(str(found).splitlines()) == len(found.problems) == len(set(found.problems))
    for problem in found.problems:
        assert problem.file == str(path)
        assert 1 <= problem.line <= data.count(b"\n") + 1
        assert problem.wrong
        assert problem.wrong != "is not allowed", "every kind of mistake has its own sentence"
        assert not problem.of_plugin


@FIXTURES
@given(data=mutated_studies())
def test_a_changed_study_reads_or_names_its_problems(data: bytes, tmp_path: Path, registry: Registry) -> None:
    reads_or_names_the_place(data, tmp_path, registry)


@FIXTURES
@given(data=damaged_texts())
def test_a_damaged_text_reads_or_names_its_problems(data: bytes, tmp_path: Path, registry: Registry) -> None:
    reads_or_names_the_place(data, tmp_path, registry)


@settings(FIXTURES, max_examples=50)
@given(data=st.binary(max_size=200) | st.text(max_size=200).map(str.encode))
def test_any_bytes_at_all_name_their_problems(data: bytes, tmp_path: Path, registry: Registry) -> None:
    reads_or_names_the_place(data, tmp_path, registry)
