"""Fitting hypotheses to any problem: solver, start points, parameter space; it knows no channel."""
