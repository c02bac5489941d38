"""Tables (table.py), figures and pages of a run, and how it agrees with published figures or another run."""
