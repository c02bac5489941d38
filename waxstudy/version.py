"""The version of waxstudy, in the one place that all others ask."""

__version__ = "0.1.0"
