"""What a prediction misses of each channel, in the channel's own terms."""
