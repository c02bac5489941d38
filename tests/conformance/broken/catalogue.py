"""The catalogue of broken plugins, by name."""

from tests.conformance.broken.failing import FAILING
from tests.conformance.broken.misleading import MISLEADING
from tests.conformance.broken.unregistered import UNREGISTERED

USED = {**FAILING, **MISLEADING}

__all__ = ["FAILING", "MISLEADING", "UNREGISTERED", "USED"]
