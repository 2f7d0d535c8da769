# SPDX-License-Identifier: BSD-3-Clause
"""Numbers and tables as the documents have them."""
import math


def number(value, digits=3):
    """Three significant digits, never an exponent."""
    if value is None:
        return "–"
    if value == 0:
        return "0"
    decimals = max(0, digits - 1 - math.floor(math.log10(abs(value))))
    return (
        f"{value:,.{decimals}f}"
        if decimals
        else f"{round(value, digits - 1 - math.floor(math.log10(abs(value)))):,.0f}"
    )


def markdown(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])
