"""Blocks for other programs: what runs here, as a file that needs no waxstudy."""
