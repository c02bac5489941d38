"""Blocks and loop, compiled or interpreted; modal form of the room; ensemble; setpoint shift; the run."""
