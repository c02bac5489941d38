"""Key figures of a member's week, and the run folder."""
