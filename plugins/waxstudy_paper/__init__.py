"""The components of the paper."""
