"""What a user sees of a diagnosis: ten lines on the terminal, one page, JSON and traces."""
