"""Which effects a record shows, and what it cannot show: evidence, search, the null, intervals, what stays."""
