"""From measurements to a model: displacement -> characteristic times -> actuator; flow -> valve curve."""
