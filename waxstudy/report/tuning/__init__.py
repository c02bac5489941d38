"""Tables, figures and pages of a tuning and of linearised loops."""
