"""A case as a control loop: what its week does to valve and comfort, its margins, textbook rules."""
