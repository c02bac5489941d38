"""Every number that decides something where a record is read, with its reason.

All are chosen: from what instruments, loggers and houses do, and tried on records that were made and then spoilt. None
was derived from records of others. What is not known of a room's drives stands in `stand_ins`, light in `sunlight`.
"""

from waxstudy.dataset.channels import Quantity

# --- a file as a table
LOOKED_AT = 200  # lines in which the decimal mark and names of columns are looked for
LEAST_ROWS = 3  # of a table that blanks part, with its names: fewer lines may be a text
TOLD_BY = 10  # rows that tell that blanks part cells: a bad one below them is told with its line
TITLES = 10  # lines above the names of the columns at most
UNREADABLE_SHARE = 0.5  # of the cells of a column that are no numbers: beyond, it is another column
LARGEST = 1e12  # no channel has a number beyond; squares of those within are finite
# what loggers write where they have no value; a flow or gain may be as large as those above
CODES, CODES_ABOVE = (-99999.0, -9999.0, -999.0, -99.0, -127.0, -32768.0), (9999.0, 99999.0, 32767.0, 65535.0)

# --- stamps and their grid
YEARS = (1900, 2200)  # of stamps
LATE_S = 600.0  # by which a logger may be late when clocks change
FINER = 0.67  # of the interval: stamps nearer to each other are several to an interval
COARSER = 1.5  # of the interval: without any stamps nearer than that, the interval is not the file's
UNEVEN = 0.01  # of the rows in an interval: fewer or more by less are stamps that are not exact
TOGETHER = 0.9  # length of the mean of stamps as directions within an interval, from which they jitter around one
# of distances between stamps, those that repeat the one before within a tenth: rows come regularly, not on change
OFTEN, REPEATED = 0.5, 0.1
AROUND = 5  # intervals on either side whose rows tell how many are usual: a logger may be set to another rate
FEWEST_ROWS = 10  # from which the distance of stamps tells something
MOST_INTERVALS = 20_000_000

# --- what is recorded, and stated
FEW_SAMPLES = 10  # of a channel, up to which it is as good as not recorded
MOST_UNCERTAIN = 3.0  # logarithm of a factor of 20: nothing is known of an input that is less certain

# --- levels from 0 to 1, and signals that are on or off
NEAR_END = 0.05  # what an instrument may add to an end, or a channel of volts may lack
MOST_BETWEEN = 0.35  # share of a signal's samples that may fall upon its switches
FEW_BETWEEN, FEWEST_BETWEEN = 0.1, 3  # share of those, and count, that may be faults; more are pulses within a sample
BEYOND_END = 1e-3  # from which it is worth a word

# --- a flow that was counted in pulses
WHOLE_PULSE = 0.1  # of a pulse, by which a value may be off a whole number of them: it was rounded, or has noise
ODD_PULSES = 0.02  # of the samples with flow, those that may be odd, as means over lost rows are
MOST_PULSES = 3  # in a sample: of more the next sample makes up for the rounding
OPEN_FOR_PULSES = 0.5  # of the largest opening, from which on water flows
# of neighbouring samples with an open valve and flow, those that differ by whole pulses: what flows evenly does not
PULSES_CHANGE = 0.05
SPAN_SAMPLES = 8  # from pulse to pulse: nobody knows when in its sample a pulse came, a twentieth of so long a span
WHOLLY_OPEN = 0.95  # of a span's samples, in which the valve is open where the span has no pause
OPEN_SPANS = 30  # without a pause that tell the flow with the valve open: fewer are those that just fitted in
FEWEST_SPANS = 3  # that are judged: fewer do not tell how they scatter
# of the flow with the valve open, above which nothing is spread: means of so long spans scatter by an eighth at most
PEAK_FLOW = 1.25
NEVER_OPEN = 0.1  # of full scale, up to which a valve is closed by its record: what flows then flows all the time

# --- an opening or flow that is logged on change of value
FEWEST_CHANGES = 20  # that tell such a logger: fewer may all be large by chance
OFTEN_CHANGED = 0.5  # of the samples: what changes more often is logged as it is
FINE_CHANGE = 5.0  # times the distances of what is written, from which the least change is a band, and no rounding
WIDEST_BAND = 0.1  # of the range: nobody sets a wider one, but a valve without noise jumps so far
RARE_CHANGES = 0.02  # of the changes, those that may be smaller, as where a logger began anew

