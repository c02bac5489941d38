"""The weather: the paper's two weeks, made up again from what it published, and files that a user brings."""

from waxstudy_paper.weather.epw import Epw
from waxstudy_paper.weather.tallinn import TallinnWeek

__all__ = ["Epw", "TallinnWeek"]
