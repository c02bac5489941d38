"""Rooms as each other's control: which room departs from its neighbours, when, and by how much."""
