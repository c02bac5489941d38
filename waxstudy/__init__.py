"""waxstudy: how much modelling detail does a heating control loop need?"""

__version__ = "0.1.0"
