"""Paths that a command reads or writes: a misspelled one is answered with the nearest one, a dead link by its name."""

from __future__ import annotations

import os
from pathlib import Path

import click


class Existing(click.Path):
    """A file or folder that has to exist."""

    def __init__(self, *, file_okay: bool = True, dir_okay: bool = True, allow_dash: bool = False) -> None:
        super().__init__(exists=True, file_okay=file_okay, dir_okay=dir_okay, allow_dash=allow_dash, path_type=Path)

    def convert(
        self, value: str | os.PathLike[str], param: click.Parameter | None, ctx: click.Context | None
    ) -> str | bytes | os.PathLike[str]:
        try:
            return super().convert(value, param, ctx)
        except click.BadParameter as error:
            if wrong := _dead_link(Path(value)):
                raise click.BadParameter(wrong, ctx, param) from None
            if near := self._nearest(Path(value)):
                raise click.BadParameter(f"{error.message} Did you mean '{near}'?", ctx, param) from None
            raise

    def _nearest(self, path: Path) -> Path | None:
        from waxstudy.plugin.registry import nearest

        if os.path.exists(path):
            return None
        try:
            beside = [each for each in path.parent.iterdir() if (self.dir_okay if each.is_dir() else self.file_okay)]
        except OSError:  # no such folder, or not to be looked into
            return None
        # without their endings, which alone make short names alike; the same ending comes last, and wins
        by_stem = {each.stem: each for each in sorted(beside, key=lambda each: each.suffix == path.suffix)}
        return by_stem.get(nearest(path.stem, by_stem))


class Written(click.Path):
    """A file or folder to write: it need not be there, but no link on the way to it may lead nowhere."""

    def __init__(self, *, file_okay: bool = True, dir_okay: bool = True) -> None:
        super().__init__(file_okay=file_okay, dir_okay=dir_okay, path_type=Path)

    def convert(
        self, value: str | os.PathLike[str], param: click.Parameter | None, ctx: click.Context | None
    ) -> str | bytes | os.PathLike[str]:
        if wrong := _dead_link(Path(value)):
            raise click.BadParameter(wrong, ctx, param)
        return super().convert(value, param, ctx)


def _dead_link(path: Path) -> str:
    """Say which part of a path is a link that leads nowhere, "" if none is."""
    for part in (*reversed(path.parents), path):
        if os.path.islink(part) and not os.path.exists(part):
            return f"'{part}' is a link to '{os.readlink(part)}', which is not there or leads back to it."
    return ""
