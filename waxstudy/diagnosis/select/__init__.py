"""Which effects a record shows, and what it cannot show."""
