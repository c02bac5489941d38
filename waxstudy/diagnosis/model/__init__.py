"""What the believed loop makes of the record: segments, responses, logging conventions, what nobody knows."""
