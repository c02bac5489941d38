"""Engines of the blind test's records (fast room, other physics, a measured house), families, baselines."""
