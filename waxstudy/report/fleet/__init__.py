"""Tables, figures and page of an activation."""
