"""A fleet of loops that gets a call to switch on or off."""
