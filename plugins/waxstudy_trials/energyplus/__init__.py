"""A room in EnergyPlus with a chain of its own: other physics than the library's, and PI control with pulses."""
