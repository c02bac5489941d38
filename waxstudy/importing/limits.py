"""Every number that decides something in an import, with its reason.

All are chosen: from what loggers and houses do, and tried on exports that were made from one simulated record. None was
derived from records of others.
"""

# --- what follows the valve
LATER_NS = 900_000_000_000  # after a valve's signal changes, its motor has moved and the water has come
FOLLOWING = 0.5  # correlation with the valve from which a temperature is that of its water
FEWEST_TO_FOLLOW = 20  # readings

# --- rhythm: logged by the clock or on change
FEWEST_TO_TELL = 10  # readings that tell a rhythm
EVEN, REGULAR, NEARLY = 0.2, 0.8, 0.98  # of the usual distance; share of distances like it, and nearly all of them
REPEATS = 0.005  # share of readings that are as the one before: a logger that writes changes only has fewer
HELD = 1.5  # times its own distance that a regular reading is held
FINER, COARSER = 0.67, 1.5  # of the grid's interval: between them readings go to the nearest place of the grid
ON_GRID = 0.9  # share of readings that lie on the grid: they are of the intervals that end there
THRESHOLD = 0.1  # quantile of the changes that are logged, which is near their threshold
LEAST_KNOWN = 0.5  # of an interval, for its mean
AVERAGED_S = 900.0  # between readings by the clock, from which on they may be means, stamped at either end

# --- how long a value stands
HOLD_S = 6 * 3600.0  # that a value is held which is logged when it changes: a house is logged that often as a rule

# --- the dataset
FINEST_S, USUAL_S = 5.0, 60.0  # interval at least, and where nothing is logged by the clock
FOREVER_S = 100 * 366 * 86_400.0  # that a setpoint is held: nobody turns the dial, and nothing is logged
DIGITS = 4  # of values, beyond what any instrument shows
LOW_FLOW = 5.0  # a flow that never exceeds it is in no L/h

# --- files
BEGINS = 1000  # bytes that tell what a file is: a topic of MQTT may be long

# --- what a message shows: a few lines, enough to find the place
NAMED = 12  # names that are listed
LONGEST = 60  # characters of a line or name of a log

# --- numbers
NEAR_THOUSAND = 100.0  # that whole numbers reach of which larger ones may have a comma between thousands

# --- tables of readings
FEWEST_NUMBERED = 5  # rows whose numbers rise by exactly one each: fewer readings may do so by chance
MOST_ENTITIES = 2000  # a table with more is none of readings: each of them would become a column
REPEATED = 2.0  # rows to an entity, at least
AGAIN = 0.3  # share of rows whose stamp came before, above which a row is one reading: two sensors at once have 0.5
TWICE = 0.05  # share of rows in which a sensor may have a second reading at one stamp
AUTUMNS_D = 350.0  # days between two ends of summer time, at least
TOLD_TWICE = 0.9  # share of stamps that both files have where one was exported again
MIXED = 0.3  # steps of each sensor by itself, over those from row to row, below which rows of several take turns

# --- sheets that are tables
LEAST_ROWS, LEAST_COLUMNS = 3, 2  # of a sheet that is a table
TITLED = 20  # rows in which its names are looked for: protocols of a building have a few lines above them

# --- which name is which channel
# how much a name says, or values without one; a vague word, with all that adds to it, is still asked for
EXACT, CLEAR, WEAK, VAGUE, BY_VALUES = 0.95, 0.7, 0.5, 0.35, 0.35
UNIT, VALUES, ROOM = 0.15, 0.1, 0.05  # that a unit, values and a room that is asked for add to it
OTHER_WORDS = 0.15  # that a word takes from it which may name another room than that which is asked for
STRANGE = 0.25  # that values take from it which are not those of the channel
SURE = 0.7  # from here on it is not asked
LEAST_SURE = 0.4  # below, it is not proposed
ALIKE = 0.05  # two entities whose figures differ by less fit equally well
MOST_SURE = 0.99  # of a proposal: only what is stated is certain

# --- counters
RISING = 0.97  # share of changes that are rises, from which readings may be a counter's
FEWEST_RISES = 20  # that tell a usual rate
BEGUN_ANEW = 0.1  # of what a counter showed: it shows less after a reset, and has counted that since
WHOLE = 0.99  # of an interval that a counter must be known over: rounding of stamps takes the rest
JUMP, USUAL = 50.0, 0.99  # times the rate that all but a few rises stay below: no meter in a house does it

# --- what values tell
FAHRENHEIT = (50.0, 95.0)  # medians of a room in degrees Fahrenheit, none of which is one in degrees Celsius
HOTTEST_F = 110.0  # of a room
DIAL_C, ROOM_C = (10.0, 30.0), (15.0, 27.0)  # what a dial of a room is set to, and medians of a room
COLD_C = 15.0  # medians of the outdoors in a heating season are below, of water above
LEAST_HIGH = 1.0  # that a flow or gain reaches at times, in its unit; what does not may be a level
COLDEST_C, WARMEST_C = 12.0, 60.0  # of water in a floor: what is a flow in L/h is below or above at times
WARM_WATER_C, STEADY_K = 28.0, 3.0  # what water reaches and no room does; spread of a room
FRACTION = 1.5  # a level that goes no higher is a fraction; 0 to 10 V and per cent go further
LEVEL = (-0.2, 1.2)  # lowest and highest of levels: sensors overshoot their range a little
LEAST_AMOUNT = -5.0  # of flows and gains, which an offset of the sensor may bring below 0
DIALS = 20  # values that a setpoint takes at most

# --- stamps
UNSET = ("1970-01-01", "2000-01-01")  # days at which clocks begin that nobody has set yet
OUT_OF_ORDER = 0.01  # share of rows before which time goes back: more are in another order, fewer are a clock's
LOOKED_AT = 50  # stamps that tell whether a column holds stamps at all
TRIED = 2000  # stamps that tell the format of a column
SPREADSHEET_DAYS = (20_000, 80_000)  # what a spreadsheet counts from 1954 to 2119
MATLAB_DAYS = (700_000, 780_000)  # what MATLAB counts from 1916 to 2135
LONGEST_STEP_D = 0.05  # of day numbers: a bit more than an hour; what counts hours or seconds mostly has longer ones
LEAST_STEP_S = 1.0  # steps of numbers without a unit are longer if they are seconds; those of hours or days are not
FIRST_STEPS = 2.0  # longest steps from 0 at which the time of a simulation begins
FAR_DAYS = 1.0  # between the first stamp and a begin that is stated: beyond, one of them is wrong
YEAR_DAYS = 365  # chosen: of several readings of 13/01/26, one that spans more has taken days for years
MOSTLY = 0.5  # of stamps: fewer bad ones are damage, more are another format
