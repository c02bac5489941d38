"""What the believed loop makes of the record: segments, their response, and what nobody knows of a room."""
