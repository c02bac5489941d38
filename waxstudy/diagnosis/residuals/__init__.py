"""What a prediction misses: a class for each way to judge a channel; a segment as a problem; the noise floor."""
