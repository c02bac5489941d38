"""Pages on which traces zoom, by plotly: of a run and of a diagnosis."""
