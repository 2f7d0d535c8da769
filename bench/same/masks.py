# SPDX-License-Identifier: BSD-3-Clause
"""Takes out of what the program prints and writes what differs from run to run: how long work took,
and where the program and its files lie."""
import base64
import csv
import hashlib
import io
import json
import re
import zlib

NUMBER = r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?"
# The line that says how long each stage took begins with the planner and its threads.
WORK = re.compile(r"^((?:eager|eager_dp|lazy|parallel), \d+ threads?: .*)$", re.MULTILINE)
MILLISECONDS = re.compile(NUMBER + r" ms\b")
MEDIAN = re.compile(rf"plan {NUMBER} ms in the median \(5 % below {NUMBER}, 5 % above {NUMBER}\)")
PACE = re.compile(rf"{NUMBER} s, {NUMBER} a second")
TIMES_MS = re.compile(r'"(time_ms|plan_ms)": *\{(?:[^{}]|\{[^{}]*\})*\}')
DATA = re.compile(r'(<script id="data" type="application/zlib">)([^<]*)(</script>)')


def printed(text, places):
    """What was printed, without times. `places` are pairs of a path and the word in its place."""
    for place, word in places:
        text = text.replace(place, word)
    text = WORK.sub(lambda line: MILLISECONDS.sub("# ms", line[1]), text)
    text = MEDIAN.sub("plan # ms in the median (5 % below #, 5 % above #)", text)
    return TIMES_MS.sub(r'"\1": {}', PACE.sub("# s, # a second", text))


def table(text):
    """A table of a campaign without the times of its plans."""
    lines = text.splitlines(keepends=True)
    head = next((k for k, line in enumerate(lines) if not line.startswith("#")), None)
    if head is None or "plan_ms" not in lines[head].split(","):
        return text
    column = lines[head].rstrip("\n").split(",").index("plan_ms")
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    for row in csv.reader(lines[head + 1 :]):
        row[column] = "" if not row[column] else "#"
        writer.writerow(row)
    return "".join(lines[: head + 1]) + out.getvalue()


def without_times(value):
    """The value without members that are times of work."""
    if isinstance(value, dict):
        return {
            key: without_times(member)
            for key, member in value.items()
            if key not in ("time_ms", "plan_ms")
        }
    if isinstance(value, list):
        return [without_times(element) for element in value]
    return value


def digest(content):
    """What stands for bytes that nobody reads."""
    return hashlib.sha256(content).hexdigest()


def page(text, places):
    """A page of --report: its data without times, one value a line, and hashes of all else."""
    found = DATA.search(text)
    if not found:
        return printed(text, places)
    # A text of JSON, a byte 0, and the binary values of which the text has the places.
    data, _, binary = zlib.decompress(base64.b64decode(found[2])).partition(b"\0")
    shown = json.dumps(without_times(json.loads(data)), indent=0)
    rest = text[: found.start()] + text[found.end() :]
    return (
        f"{printed(shown, places)}\nbinary values: {digest(binary)}\n"
        f"all else: {digest(printed(rest, places).encode('utf-8', 'surrogateescape'))}\n"
    )


def file(name, content, places):
    """The content, bytes, of a file that the program wrote under this name."""
    if name.endswith(".mcap"):
        return content
    text = content.decode("utf-8", "surrogateescape")
    if name.endswith(".html"):
        text = page(text, places)
    elif name.endswith((".csv", ".part")):
        text = table(text)
    else:
        text = printed(text, places)
    return text.encode("utf-8", "surrogateescape")
