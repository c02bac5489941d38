"""The conformance kit: does a component keep the contract of its kind?

A package's own test needs two lines:

    def test_the_motor_keeps_the_contract():
        assert_conforms(WaxMotor)
"""

from waxstudy.conformance.kit import Outcome, assert_conforms, check

__all__ = ["Outcome", "assert_conforms", "check"]
