"""Fitting hypotheses to a problem, whatever it is of."""
