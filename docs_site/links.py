"""Links of the pages that leave docs/, as the site shows them."""

from __future__ import annotations

import posixpath
import re

LINK = re.compile(r"(?<!!)\[([^\]]*)\]\((?!\w+:)([^)#]+)(?:#[^)]*)?\)")


def without_outside_links(markdown: str, page: str) -> str:
    """Return a page with each link to a file outside docs/ as its text and the file's path in the repository.

    >>> without_outside_links("[a study](../studies/table5.toml), [sweeps](sweeps.md)", "room.md")
    'a study (`studies/table5.toml`), [sweeps](sweeps.md)'
    >>> without_outside_links("[`studies/table5.toml`](../studies/table5.toml)", "room.md")
    '`studies/table5.toml`'
    """

    def plain(link: re.Match[str]) -> str:
        text, target = link[1], link[2]
        path = posixpath.normpath(posixpath.join("docs", posixpath.dirname(page), target))
        if path.startswith("docs/"):
            return link[0]
        return text if text.strip("`") == path else f"{text} (`{path}`)"

    return LINK.sub(plain, markdown)
