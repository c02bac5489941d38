"""What a gap does: to heat and air, to the loop left to itself, and when."""
