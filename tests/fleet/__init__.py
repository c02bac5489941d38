"""Claims about fleets of loops."""
