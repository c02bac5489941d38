"""The gap between a model and a record: where it lies, which effect causes it, how far it shrinks."""
