"""A year of a house at a row a minute, as its software exports it: for the time and memory of an import."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

MINUTES = 365 * 1440
TEMPERATURES = {  # name: mean, swing with the valve, noise [C]
    "room": (21.0, 0.3, 0.03),
    "air": (21.0, 0.3, 0.03),
    "operative": (21.0, 0.2, 0.03),
    "floor_surface": (23.0, 1.0, 0.03),
    "supply": (25.0, 8.0, 0.05),
    "return": (22.0, 3.0, 0.05),
    "outdoor": (2.0, 0.0, 0.1),
}


def write_year(folder: Path) -> tuple[Path, Path]:
    """Write 12 channels as a wide and as a long CSV, and return both."""
    draw = np.random.default_rng(1)
    time = pd.date_range("2025-01-01", periods=MINUTES, freq="min", tz="UTC", name="last_changed")
    hour = np.arange(MINUTES) / 60.0
    on = (np.sin(hour / 2.0) > 0.3).astype(float)
    columns = {
        f"sensor.{name}_temperature": mean + swing * on + draw.normal(0.0, noise, MINUTES)
        for name, (mean, swing, noise) in TEMPERATURES.items()
    }
    columns |= {
        "sensor.setpoint": 20.0 + (hour % 24.0 > 6.0),
        "binary_sensor.heating": on,
        "sensor.flow_rate": 60.0 * on,
    }
    columns |= {"sensor.displacement": 0.9 * on, "sensor.internal_gain": 50.0 + draw.normal(0.0, 5.0, MINUTES)}
    frame = pd.DataFrame(columns, index=time.strftime("%Y-%m-%dT%H:%M:%SZ")).round(2)
    wide, long = folder / "wide.csv", folder / "long.csv"
    frame.to_csv(wide)
    frame.rename_axis(columns="entity_id").stack().rename("state").reset_index().to_csv(long, index=False)
    return wide, long
