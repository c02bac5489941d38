"""One study at many values of its parameters."""
