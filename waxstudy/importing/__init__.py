"""Records as people have them, brought into a dataset (docs/import.md): sources, readings, channels, grid, folder."""