# --- how much of a record is looked at, and at which interval
MOST_DAYS = 28  # twice the two weeks in which nearly all that shows in a loop shows
FINEST_S = 5.0  # the paper's step: a controller looks every ten seconds or so, and a motor takes minutes
AS_GOOD = 0.9  # of what the best days tell: then the latest such days are taken, as they are of more use
LEAST_KNOWN = 0.5  # of the usual samples of a channel in a longer interval, for a value there

# --- a record and its baseline, and rooms beside each other
LEAST_DAYS = 3.0  # of a baseline, and of days that tell its noon: what is usual of a house is not known sooner
LONGEST_INTERVAL_S = 3600.0  # home automation keeps hourly means of what is old; a longer one hides a room's day
LEAST_SAMPLES = 24  # a day of hourly means, of what is read at the other's longer interval
LEAST_SHARED_DAYS = 3.0  # in which two rooms were measured at once: what is usual of them is not known sooner
FEWEST_VALUES = 4  # of a channel whose step tells of rounding: what is on or off has two, or three by means
FEWEST_ROUNDED = 2  # values of a temperature that tell its rounding: a room that is held well shows no more
LEAST_STEP_K, MOST_STEP_K = 0.1, 2.0  # less is lost in what a thermometer scatters, and nobody rounds to more
COARSER_STEP = 1.5  # times the finer step, from which the rounding differs
OFF_STEP = 0.1  # of a step, by which values may miss their grid: these were rounded again, as 20.56 °C of 69 °F
RISEN = 0.005  # of the strongest sun, above which it is up: a meter shows less by night
APART_H = 0.6  # between two noons: a clock is an hour off or none; nine pairs of houses differ by 0.2 h at most
DARK_H = 0.5  # around midnight: of light of which a meter shows something all night no noon can be told

# --- checks: samples that no instrument can have meant
ENOUGH = 10  # samples from which channels can be judged
# a 1-Wire thermometer (DS18B20) shows 85 °C until it has measured (data sheet); water has it only beside other readings
# from 20 K below it up to boiling
POWER_ON_C, ABOVE_K, BOILING_C = 85.0, 20.0, 100.0
NEAR_ZERO_K = 5.0  # indoors 0 °C is what a bus shows that failed, if nothing else is within so much of it
FAR_ABOVE = 10.0  # times all other flows or gains, from which a code above them is one
# what no such temperature is [C]
BOUNDS: dict[Quantity, tuple[float, float]] = {
    "indoor": (-30.0, 60.0),
    "water": (-20.0, 110.0),
    "outdoor": (-60.0, 60.0),
}
FEW_IMPOSSIBLE = 0.05  # share of impossible samples that may be faults; more of them are another quantity
SPIKES_K: dict[Quantity, float] = {"indoor": 4.0, "outdoor": 10.0, "water": 25.0}  # water may rush for a minute
# times as far as a temperature ever moves else, from which a value that it jumps to and from is none; a share of the
# samples at that value, beyond which it may be meant so
FAR_JUMP, FAILED_SHARE = 3.0, 0.2
# times what all but a few samples reach, and least: an oven may run for one sample
PEAKS: dict[Quantity, tuple[float, float]] = {"flow": (1.5, 0.0), "gain": (20.0, 5000.0)}
USUALLY = 20  # samples that reach half of what is usual
RARE, RAREST = 1e-3, 3  # samples that may be faults: share, and at least

# --- checks: temperatures that stand still or end at an extreme
STUCK_H, STUCK_COARSE_H = 6.0, 24.0  # from which a user is told
STILL_H, STILL_COARSE_H = 24.0, 48.0  # nothing that moves stands still for a day, to 0.2 K or more for two
COARSE_K = 0.2  # a resolution with which a temperature may stand still for hours
MOVING = 5  # values that a temperature takes more of if it moves
CONTINUOUS = 20  # values from which a channel may be clipped
CLIPPED_SHARE, CLIPPED_COUNT, CLIPPED_FACTOR = 0.01, 20, 5.0  # at an extreme; over those beside it

