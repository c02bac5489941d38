"""Begin a plugin: the files of a package of its own, with a working component to edit.

The templates are the files themselves with a few names left open; there is one module and one test of it per kind.
"""

from __future__ import annotations

import keyword
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from waxstudy import plugin
from waxstudy.plugin.contracts import API_VERSION, CHAIN, KINDS
from waxstudy.plugin.registry import Registry, hint
from waxstudy.plugin.structure import NAME, NAME_RULE, PROVIDED

LONGEST_NAME = 40  # so that every line with a name in it stays short


def package_of(name: str) -> str:
    """Return the package, and the folder, that a component of this name is begun in."""
    return f"waxstudy-{name}"


@dataclass(frozen=True)
class NewPlugin:
    """A plugin to begin: the component's name and kind, and what follows from them."""

    name: str
    kind: str

    @property
    def package(self) -> str:
        return package_of(self.name)

    @property
    def module(self) -> str:
        return self.package.replace("-", "_")

    @property
    def class_name(self) -> str:
        """The name as Python writes classes; with its kind where Python or the contracts have that word already.

        >>> NewPlugin("wax-motor", "actuator").class_name, NewPlugin("linear-room", "room").class_name
        ('WaxMotor', 'LinearRoomRoom')
        """
        word = "".join(part.capitalize() for part in self.name.split("-"))
        return f"{word}{self.kind.capitalize()}" if keyword.iskeyword(word) or hasattr(plugin, word) else word

    def problems(self, registry: Registry) -> Iterator[str]:
        """Yield what speaks against this name and kind, each in one line."""
        if not NAME.fullmatch(self.name) or len(self.name) > LONGEST_NAME:
            yield f"{self.name!r} cannot be a name: {NAME_RULE}, at most {LONGEST_NAME} characters"
            return
        if self.kind not in KINDS:
            yield f"no kind {self.kind!r}{hint(self.kind, KINDS)} (kinds: {', '.join(KINDS)})"
        elif taken := registry.components.get((self.kind, self.name)):
            yield f"{taken} is installed already: choose another name"
        elif find_spec(self.module):
            yield f"a module {self.module} is installed already: choose another name"

    def files(self) -> dict[str, str]:
        """Return the text of each file by its path in the package's folder."""
        from jinja2 import Environment, PackageLoader, StrictUndefined

        environment = Environment(
            loader=PackageLoader(__name__),
            undefined=StrictUndefined,
            trim_blocks=True,
            lstrip_blocks=True,
            keep_trailing_newline=True,
        )
        templates = {
            "pyproject.toml": "pyproject.toml",
            "README.md": "README.md",
            ".gitignore": "gitignore",
            f"{self.module}.py": f"{self.kind}.py",
            "tests/test_conformance.py": "test_conformance.py",
            "tests/test_model.py": f"test_{self.kind}.py",
            "study.toml": "study.toml",
        }
        words = {
            "plugin": self,
            "function": PROVIDED[self.kind][1],
            "is_block": self.kind in CHAIN,
            "api_version": API_VERSION,
        }
        return {path: environment.get_template(f"{name}.jinja").render(words) for path, name in templates.items()}


def write(files: Mapping[str, str], folder: Path) -> None:
    """Write a package's files into a new folder, all or nothing.

    Raises `OSError` if the disk refuses, and for a folder that holds something.
    """
    folder.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".new-", dir=folder.parent) as temporary:
        made = Path(temporary) / folder.name
        for path, text in files.items():
            file = made / path
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text, encoding="utf-8", newline="\n")
        made.rename(folder)
