"""waxstudy from Python; the command line is built on it. What is public is named in `waxstudy.__all__`."""
