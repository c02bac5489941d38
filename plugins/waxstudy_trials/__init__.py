"""Engines that records of the blind test come from: the fast room, plants of other physics, a measured house."""
