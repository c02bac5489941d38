"""What the documentation site adds to the pages of docs/: their order, links that work there, generated reference."""
