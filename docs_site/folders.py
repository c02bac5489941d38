"""What each folder of the code holds, as its own docstring says, from the bottom up."""

from __future__ import annotations

import ast
import re
import tomllib
from collections.abc import Iterable, Iterator
from pathlib import Path

from docs_site.tables import plain, table

ROOT = Path(__file__).parents[1]
LAYERED = ("waxstudy", "waxstudy/diagnosis")  # folders whose parts a contract in pyproject.toml puts into an order
INTRO = (
    "What each folder of the code holds, as its docstring says. Of `waxstudy` and `waxstudy/diagnosis` a line imports "
    "nothing from a line below it. [Development](../development.md) says how the code works.\n"
)


def folders() -> str:
    """Return the page of the folders of the code."""
    parts = {folder: list(_layers(folder)) for folder in LAYERED}
    parts["plugins"] = [*_modules("plugins"), *(ROOT / "plugins").glob("*/src/*")]
    parts["benchmarks"] = list(_modules("benchmarks"))
    sections = [f"## `{folder}`\n\n{_table(folder, paths)}" for folder, paths in parts.items()]
    return "\n".join(["# Folders of the code\n", INTRO, *sections])


def about(path: Path) -> str:
    """Return the first paragraph of the docstring of a module or package, empty if it has none."""
    file = path / "__init__.py" if path.is_dir() else path
    docstring = ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or ""
    return docstring.partition("\n\n")[0]


def _table(folder: str, paths: Iterable[Path]) -> str:
    rows = [(f"`{path.relative_to(ROOT / folder).as_posix()}`", _linked(plain(about(path)))) for path in paths]
    return table(("in it", "what it holds"), rows)


def _linked(text: str) -> str:
    return re.sub(r"docs/([\w-]+\.md)", r"[\1](../\1)", text)


def _layers(folder: str) -> Iterator[Path]:
    """The parts of a folder in the order of its contract, the lowest first."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    package = folder.replace("/", ".")
    for contract in settings["tool"]["importlinter"]["contracts"]:
        layers = [f"{place}.{layer}" for place in contract.get("containers", []) for layer in contract["layers"]]
        for layer in reversed(layers or contract.get("layers", [])):
            names = [name.rpartition(".") for name in layer.replace(f"{package}.", "").split(" | ")]
            if layer.startswith(f"{package}.") and not any(outer for outer, _, _ in names):
                yield from (_path(ROOT / folder / name) for _, _, name in names)


def _path(place: Path) -> Path:
    return place if place.is_dir() else place.with_suffix(".py")


def _modules(folder: str) -> Iterator[Path]:
    """The modules and packages in a folder that say what they are."""
    for path in sorted((ROOT / folder).iterdir()):
        if path.suffix == ".py" or (path / "__init__.py").is_file():
            yield path
