"""A diagnosis whose hypotheses are weighed by what noise and form may leave, where ours asks rules."""

from __future__ import annotations

import json

from waxstudy.dataset.read import Dataset
from waxstudy.diagnosis.diagnose import diagnose as diagnosed
from waxstudy.report.formats import json_text
from waxstudy_trials.baselines import Json


def diagnose(dataset: Dataset) -> Json:
    """Return the diagnosis of a record by itself; a healthy one beside it is not read."""
    found: Json = json.loads(json_text(diagnosed(dataset, weighs=True).described()))
    return found
