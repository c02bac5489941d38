"""Every number that decides what is told of rooms beside each other, with its reason.

All are chosen, unless it is said on what they were set. How a search is done, and on which grid, stands where it is.
"""

# --- the grid
STEP_S = 1800.0  # long enough for a room's air, short enough for a window that is open for an hour
LEAST_KNOWN = 0.5  # of the samples of a step, for its mean to count
SUNNY = 0.05  # of the strongest sun: beyond, it is day
DAYTIME_H = (8.0, 18.0)  # where no sun was recorded

# --- a room's own unrest
ORDER = 4  # steps that an error remembers: enough for a thermostat that swings, and a slow store beside it
HUBER = 2.0  # standard deviations from which an innovation counts by less
FLOOR_K = 0.01  # least innovation that is believed of an instrument
FEWEST_STEPS = 30  # steps of a regime, to have a spread of its own

# --- what a room does by its neighbours
HARMONICS = 3  # of a room's ordinary day: waking and sleeping, and cooking in between
BUSY = 0.2  # of the largest change of own heat: beyond, the room is in use

# --- spans in which a room may depart
DAILY_MOST_H = 14.0  # of what may come back on other days
LEAST_DAYS = 3  # on which hours come back, to be a pattern rather than single spans
UNREST_MOST_H = 12.0  # longer spans are too few to tell: they have the unrest of these
USUAL = 0.8  # share of the spans that are taken for a room's own unrest
FEWEST_SPANS = 10  # spans from which a room's unrest is known
LEAST_SEEN = 0.1  # of a shape's weight that the regressors must leave, for it to be seen at all

# --- which departures are found
NOTICEABLE_K = 0.5  # the mean over its hours from which a departure is told; thermometers of a room differ so
SHORT_H = 30.0  # a day or a night, and what is left of it
SURE_ODDS = 20.0  # odds for a departure, beyond the price of looking for it
MOST_PATTERNS = 12  # patterns of one room: beyond, the room does not follow its neighbours
LEVEL = 0.4  # of a departure, to be seen in the room's level as well
NEAR_H = 1.5  # of an edge: as near, two patterns may share it

# --- what is told of a departure
AFTER_H = 1.5  # beside a departure: what a thermostat makes of it then is part of it
MAIN = 0.35  # of a happening's largest part: hours with less are its echo
KNOWN = 3.0  # standard deviations from which a room's answer to its own heat is known
START_H = 1.0  # in which the first warming tells heat, where a capacity is assumed
# what answers of a few time constants miss of a departure, set on 30 made records: in kelvins, and of its size
FORM_K, FORM_SHARE = 0.12, 0.06
ALIKE = 1e-3  # weight of other ends, to count

# --- what is told of several rooms
LIKELY = 0.9  # a departure is told; the search, and what was found after, may have changed it
TOGETHER = 0.5  # hours of both over hours of either: it happens in both rooms
OF_HOUSE = 0.5  # of the rooms: beyond, it is the house
STANDARD_H = 3.0  # of own heat, in which its effect is told

# --- what a departure may be, and its days
AT_ONCE_H = 1.0  # from its beginning, in which air departs, and structure does not
QUICK = 0.5  # of the largest departure, in that hour: air, not structure
FAST_K = 1.0  # in that hour: floor and walls keep a room without heating from it (0.4 K/h in light rooms)
STEP = 0.7  # of the departure, from one sample to the next at both ends: no room is so quick
MOST_HOURS = 0.5  # of the hours of a departure, in which its own heat runs above its mean to be told
BRIGHT = 0.5  # of the hours, from which sun may do it as well
MOST_DAYS = 8  # that are named one by one
MOST_WEEKDAYS = 2  # of the week: a longer list of weekdays says less than dates do
REGULAR = 4  # times that days come back, to be told by their rule: three may be chance
