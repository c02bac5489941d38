"""Text that a terminal or a page can be trusted with: control characters of names are shown, not obeyed."""

from __future__ import annotations

import re

# C0 and C1 controls, direction marks, separators of lines, halves of characters
CONTROL = re.compile("[\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")


def visible(text: str) -> str:
    r"""Return a text on one line: ends of lines and tabs as blanks, other control characters as Python writes them.

    >>> visible("room\n\x1b[31m7")
    'room \\x1b[31m7'
    """
    return CONTROL.sub(lambda found: " " if found[0].isspace() else ascii(found[0])[1:-1], text)


def visible_lines(text: str) -> str:
    """Return a text of several lines, each as `visible` has it."""
    return "\n".join(map(visible, text.split("\n")))
