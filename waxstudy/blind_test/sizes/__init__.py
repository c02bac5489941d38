"""The blind test's own yardstick: how large a true gap is, and which effects nobody could tell from its cause.

It shares no code with the diagnosis that it is to judge: whoever changes the one leaves the other as it is.
"""
