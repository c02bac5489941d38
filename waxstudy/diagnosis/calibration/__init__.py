"""A healthy record of the loop: how it was built, how well that is known, what the model leaves; rooms for studies."""
