"""What a user sees of a diagnosis: a few lines on the terminal, one page, JSON and traces."""
