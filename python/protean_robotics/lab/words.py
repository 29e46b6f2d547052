"""Text of numbers on the pages."""

import math
from collections.abc import Sequence

from .statistics import Interval


def decimals(value: float, digits: int) -> str:
    """Number with these digits after the point and a true minus."""
    text = f"{value:.{digits}f}"
    if not text.startswith("-"):
        return text
    is_zero = not text.strip("-0.")
    return text[1:] if is_zero else f"−{text[1:]}"


def share(value: float) -> str:
    """Share: ``63.5 %``."""
    return f"{decimals(100.0 * value, 1)} %"


def shares(interval: Interval) -> str:
    """Interval of shares: ``58.1 … 67.6 %``."""
    return f"{decimals(100.0 * interval.low, 1)} … {decimals(100.0 * interval.high, 1)} %"


def percent(value: float, interval: Interval) -> str:
    """Share with its interval in whole percents: ``64 % (58 … 69)``."""
    return f"{100.0 * value:.0f} % ({100.0 * interval.low:.0f} … {100.0 * interval.high:.0f})"


def points(value: float) -> str:
    """Difference of shares in points: ``+12.5``."""
    text = decimals(100.0 * value, 1)
    return text if text.startswith("−") or text == "0.0" else f"+{text}"


def point_range(interval: Interval) -> str:
    """Interval of differences: ``+3.1 … +21.4``."""
    return f"{points(interval.low)} … {points(interval.high)}"


def p_value(p: float) -> str:
    """Probability of a test: ``p = 0.023``, ``p < 0.0001``."""
    if p < 0.0001:
        return "p < 0.0001"
    return f"p = {p:.4f}" if p < 0.01 else f"p = {p:.2f}"


def ratio(value: float) -> str:
    """Speed relative to the Police: ``1.5×``."""
    text = f"{value:.3f}".rstrip("0")
    return f"{text}0×" if text.endswith(".") else f"{text}×"


def ratio_range(interval: Interval) -> str:
    """Interval of speeds, which may be open: ``1.5× … 2.0×``, ``above 1.2×``."""
    low, high = interval
    if math.isfinite(low) and math.isfinite(high):
        return f"{ratio(low)} … {ratio(high)}"
    if math.isfinite(low):
        return f"above {ratio(low)}"
    return f"below {ratio(high)}" if math.isfinite(high) else "open"


def ratios(values: Sequence[float]) -> str:
    """Several speeds: ``1.5×, 2.0× and 3.0×``."""
    *others, last = map(ratio, values) if values else [""]
    return f"{', '.join(others)} and {last}" if others else last


def in_table(text: str) -> str:
    """Text in a cell of a table."""
    return text.replace("\\", "\\\\").replace("|", "\\|").replace("\n", " ").replace("\r", " ")


def provenance(experiment: str, seeds: str, program: str) -> str:
    """Line with the experiment, seeds and program of results."""
    return f"- `{experiment}`: seeds {seeds}, Protean {program}\n"
