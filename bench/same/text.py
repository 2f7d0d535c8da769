# SPDX-License-Identifier: BSD-3-Clause
"""Writes problem files: one line for each key, one for each element of a list of maps, so that
messages name a line that means something."""
import json


def yaml(problem):
    """The problem, a dict, as text in YAML."""
    lines = []
    for key, value in problem.items():
        if isinstance(value, list) and value and all(isinstance(x, dict) for x in value):
            lines.append(f"{key}:")
            lines += [f"  - {json.dumps(element)}" for element in value]
        else:
            lines.append(f"{key}: {json.dumps(value)}")
    return "\n".join(lines) + "\n"


def csv(columns, rows):
    """A table as text, numbers with as many digits as they need."""
    return "\n".join([",".join(columns), *(",".join(map(repr, row)) for row in rows)]) + "\n"
