"""A seeded attack that anyone can repeat: `make attack`."""
