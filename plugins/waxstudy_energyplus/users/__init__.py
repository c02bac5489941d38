"""A model that a user has made in EnergyPlus, as the room of a study."""