# --- checks: values of another unit
WIDEST_K = 70.0  # between 10 % and 90 % quantiles outdoors; a year in Siberia has 65
WIDE_TENTHS = 20.0  # between such quantiles of whole numbers: 2 K in tenths, but in kelvins more than a floor's water
MOST = 0.99  # share of samples between 0 and 1, from which all are: no temperature of a room stays there
DOUBTFUL, LEVEL_NOISE = 0.05, 0.15  # beyond 0 to 1: a level with noise, and none
LOWEST_LEVEL, HIGHEST_LEVEL = -0.5, 1.5  # no offset of a stroke reaches as low; another unit begins
VOLTS, PER_CENT = 10.5, 105.0  # what levels in these reach at most, with noise
USUAL_HIGH = (10.0, 100.0)  # of a level in volts and in per cent
NEVER_NEAR_0 = 5.0  # a level in volts or per cent that stays above it does not begin at 0
# gains and flows below are no noise [W, L/h]; a larger share of the samples is no fault of a few
NEGATIVE_W, NEGATIVE_SHARE = -5.0, 0.2
NEGATIVE_L_H, NEGATIVE_FLOW_SHARE = -1.0, 0.05
LOW_GAIN_W = 5.0  # a gain that never exceeds it may be in kW
BRIGHT_W_M2 = 1500.0  # light that level ground never gets, but beside bright clouds for a moment
# flow that no loop of a heated floor falls short of with its valve open, and below which it is doubtful [L/h]
LEAST_FLOW_L_H, LOW_FLOW_L_H = 5.0, 15.0
AGREES, UNUSUAL = 1.6, 4.0  # factors within which a flow agrees with the room's: in another unit, and in L/h
OPEN = 0.8  # signal or opening from which a valve is taken for open

# --- checks: channels in each other's place
SAME_K, VARIED_K = 1.0, 2.0  # mean difference of two columns that are the same one, if it varies by as much
COLD_C = 15.0  # outdoors: a floor heats, it does not cool
BELOW_K = 5.0  # by which outdoors would be warmer
EVEN = 0.35  # deviation over that outdoors, as of what is in a house
HELD, MOVED = 3, 50  # values that a setpoint has at most, and that a room has more of
WARM_C, WARMER_K = 24.0, 3.0  # what no heated room is, while its water is colder by as much
BACK_K, MOSTLY, ABOVE_ROOM_K = 0.5, 0.8, 2.0  # a return warmer than supply and room
NO_FLOW_L_H = 5.0  # the noise of a meter is taken for no flow
TWO, MANY = 2, 20  # values of a channel that is on or off, and of one that is not
SAME, ANOTHER = 0.999, 0.99  # share of samples that agree to the digit
OFF_K = 3.0  # between two thermometers of a room
APART_K, FOLLOWS = 0.2, 0.3  # deviation of sensor and air, and of what the sensor follows over that
NIGHT_H = (23, 0, 1, 2)  # in standard time
DARK_W, DARK = 2.0, 0.1  # mean at night that is no noise: least, and share of that by day

# --- checks: effects that run against their causes or come before them
# cause and effect, and the level that they cross together; a flow is taken relative to its largest.
# Just above closed: an opening and a flow that is not proportional to it begin together, and there only.
CROSSED = {
    ("control_output", "heating_signal"): 0.5,
    ("heating_signal", "displacement"): 0.5,
    ("heating_signal", "flow_L_h"): 0.5,
    ("displacement", "flow_L_h"): 0.05,
}
SETTLED_S, SETTLED_SAMPLES = 1800.0, 3  # of rest, after which a motor has moved
LOW, HIGH = 0.2, 0.8  # of what a channel reaches
FEWEST_EDGES = 3  # that tell of an offset
AGREEING = 0.7  # share of the edges that must tell of the same offset
LONGEST_OFFSET_S = 7200.0  # that is looked for
FINEST_OFFSET_S = 30.0  # two thermometers tell no less
SMOOTH_SAMPLES = 5  # over which temperatures are averaged
CLEAR = 0.8  # the squared difference of two temperatures at their best offset, over that at none
