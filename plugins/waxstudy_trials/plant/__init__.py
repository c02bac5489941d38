"""A plant with equations of its own, at steps of a second: what a diagnosis meets that was made for another room."""
