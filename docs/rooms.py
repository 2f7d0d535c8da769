#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Rooms of the source tree, and the includes between them: every folder that holds sources is a
room of its component.

rooms.py [--check] [--svg FILE [--open COMPONENT ...]] [--moved TABLE]

Prints the rooms, the arrows between them (who includes whom), and what is wrong: arrows that
docs/rooms.txt does not allow, circles, rooms with more than 20 files. --check: exit code 1 where
anything is. --svg: draws the picture; of the components --open names, pairs of files are drawn, not
rooms. --moved: as if files had been moved already, by lines of an old and a new path with a tab
between.
"""
import argparse
import collections
import fnmatch
import html
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
MOST_FILES = 20
ENDINGS = {".hpp", ".cpp", ".inl"}
INCLUDE = re.compile(r'^\s*#\s*include\s*["<]([^">]+)[">]', re.MULTILINE)


class Order:
    """docs/rooms.txt: the floor of each room of each component, and the components that each may
    include."""

    def __init__(self, file):
        self.floor, self.uses = {}, {}
        component = None
        for line in file.read_text().splitlines():
            line = line.split("#")[0].rstrip()
            if not line:
                continue
            if line[0] != " ":
                component, _, uses = line.partition(":")
                self.uses[component] = uses.split()
                floor = 0
            else:
                for room in line.split():
                    self.floor[component, room] = floor
                floor += 1

    def allows(self, tail, head):
        if tail[0] != head[0]:
            return head[0] in self.uses.get(tail[0], [])
        return tail == head or (
            tail in self.floor and head in self.floor and self.floor[head] < self.floor[tail]
        )


def moved_paths(table, files):
    """Where a table of moves puts each of these files. A line may name many files by a pattern; the
    first that fits counts."""
    lines = [
        line.split("\t")[:2]
        for line in table.read_text().splitlines()
        if "\t" in line and line[0] != "#"
    ]
    result = {}
    for file in files:
        for old, new in lines:
            if file == old or (
                "*" in old and fnmatch.fnmatchcase(file, old) and file.count("/") == old.count("/")
            ):
                result[file] = new if not new.endswith("/") else new + file.rsplit("/", 1)[1]
                break
    return result


class Tree:
    """Files of the components, the room of each, and which file includes which."""

    def __init__(self, components, table=None):
        names = [
            str(path.relative_to(ROOT))
            for component in components
            for path in sorted((ROOT / component).rglob("*"))
            if path.suffix in ENDINGS and "build" not in path.parts
        ]
        moved = moved_paths(table, names) if table else {}
        self.path = {name: moved.get(name, name) for name in names}
        self.includes = {}
        for name in names:
            text = (ROOT / name).read_text()
            found = (self.resolve(name, include) for include in INCLUDE.findall(text))
            self.includes[name] = sorted({one for one in found if one and one != name})

    def resolve(self, name, include):
        component = name.split("/")[0]
        if include.startswith("swivel/"):
            of = include.split("/")[1]
            tried = [f"{of}/{part}include/{include}" for part in ("", "boost/", "core/")]
        else:
            folder = name.rsplit("/", 1)[0]
            tried = [f"{at}/{include}" for at in (folder, f"{component}/src", component)]
        return next((one for one in tried if one in self.path), None)

    def room(self, name):
        parts = self.path[name].split("/")
        component, folders = parts[0], parts[1:-1]
        if folders[:1] in (["boost"], ["core"]):
            folders = folders[1:]
        if folders[:1] == ["src"]:
            folders = folders[1:]
        elif folders[:2] == ["include", "swivel"]:
            folders = folders[3:]
        return component, "/".join(folders) or "."

    def arrows(self, of):
        """{(tail, head): [(file, file included), ...]} between groups of files that differ."""
        found = collections.defaultdict(list)
        for name, included in self.includes.items():
            for other in included:
                if of(name) != of(other):
                    found[of(name), of(other)].append((name, other))
        return found


def circles(arrows):
    """Groups of rooms that reach each other, of two or more (Tarjan)."""
    next_of = collections.defaultdict(list)
    for tail, head in arrows:
        next_of[tail].append(head)
    number, low, stack, result = {}, {}, [], []

    def visit(node):
        number[node] = low[node] = len(number)
        stack.append(node)
        for other in next_of[node]:
            if other not in number:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in stack:
                low[node] = min(low[node], number[other])
        if low[node] == number[node]:
            group = stack[stack.index(node) :]
            del stack[stack.index(node) :]
            if len(group) > 1:
                result.append(sorted(group))

    for node in list(next_of):
        if node not in number:
            visit(node)
    return result


def without_implied(arrows):
    """Those between groups that no longer way stands for."""
    next_of = collections.defaultdict(set)
    for tail, head in arrows:
        next_of[tail].add(head)
    reached = {}

    def reach(node, path=()):
        if node not in reached:
            reached[node] = set()
            for other in next_of[node]:
                if other not in path:
                    reached[node] |= {other} | reach(other, path + (node,))
        return reached[node]

    kept = []
    for tail, head in arrows:
        if not any(head in reach(other) for other in next_of[tail] if other not in (head, tail)):
            kept.append((tail, head))
    return kept


def text_of(name):
    return name[0] if name[1] == "." else f"{name[0]}/{name[1]}"


# ---- the picture

CHAR, BOX_HEIGHT, FLOOR_GAP, GAP, PAD = 7.2, 40, 44, 18, 26


class Panel:
    """One component: rooms on floors, arrows between them that lead down, drawn around the rooms
    that they pass."""

    def __init__(self, title, boxes, floors, arrows, wrong):
        self.title, self.boxes, self.arrows, self.wrong = title, boxes, arrows, wrong
        rows = [[] for _ in range(max(floors.values()) + 1)]
        for box in boxes:
            rows[floors[box]].append(box)
        self.rows = rows = [row for row in rows if row]
        floor = {box: k for k, row in enumerate(rows) for box in row}
        self.routes = []
        for tail, head in arrows:
            if floor[tail] <= floor[head]:
                self.routes.append([tail, head])
                continue
            route = [tail]
            for k in range(floor[tail] - 1, floor[head], -1):
                passed = (tail, head, k)  # a place that the arrow passes on this floor
                rows[k].append(passed)
                route.append(passed)
            self.routes.append(route + [head])
        self.order()
        self.place()

    def width_of(self, item):
        if item not in self.boxes:
            return 6
        return max(80, CHAR * max(map(len, self.boxes[item][0])) + 20)

    def order(self):
        beside = collections.defaultdict(list)
        for route in self.routes:
            for one, other in zip(route, route[1:]):
                beside[one].append(other)
                beside[other].append(one)
        place = {item: k for row in self.rows for k, item in enumerate(row)}
        for turn in range(24):
            for row in self.rows if turn % 2 else self.rows[::-1]:
                mean = {
                    item: sum(place[o] for o in beside[item]) / len(beside[item])
                    if beside[item]
                    else place[item]
                    for item in row
                }
                row.sort(key=lambda item: mean[item])
                total = sum(self.width_of(item) + GAP for item in row)
                x = -total / 2
                for item in row:
                    place[item] = x + self.width_of(item) / 2
                    x += self.width_of(item) + GAP

    def place(self):
        widths = [sum(map(self.width_of, row)) + GAP * (len(row) - 1) for row in self.rows]
        self.width = max(widths + [CHAR * len(self.title) + 20]) + 2 * PAD
        self.height = len(self.rows) * (BOX_HEIGHT + FLOOR_GAP) - FLOOR_GAP + 2 * PAD + 24
        self.at = {}
        for k, row in enumerate(self.rows):
            spare = (self.width - 2 * PAD - widths[k]) / (len(row) + 1)
            x = PAD + spare
            for item in row:
                self.at[item] = (x, self.height - PAD - BOX_HEIGHT - k * (BOX_HEIGHT + FLOOR_GAP))
                x += self.width_of(item) + GAP + spare

    def svg(self, left, top):
        out = [
            f'<g transform="translate({left:.0f} {top:.0f})">',
            f'<rect class="panel" width="{self.width:.0f}" height="{self.height:.0f}" rx="8"/>',
            f'<text class="title" x="{PAD}" y="24">{html.escape(self.title)}</text>',
        ]
        ports = collections.defaultdict(list)
        for route in self.routes:
            ports[route[0], "out"].append(route)
            ports[route[-1], "in"].append(route)
        for (item, side), routes in ports.items():
            routes.sort(key=lambda route: self.at[route[1 if side == "out" else -2]][0])
        for route in self.routes:
            wrong = (route[0], route[-1]) in self.wrong
            points = []
            for item in route:
                x, y = self.at[item]
                width = self.width_of(item)
                if item == route[0] or item == route[-1]:
                    side = "out" if item == route[0] else "in"
                    routes = ports[item, side]
                    x += width * (routes.index(route) + 1) / (len(routes) + 1)
                    points.append((x, y + (BOX_HEIGHT if side == "out" else 0)))
                else:
                    points += [(x + width / 2, y), (x + width / 2, y + BOX_HEIGHT)]
            path = f"M{points[0][0]:.0f} {points[0][1]:.0f}"
            for (x0, y0), (x1, y1) in zip(points, points[1:]):
                bend = (y1 - y0) / 2
                path += f" C{x0:.0f} {y0 + bend:.0f} {x1:.0f} {y1 - bend:.0f} {x1:.0f} {y1:.0f}"
            out.append(
                f'<path class="{"wrong" if wrong else "arrow"}" '
                f'marker-end="url(#{"red" if wrong else "grey"})" d="{path}"/>'
            )
        for box, (lines, bad) in self.boxes.items():
            x, y = self.at[box]
            width = self.width_of(box)
            out.append(
                f'<rect class="{"bad" if bad else "box"}" x="{x:.0f}" y="{y:.0f}" '
                f'width="{width:.0f}" height="{BOX_HEIGHT}" rx="4"/>'
            )
            for k, line in enumerate(lines):
                out.append(
                    f'<text class="{"name" if k == 0 else "count"}" x="{x + width / 2:.0f}" '
                    f'y="{y + 17 + 15 * k:.0f}">{html.escape(line)}</text>'
                )
        return out + ["</g>"]


def floors_of(boxes, arrows):
    """By the longest way down; arrows that close a circle do not count."""
    next_of = collections.defaultdict(list)
    for tail, head in arrows:
        next_of[tail].append(head)
    floor = {}

    def visit(box, path=()):
        if box not in floor:
            below = [
                visit(other, path + (box,)) for other in next_of[box] if other not in path + (box,)
            ]
            floor[box] = 1 + max(below, default=-1)
        return floor[box]

    for box in boxes:
        visit(box)
    return floor


def draw(tree, order, opened):
    rooms = collections.Counter(map(tree.room, tree.path))
    arrows = tree.arrows(tree.room)
    panels = {}
    for component in order.uses:
        if component in opened:

            def pair(name):
                parts = tree.path[name].rsplit("/", 1)
                return tree.room(name)[0], parts[1].split(".")[0]

            boxes = {}
            for name in tree.path:
                if tree.room(name)[0] == component:
                    boxes[pair(name)] = ([pair(name)[1], ""], False)
            inner = [
                pair_ for pair_ in tree.arrows(pair) if pair_[0][0] == pair_[1][0] == component
            ]
            floors = floors_of(boxes, inner)
            title = (
                f"{component}: "
                f"{sum(count for room, count in rooms.items() if room[0] == component)} files, "
                "drawn by pairs of .hpp and .cpp"
            )
            rising = [one for one in inner if floors[one[0]] <= floors[one[1]]]
        else:
            boxes = {
                room: (
                    [room[1] if room[1] != "." else component, f"{count} files"],
                    count > MOST_FILES,
                )
                for room, count in rooms.items()
                if room[0] == component
            }
            inner = [one for one in arrows if one[0][0] == one[1][0] == component]
            rising = [one for one in inner if not order.allows(*one)]
            natural = floors_of(boxes, [one for one in inner if one not in rising])
            floors = {box: order.floor.get(box, natural[box]) for box in boxes}
            title = component + (
                f": {sum(rooms[box] for box in boxes)} files" if len(boxes) > 1 else ""
            )
        if order.uses[component]:
            title += f"   (includes {', '.join(order.uses[component])})"
        kept = set(without_implied(inner)) | set(rising)
        panels[component] = Panel(title, boxes, floors, sorted(kept), set(rising))
    # Components stand on those that they include.
    level = {}
    for component in panels:
        level[component] = 1 + max(
            (level.get(other, -1) for other in order.uses[component]), default=-1
        )
    rows = [[panels[c] for c in panels if level[c] == k] for k in range(max(level.values()) + 1)]
    width = max([1150] + [sum(p.width for p in row) + 20 * (len(row) - 1) + 40 for row in rows])
    out, y = [], 60
    for row in rows[::-1]:
        x = (width - sum(p.width for p in row) - 20 * (len(row) - 1)) / 2
        height = max(p.height for p in row)
        for panel in row:
            out += panel.svg(x, y + height - panel.height)
            x += panel.width + 20
        y += height + 20
    files = sum(rooms.values())
    head = (
        f"Rooms of Swivel: {files} files, {len(rooms)} rooms. An arrow: includes. Arrows that "
        f"others imply are left out; red: not allowed, or more than {MOST_FILES} files."
    )
    style = (
        "<style>text { font: 12px sans-serif; fill: #222 } .title { font-weight: bold; font-size: "
        "14px } .name, .count { text-anchor: middle }\n"
        ".name { font-weight: bold } .count { fill: #666 } .panel { fill: #f6f6f2; stroke: #bbb } "
        ".box { fill: #fff; stroke: #555 }\n"
        ".bad { fill: #fbd5d0; stroke: #b3261e; stroke-width: 2 } "
        "path.arrow { fill: none; stroke: #6b7785; stroke-width: 1.2 }\n"
        "path.wrong { fill: none; stroke: #b3261e; stroke-width: 1.8 }</style>"
    )
    markers = "".join(
        f'<marker id="{name}" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="7" markerHeight="7" '
        'orient="auto">'
        f'<path d="M0 0L8 4L0 8z" fill="{colour}"/></marker>'
        for name, colour in (("grey", "#6b7785"), ("red", "#b3261e"))
    )
    return (
        "\n".join(
            [
                (
                    f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {y:.0f}" '
                    f'width="{width:.0f}" height="{y:.0f}">'
                ),
                "<!-- SPDX-License-Identifier: BSD-3-Clause; made by docs/rooms.py -->",
                f"<defs>{markers}</defs>",
                style,
                f'<rect width="{width:.0f}" height="{y:.0f}" fill="#fff"/>',
                f'<text class="title" x="20" y="32">{html.escape(head)}</text>',
                *out,
                "</svg>",
            ]
        )
        + "\n"
    )


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--svg", type=pathlib.Path)
    parser.add_argument("--open", nargs="+", default=[], metavar="COMPONENT")
    parser.add_argument("--moved", type=pathlib.Path, metavar="TABLE")
    options = parser.parse_args()
    order = Order(ROOT / "docs" / "rooms.txt")
    tree = Tree(list(order.uses), options.moved)
    rooms = collections.Counter(map(tree.room, tree.path))
    arrows = tree.arrows(tree.room)
    headers = {
        one for one, files in arrows.items() if any(name.endswith(".hpp") for name, _ in files)
    }
    inner = sum(1 for tail, head in arrows if tail[0] == head[0])
    for component in order.uses:
        of = sorted(
            (room for room in rooms if room[0] == component),
            key=lambda room: (order.floor.get(room, 99), room),
        )
        print(f"{component}: {sum(rooms[room] for room in of)} files")
        for room in of:
            below = sorted(
                head[1] for tail, head in arrows if tail == room and head[0] == component
            )
            print(f"  {room[1]:24}{rooms[room]:4}  {' '.join(below)}")
    print(
        f"{sum(rooms.values())} files, {len(rooms)} rooms, {inner} arrows between rooms of one "
        "component, "
        f"{len({(t[0], h[0]) for t, h in arrows if t[0] != h[0]})} between components"
    )
    wrong = 0
    for (tail, head), files in sorted(arrows.items()):
        if not order.allows(tail, head):
            wrong += 1
            print(f"not allowed: {text_of(tail)} -> {text_of(head)}")
            for name, other in files:
                print(f"    {tree.path[name]} includes {tree.path[other]}")
    for kind, found in (("circle", circles(arrows)), ("circle of headers", circles(headers))):
        for group in found:
            wrong += 1
            print(f"{kind}: {', '.join(map(text_of, group))}")
    for room, count in sorted(rooms.items()):
        if count > MOST_FILES:
            wrong += 1
            print(f"too many files: {text_of(room)} has {count}: allowed are {MOST_FILES}")
        if room not in order.floor:
            wrong += 1
            print(f"no such room: {text_of(room)}: allowed are those of docs/rooms.txt")
    if options.svg:
        options.svg.write_text(draw(tree, order, options.open))
        print(f"wrote {options.svg}")
    return 1 if options.check and wrong else 0


sys.exit(main())
