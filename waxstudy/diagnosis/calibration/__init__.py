"""A healthy record of the loop: how it was built, and what the model leaves of it all the same."""
