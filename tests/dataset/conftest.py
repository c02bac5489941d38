"""The records that are read are those that tests/synthetic makes."""

from tests.synthetic.conftest import folder, simulated, study

__all__ = ["folder", "simulated", "study"]
