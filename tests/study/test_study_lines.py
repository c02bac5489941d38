"""The line of every key."""

import doctest
import tomllib
from pathlib import Path
from types import ModuleType

import pytest
import tomli_w
from hypothesis import given
from hypothesis import strategies as st

from waxstudy.study import lines, problems
from waxstudy.study.lines import key_lines

TEXT = """\
# a comment
top.dotted = 1
"quoted. key" = 2
'literal' = 3

[table]
"\\u0041b" . c = { d = 1, e.f = [
  1,
  # a comment between
  { g = 2 },
] }
[table.sub]
x = '''
a text of two lines'''
y = 1
[[entries]]
n = 1
[[entries.inner]]
m = 1
[[entries.inner]]
m = 2
[entries.table]
k = 3
[[entries]]
n = 2
"""


@pytest.mark.parametrize(
    ("path", "line"),
    [
        (("top", "dotted"), 2),
        (("quoted. key",), 3),
        (("literal",), 4),
        (("table",), 6),
        (("table", "Ab", "c", "d"), 7),
        (("table", "Ab", "c", "e", "f", 0), 8),
        (("table", "Ab", "c", "e", "f", 1, "g"), 10),
        (("table", "sub"), 12),
        (("table", "sub", "x"), 13),
        (("table", "sub", "y"), 15),
        (("entries", 0, "n"), 17),
        (("entries", 0, "inner", 0, "m"), 19),
        (("entries", 0, "inner", 1), 20),
        (("entries", 0, "inner", 1, "m"), 21),
        (("entries", 0, "table", "k"), 23),
        (("entries", 1), 24),
        (("entries", 1, "n"), 25),
    ],
)
def test_every_way_to_write_a_key_has_its_line(path: tuple[str | int, ...], line: int) -> None:
    assert key_lines(TEXT)[path] == line


def paths(value: object, path: tuple[str | int, ...] = ()) -> set[tuple[str | int, ...]]:
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return {path}.union(*(paths(one, (*path, key)) for key, one in inner))


@pytest.mark.parametrize("text", [TEXT, (Path(__file__).parents[2] / "studies/table5.toml").read_text()])
def test_the_keys_with_a_line_are_the_keys_of_the_values(text: str) -> None:
    assert set(key_lines(text)) | {()} == paths(tomllib.loads(text))


@given(st.lists(st.text(st.characters(codec="utf-8"), min_size=1), min_size=1, max_size=4, unique=True))
def test_any_quoted_key_is_found_on_its_own_line(keys: list[str]) -> None:
    text = tomli_w.dumps(dict.fromkeys(keys, 1))
    assert key_lines(text) == {(key,): i for i, key in enumerate(keys, start=1)}


@pytest.mark.parametrize("module", [lines, problems])
def test_the_examples_in_the_docstrings_hold(module: ModuleType) -> None:
    result = doctest.testmod(module)
    assert result.attempted
    assert not result.failed
