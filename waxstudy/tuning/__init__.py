"""Parameters of a case found by search, and tested on weather that took no part."""
