"""What was measured, how well, and what stands in for drives that nobody recorded."""
