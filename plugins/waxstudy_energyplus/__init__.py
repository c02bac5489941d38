"""The paper's room in EnergyPlus: a second engine for the same chains, driven minute by minute through its C API."""
