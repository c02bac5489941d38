"""Datasets that are made: a case runs as the reality, and instruments look at it (docs/datasets-made.md)."""
