# SPDX-License-Identifier: BSD-3-Clause
"""The measured data as the tables and the plots read them."""
import csv
import json
import re
import statistics

PAPER_SETTINGS = ("#1", "#2", "#3", "#4")
SETTINGS = PAPER_SETTINGS + ("fine", "finest")
RESOLUTION = {
    "#1": "20 mm / 0.2", "#2": "5 mm / 0.2", "#3": "20 mm / 0.05", "#4": "5 mm / 0.05",
    "fine": "2 mm / 0.02", "finest": "1 mm / 0.01"
}


def load(file):
    return json.loads(file.read_text()) if file.exists() else None


def table(file):
    """Columns of a CSV file by name; empty fields are None."""
    with open(file) as lines:
        rows = list(csv.DictReader(lines))
    return {name: [float(row[name]) if row[name] else None for row in rows] for name in rows[0]}


class Benchmarks:
    """Medians over the repetitions of google-benchmark, by name; and of rows that were not run, the
    reason."""

    def __init__(self, file):
        content = load(file)
        self.context = content["context"] if content else {}
        runs, self.not_run = {}, {}
        for entry in content["benchmarks"] if content else []:
            if entry["run_type"] == "iteration":
                name = entry["run_name"].removesuffix("/real_time").removesuffix("/process_time")
                if entry.get("error_occurred"):
                    self.not_run[name] = entry["error_message"]
                else:
                    runs.setdefault(name, []).append(entry)
        self.repetitions = runs
        self.runs = {
            name: {
                key: statistics.median(entry[key] for entry in entries if key in entry)
                for key, value in entries[0].items()
                if isinstance(value, (int, float))
            }
            for name, entries in runs.items()
        }

    def __bool__(self):
        return bool(self.runs)

    def get(self, name, key="real_time"):
        return self.runs.get(name, {}).get(key)

    def quartiles(self, name, key):
        """Of a counter over the repetitions: lower quartile, median, upper quartile; None where
        there is none."""
        values = [entry[key] for entry in self.repetitions.get(name, []) if key in entry]
        if not values:
            return None
        if len(values) == 1:
            return values[0], values[0], values[0]
        return tuple(statistics.quantiles(values, n=4, method="inclusive"))

    def matching(self, pattern):
        return {name: run for name, run in self.runs.items() if re.fullmatch(pattern, name)}


class TableOne:
    """Experiment C by method and resolution."""

    def __init__(self, file):
        content = load(file)
        self.rows = content["rows"] if content else []
        self.context = content["context"] if content else {}

    def __bool__(self):
        return bool(self.rows)

    def episodes(self, method, setting="", edges="nodes"):
        for row in self.rows:
            if (row["method"], row["setting"], row["edges"]) == (method, setting, edges):
                return row["episodes"]
        return []


def solved(episodes):
    return sum(e["status"] == "solved" for e in episodes)


def mean(episodes, key):
    values = [e[key] for e in episodes if key in e]
    return statistics.mean(values) if values else None


def median(episodes, key):
    values = [e[key] for e in episodes if key in e]
    return statistics.median(values) if values else None
