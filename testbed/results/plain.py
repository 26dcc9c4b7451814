"""Results as strict JSON, which has no NaN and no infinity."""

import math
from typing import Any


def plain(value: Any) -> Any:
    """JSON's own types, arrays and numpy's numbers included; NaN becomes null and an infinity the text "inf" or "-inf"."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else str(value)
    return value
