"""A virtual test bench: records of actuators as a laboratory would make them, with the truth beside."""
