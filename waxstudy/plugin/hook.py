"""The one hook: `waxstudy_register(register)`."""

from __future__ import annotations

from collections.abc import Callable

import pluggy

from waxstudy.plugin.contracts import Component

GROUP = "waxstudy"

hookspec = pluggy.HookspecMarker(GROUP)
hookimpl = pluggy.HookimplMarker(GROUP)


class Hooks:
    """The hook specification."""

    @hookspec
    def waxstudy_register(self, register: Callable[[type[Component]], None]) -> None:
        """Call `register` once for each component class that the plugin offers."""
