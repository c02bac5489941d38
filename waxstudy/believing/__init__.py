"""What is believed of a room and its loop, asked for in the words of its owner."""
