"""Reports of fits to measurements: tables, figures, pages."""
