"""The blind test: records whose effect is withheld, any diagnoser let loose on them, and its score."""
