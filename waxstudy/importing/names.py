"""What names say: of which channel an entity may be, and of which room."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence
from itertools import combinations
from typing import NamedTuple

# letters that are written as others; of any other with an accent that is left out
PLAIN = str.maketrans({"ä": "ae", "ö": "oe", "ü": "ue", "ß": "ss", "Ä": "Ae", "Ö": "Oe", "Ü": "Ue", "ø": "oe",
                       "Ø": "Oe", "æ": "ae", "Æ": "Ae", "ł": "l", "Ł": "L"})  # fmt: skip
DOMAINS = ("sensor", "binary_sensor", "number", "input_number", "switch", "valve", "select")
ROOMS = (
    "living", "bedroom", "kitchen", "bathroom", "bath", "office", "study", "dining", "kids", "child", "children",
    "hall", "hallway", "guest", "nursery", "lounge", "wohnzimmer", "schlafzimmer", "kueche", "bad", "buero",
    "kinderzimmer", "flur", "diele", "esszimmer", "gaestezimmer", "attic", "basement", "upstairs", "downstairs",
    "salon", "chambre", "cuisine", "toilet", "toilette", "wc", "shower", "dusche", "sauna", "utility", "laundry",
    "cellar", "keller", "corridor", "entrance", "garage", "ankleide", "arbeitszimmer", "loft",
    "woonkamer", "slaapkamer", "keuken", "badkamer", "soggiorno", "cucina", "bagno", "dormitorio", "cocina",
    "sypialnia", "kuchnia", "lazienka", "vardagsrum", "sovrum", "koek", "badrum", "stue", "sovevaerelse", "koekken",
    "olohuone", "makuuhuone", "keittioe", "kylpyhuone", "elutuba", "magamistuba", "koeoek", "vannituba",
)  # fmt: skip
NUMBERED = re.compile(r"\b(room|zone|raum|zimmer|loop|kreis) ?(\d+)\b")


class Names(NamedTuple):
    """Words of a channel: those that leave little doubt, those that others share, and those that speak against it.

    Vague words are those that other things have at least as often: they are asked for.
    """

    clear: str
    weak: str = "(?!)"
    never: str = "(?!)"
    vague: str = "(?!)"


# besides English: German, Finnish, Estonian, Dutch, French, Spanish, Italian, Polish, Swedish, Danish
OUTDOOR = (
    "outdoors?|outside|aussen|ulko\\w*|vaelis\\w*|buiten\\w*|exterieure?|exterior|externa|estern[ao]|zewnetrzn\\w*|"
    "ute|utomhus\\w*|utetemp\\w*|ude|udendoers\\w*|udetemp\\w*|udeluft\\w*|udefoeler"
)
SUPPLY = (
    "supply|vorlauf|meno\\w*|pealevool\\w*|aanvoer\\w*|depart|impulsion|temp\\w* (?:de )?ida|mandata|zasilani\\w*|"
    "framledning\\w*|tillopp\\w*|fremloeb\\w*|fremledning\\w*"
)
RETURN = (
    "return|ruecklauf|paluu\\w*|tagasivool\\w*|retour\\w*|retorno|ritorno|powrot\\w*|retur|returledning\\w*|"
    "returtemp\\w*|returloeb\\w*"
)
OTHER_AIR = (
    f"{OUTDOOR}|\\w*weather\\w*|\\w*wetter\\w*|{SUPPLY}|{RETURN}|floor surface|boden|neighbou?r|ventilation|zuluft|"
    "lattia\\w*|porand\\w*"
)
OTHERS = (
    "\\w*humid\\w*|co|co 2|\\w*power|\\w*energy|battery|\\w*illuminance|brightness|\\w*pressure|\\w*feucht\\w*|"
    "\\w*druck|\\w*kosteus|\\w*niiskus|quality|\\w*qualitaet|aqi|iaq|t?voc|pm|co2|ppm|wind|rain|\\w*leistung|\\w*energie"
)
# what is no temperature of a room, its water or the outdoors, even where a name says temperature
NEITHER = (
    "dew ?point|dew|taupunkt\\w*|frost point|feels like|apparent|wind chill|heat index|cpu|processor|chip|gateway|"
    "router|battery temp\\w*|device temp\\w*|fridge|freezer"
)
OPENINGS = (
    "\\w*blinds?|\\w*shutters?|\\w*shades?|covers?|curtains?|awnings?|\\w*rolll?ad[ae]n|\\w*jalousien?|\\w*raffstores?|"
    "\\w*markisen?|\\w*windows?|\\w*fenster|doors?|\\w*tuer(?:en)?"
)
TEMPERATURE = "\\w*temp|\\w*temperat\\w*|\\w*laempoetila"
VALVE = "valve|ventil|stellventil|actuator|stellantrieb|trv|venttiili|ventiil"
POSITION = "position|opening|stroke|hub|lift|travel|oeffnung"
SET = (
    "set ?point|setting|target|desired|desired temp\\w*|soll|sollwert|solltemperatur|sollwerttemperatur|wunsch|"
    "asetus\\w*|tavoite\\w*|seadetemp\\w*|seadevaeaertus|seatud\\w*|gewenste?|ingesteld\\w*|consigne|consigna|deseada|"
    "impostata|desiderata|zadan[ae]|boervaerde\\w*|oenskad\\w*|oensket"
)
CONTACT = "contact|contactor|kontakt|relay|relais|rele|relee|schuetz"  # through which current flows while it is closed
THROTTLE = "valve|ventil|stellventil|venttiili|ventiil|vanne|valvula|valvola|zawor|klep"
CHANNEL_NAMES = {
    "sensor_temperature_C": Names(
        "thermostat|current temperature|reading|(?:sensor|controller|room) temp\\w*|raumtemp\\w*|istwert|ist|"
        "huonelaempoetila|sisaelaempoetila|toatemp\\w*|ruumitemp\\w*|kamertemp\\w*|ruimtetemp\\w*|ambiante|ambiance|"
        "ambiente|rumtemp\\w*|rumstemp\\w*|pokojow[ae]|temp\\w* (?:w )?pomieszczeni\\w*",
        "temp|temperature|temperatur|room|raum|zimmer|indoor|inside|innen|huone|laempoetila|tuba|ruum|temperatuur",
        f"{OTHER_AIR}|{SET}|{OTHERS}|operative|globe|water|wasser",
    ),
    "air_temperature_C": Names("air|luft|lufttemp\\w*|indoor air", never=f"{OTHER_AIR}|{SET}|operative|globe|water"),
    "operative_temperature_C": Names("operative|globe|empfunden\\w*"),
    "setpoint_C": Names(SET, "sp|stpt", f"flow|{SUPPLY}|{RETURN}|{OUTDOOR}"),
    "control_output": Names(
        "output|demand|pwm|duty|stellgroesse|stellsignal|stellwert|reglerausgang|controller out\\w*|anforderung",
        "control|controller|regler|percentage",
        OPENINGS,
    ),
    "heating_signal": Names(
        "relay|actuator|heating|heat|hvac action|stellantrieb|heating signal|call|heizung|signal|"
        f"toimilaite|laemmitys|taeitur|ajam|kuete|{THROTTLE}|elettrovalvola|electrovalvula|electrovanne|silownik|"
        "verwarming|chauffage|calefaccion|riscaldamento|ogrzewanie",
        "switch|state|on|status|pump",
        f"displacement|{POSITION}|meter|energy|power|demand|{OPENINGS}",
    ),
    "displacement": Names(
        f"displacement|ventil(?:hub|oeffnung|stellung|position)|(?:{VALVE})(?: \\w+)* (?:{POSITION})|"
        f"(?:{POSITION})(?: \\w+)* (?:{VALVE})",
        "valve|ventil",
        f"{OPENINGS}|{TEMPERATURE}",
        POSITION,
    ),
    "flow_L_h": Names(
        "flow|flow rate|flowrate|durchfluss|volumenstrom|volume flow|litres|liters|liter|volume|water meter|volumen|"
        "virtaus|virtaama|vooluhulk|debiet|debit|caudal|portata|przeplyw\\w*|floede\\w*",
        "meter|total|zaehler|v|water|wasser|pulses",
        "temp|temperature|temperatur|vorlauf|flow t",
    ),
    "supply_temperature_C": Names(
        f"{SUPPLY}|vl|hws|flow t|flow temp\\w*|inlet|forward|feed|vorlauftemp\\w*",
        "water|flow|wasser|heizkreis",
        f"air|ventilation|zuluft|{RETURN}|\\w*ilma|\\w*ohk|{SET}",
    ),
    "return_temperature_C": Names(
        f"{RETURN}|rl|hwr|outlet|ruecklauftemp\\w*", "water|wasser",
        f"air|abluft|\\w*ilma|\\w*ohk|{SET}",
    ),
    "outdoor_temperature_C": Names(
        f"{OUTDOOR}|ambient|amb|aussentemp\\w*|aussenluft(?:temp\\w*)?|oat|external",
        "\\w*weather\\w*|\\w*wetter\\w*|garden"
    ),
    "solar_gain_W": Names("solar gains?|sun gains?"),
    "internal_gain_W": Names("internal gains?|people|appliances|innere lasten"),
    "floor_surface_temperature_C": Names(
        "floor surface|floor temp\\w*|boden\\w*|fussboden\\w*|screed|estrich|lattia\\w*|porand\\w*", "floor", "air"
    ),
    "ventilation_supply_temperature_C": Names("ventilation|supply air|zuluft|hrv|mvhr|vent"),
    "global_irradiance_W_m2": Names(
        "ghi|global irradiance|(?:global|solar) radiation|solar irradiance|globalstrahlung", "irradiance|pyranometer",
        "diffuse|dhi|dni|direct|illuminance|lux",
    ),
    "diffuse_irradiance_W_m2": Names("dhi|diffuse irradiance|diffuse radiation|diffusstrahlung"),
    "photovoltaic_power_W": Names(
        "pv power|photovoltaic\\w*|photovoltaik\\w*|solar power|pv production|solar production|inverter power|pv",
        "solar|inverter|wechselrichter", "voltage|current|temp|temperature|frequency|forecast|irradiance|radiation",
    ),
    "neighbour_temperature_C": Names("neighbou?r|adjacent|nachbar\\w*|other flat"),
}  # fmt: skip


def plain(entity: str) -> str:
    """Return a name as lower words between blanks, without the domain in front of it.

    >>> plain("sensor.livingRoom_temp-2"), plain("Außentemperatur"), plain("valve")
    (' living room temp 2 ', ' aussentemperatur ', ' valve ')
    """
    domain, _, rest = entity.partition(".")
    name = rest if rest and domain in DOMAINS else entity
    name = unicodedata.normalize("NFKD", unicodedata.normalize("NFC", name).translate(PLAIN))
    name = "".join(letter for letter in name if not unicodedata.combining(letter))
    name = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name)
    return f" {' '.join(re.findall(r'[a-z]+|[0-9]+', name.lower()))} "


def says_no(name: str, channel: str, has_degrees: bool) -> bool:
    """Whether a name says that an entity is not of a channel, as humidity is no temperature, unless it has degrees."""
    is_warm = has_degrees or says(name, TEMPERATURE)
    is_other = says(name, NEITHER) or (says(name, f"{OTHERS}|{OPENINGS}|{POSITION}") and not is_warm)
    return says(name, CHANNEL_NAMES[channel].never) or (channel.endswith("_C") and is_other)


def is_contact(entity: str) -> bool:
    """Whether what is open or shut is a contact, and none that a valve tells its opening by."""
    return says(plain(entity), CONTACT) and not says(plain(entity), f"{THROTTLE}|{OPENINGS}")


def says(name: str, words: str) -> bool:
    return re.search(rf" (?:{words}) ", name) is not None


def rooms_of(entities: Sequence[str]) -> dict[str, str]:
    """Return the room of each entity that tells one: by common words, numbers, or as names differ in one word twice."""
    found = {entity: room for entity in entities if (room := _room(plain(entity)))}
    return found or _differing(entities)


def _room(name: str) -> str:
    if told := NUMBERED.search(name):
        return f"{told[1]} {told[2]}"
    found = (re.search(rf" ({room})( \d+)? ", name) for room in ROOMS)
    return next((told[1] + (told[2] or "") for told in found if told), "")


def _differing(entities: Sequence[str]) -> dict[str, str]:
    """Return rooms from names that are alike but for one word, where the same two words do so of several entities."""
    words = {entity: tuple(plain(entity).split()) for entity in entities}
    pairs: dict[frozenset[str], set[str]] = {}
    for one, other in combinations(words, 2):
        if len(words[one]) == len(words[other]):
            differ = [(a, b) for a, b in zip(words[one], words[other], strict=True) if a != b]
            if len(differ) == 1 and not any(_is_of_channel(word) for word in differ[0]):
                pairs.setdefault(frozenset(differ[0]), set()).update((one, other))
    rooms = {word for pair, alike in pairs.items() if len(alike) > 2 for word in pair}
    return {entity: room for entity in entities if (room := next((w for w in words[entity] if w in rooms), ""))}


def _is_of_channel(word: str) -> bool:
    return word.isdigit() or any(says(f" {word} ", f"{names.clear}|{names.weak}") for names in CHANNEL_NAMES.values())


def is_of_room(entity: str, room: str) -> bool:
    """Whether a name is that of a room.

    >>> is_of_room("Room 1 valve", "room 1"), is_of_room("Room 10 valve", "room 1"), is_of_room("bedroom 2", "bedroom")
    (True, False, False)
    """
    told = plain(room).strip()
    return re.search(rf"(?<!\d){re.escape(told)}(?!\d)(?! \d)", plain(entity)) is not None


def has_other_words(entity: str) -> bool:
    """Whether a name has a word that is none of a channel's, and may be of another room."""
    return not all(_is_of_channel(word) for word in plain(entity).split())
