"""The score of a blind test: the table of its goals and its page."""
