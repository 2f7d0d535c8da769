#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""How long the program's motions last over the shortest that a sequence of linear programs finds on
the same path of joints.

yardstick.py SWIVEL PROBLEM [--episodes N] [--take K] [--seed S] [--speeds V ...]

Needs scipy (Debian: python3-scipy).

K of the poses among N that have a path, drawn by the seed, are planned, refined and timed at each
speed, 1000 samples a second. The joints over the path's length, q(x), are those of the file. Sought
is b(x) = (dx/dt)^2 between rest and rest: linear between some 600 places, so that the acceleration
along the path, a = b'/2, is constant between them. With the speeds, accelerations and jerks v, A, J
of the joints and the speed V asked for,
  b <= V^2,  |q'| sqrt(b) <= v,  |q' a + q'' b| <= A,  |q' a' + 3 q'' a + q''' b| <= J / sqrt(b)
The last is not linear. Its right side is convex in b, so its tangent at the last answer lies below
it: what keeps the tangent keeps the limit. The time, the sum of 2 h / (sqrt(b) + sqrt(b next)), is
convex: tangents again, at all answers before. So each answer is feasible and none is slower than
the one before; they end where a program gains less than 1e-4 of the time. It is a yardstick, not a
bound: another start might end elsewhere.

Printed: both durations, their ratio, the most that the shortest one's joints do at 1000 Hz over
their limits (its own error), and whether it reaches the speed asked for once and keeps it until it
stops ("feasible").
"""
import argparse
import itertools
import json
import pathlib
import sys
import tempfile

import numpy as np
import scipy.sparse as sparse
from scipy.interpolate import make_interp_spline
from scipy.optimize import linprog

from motions import episodes_of, joints_of, limits_of, planned, rate_ratios
from moving_bodies import Robot
from problem_files import load_problem

PLACES = 600


def places_of(t, x):
    """Places that the motion passes evenly in time, four times as dense next to the rests."""
    step = t[-1] / PLACES
    near = min(0.25, t[-1] / 4)
    fine = np.arange(0, near, min(step, 2.5e-3))
    at = np.concatenate([fine, np.arange(near, t[-1] - near, step), t[-1] - fine[::-1]])
    places = np.interp(at, t, x)
    places[0], places[-1] = x[0], x[-1]
    kept = [places[0]]
    for place in places[1:-1]:
        if place > kept[-1] + 1e-8 and place < x[-1] - 1e-8:
            kept.append(place)
    return np.array([*kept, places[-1]])


def path_of(x, q):
    """q as a function of x: a spline of degree five through samples at least 0.1 mm apart."""
    kept = [0]
    for k in range(1, len(x) - 1):
        if x[k] >= x[kept[-1]] + 1e-4 and x[k] <= x[-1] - 1e-4:
            kept.append(k)
    kept.append(len(x) - 1)
    return make_interp_spline(x[kept], q[kept], k=5)


def travel_time(h, b):
    root = np.sqrt(np.maximum(b, 0))
    return 2 * h / (root[:-1] + root[1:])


class Programs:
    """The linear programs of one path. Unknown: b at the inner places, then the time from each
    place to the next."""

    def __init__(self, curve, x, limits, speed):
        self.x, self.h = x, np.diff(x)
        self.n = len(x) - 2  # unknown b; zero at both ends
        _, self.acceleration, self.jerk = limits
        q1, q2, q3 = (curve(x, order) for order in (1, 2, 3))
        self.cap = np.minimum(speed**2, ((limits[0] / np.maximum(np.abs(q1), 1e-12)) ** 2).min(1))
        n, h = len(x), self.h
        # a between places, and its mean and slope at inner places, as matrices of b.
        A = sparse.diags([-1 / (2 * h), 1 / (2 * h)], [0, 1], shape=(n - 1, n)).tocsr()
        spacing = (h[1:] + h[:-1]) / 2
        mean, slope = (A[1:] + A[:-1]) / 2, sparse.diags(1 / spacing) @ (A[1:] - A[:-1])
        here = sparse.eye(n).tocsr()
        rows, right = [], []
        for j in range(7):
            for end in (0, 1):  # an interval's acceleration, at both of its ends
                at = slice(end, n - 1 + end)
                rows.append(sparse.diags(q1[at, j]) @ A + sparse.diags(q2[at, j]) @ here[at])
                right.append(np.full(n - 1, self.acceleration[j]))
        self.accelerations = sparse.vstack(rows)[:, 1:-1]
        self.accelerations_right = np.concatenate(right)
        inner = slice(1, n - 1)
        self.jerks = [
            (
                sparse.diags(q1[inner, j]) @ slope
                + 3 * sparse.diags(q2[inner, j]) @ mean
                + sparse.diags(q3[inner, j]) @ here[inner]
            )[:, 1:-1].tocsr()
            for j in range(7)
        ]
        # From rest with constant jerk J: x = J t^3 / 6, sqrt(b) = J t^2 / 2.
        for end, near, length in ((0, 1, h[0]), (-1, -2, h[-1])):
            along = (self.jerk / np.maximum(np.abs(q1[end]), 1e-12)).min()
            self.cap[near] = min(self.cap[near], (along * (6 * length / along) ** (2 / 3) / 2) ** 2)
        self.tangents = []

    def add_tangent(self, b):
        """Of the time, at b: rows g b - t <= g b0 - t0."""
        root = np.sqrt(np.concatenate([[0], b, [0]]))
        time = 2 * self.h / (root[:-1] + root[1:])
        common = -self.h / (root[:-1] + root[1:]) ** 2
        with np.errstate(divide="ignore"):
            left, right = common / root[:-1], common / root[1:]
        left[0] = right[-1] = 0  # b is zero there, and stays so
        G = sparse.diags([left, right], [0, 1], shape=(self.n + 1, self.n + 2)).tocsr()[:, 1:-1]
        self.tangents.append((G, G @ b - time))

    def solve(self, b):
        """The next answer, from the one before."""
        n = self.n
        limit, slope = b**-0.5, -0.5 * b**-1.5
        rows, right = [self.accelerations, -self.accelerations], [self.accelerations_right] * 2
        for j, of_joint in enumerate(self.jerks):
            tangent = sparse.diags(self.jerk[j] * slope)
            free = self.jerk[j] * (limit - slope * b)
            for sign in (1, -1):
                rows.append(sign * of_joint - tangent)
                right.append(free)
        # Places near rest have steep rows: each by its own largest entry.
        matrix, right = sparse.vstack(rows).tocsr(), np.concatenate(right)
        size = np.maximum(abs(matrix).max(1).toarray().ravel(), 1e-12)
        unit = np.maximum(b, 1e-12)  # b is sought as a multiple of the last answer
        matrix = sparse.diags(1 / size) @ matrix @ sparse.diags(unit)
        again = np.maximum(abs(matrix).max(1).toarray().ravel(), 1e-100)
        matrix, right = sparse.diags(1 / again) @ matrix, right / size / again
        useful = right < abs(matrix).sum(1).A1 * 10 + 1e-9
        blocks, ends = [
            sparse.hstack([matrix[useful], sparse.csr_matrix((int(useful.sum()), n + 1))])
        ], [right[useful]]
        for G, g in self.tangents[-8:]:
            scaled = G @ sparse.diags(unit)
            blocks.append(sparse.hstack([scaled, -sparse.eye(n + 1)]))
            ends.append(g)
        bounds = [(0, upper / one) for upper, one in zip(self.cap[1:-1], unit)] + [(0, None)] * (
            n + 1
        )
        answer = linprog(
            np.concatenate([np.zeros(n), np.ones(n + 1)]), sparse.vstack(blocks).tocsr(),
            np.concatenate(ends), bounds=bounds, method="highs-ipm"
        )
        return np.maximum(answer.x[:n] * unit, 1e-14) if answer.status == 0 else None

    def shortest(self, b, rounds=40):
        b = np.minimum(b, self.cap[1:-1])
        for factor in (0.25, 0.5, 1, 2, 4):
            self.add_tangent(factor * b)
        best, last = None, np.inf
        for number in range(rounds):
            found = self.solve(b)
            if found is None:
                return best, number
            time = travel_time(self.h, np.concatenate([[0], found, [0]])).sum()
            if best is None or time < last:
                best = found
            if time > last * (1 - 1e-4):
                return best, number + 1
            last, b = time, found
            self.add_tangent(b)
        return best, rounds


def shortest_motion(t, x, q, limits, speed):
    """Duration, most that its joints do at 1000 Hz over their limits, whether the speed asked for
    is kept, rounds."""
    curve, places = path_of(x, q), places_of(t, x)
    programs = Programs(curve, places, limits, speed)
    rate = np.gradient(x, t)
    b = np.interp(places, x + 1e-12 * np.arange(len(x)), rate**2)[1:-1]
    b, rounds = programs.shortest(np.maximum(0.8 * b, 1e-12))
    if b is None:
        return None
    b = np.concatenate([[0], b, [0]])
    at = np.concatenate([[0], np.cumsum(travel_time(programs.h, b))])
    smooth = make_interp_spline(at, places, k=3, bc_type="clamped")
    samples = np.append(np.arange(0, at[-1], 1e-3), at[-1])
    ratios = rate_ratios(
        np.arange(len(samples)) * 1e-3, curve(np.clip(smooth(samples), x[0], x[-1])), limits
    )
    fast = np.flatnonzero(b >= (0.995 * speed) ** 2)
    feasible = len(fast) > 0 and np.all(b[fast[0] : fast[-1] + 1] >= (0.99 * speed) ** 2)
    return at[-1], ratios, bool(feasible), rounds


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("swivel")
    parser.add_argument("problem")
    parser.add_argument("--episodes", type=int, default=0)
    parser.add_argument("--take", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--speeds", type=float, nargs="+", default=[0.05, 0.25], help="m/s")
    parser.add_argument(
        "--keep", type=pathlib.Path, help="folder for the motions, and yardstick.json"
    )
    arguments = parser.parse_args()
    problem = load_problem(arguments.problem)
    robot = Robot(problem)
    limits = limits_of(problem, robot)
    temporary = tempfile.TemporaryDirectory()
    folder = arguments.keep or pathlib.Path(temporary.name)
    folder.mkdir(parents=True, exist_ok=True)
    poses, _ = episodes_of(
        arguments.swivel, arguments.problem, arguments.episodes, arguments.seed, folder
    )
    if len(poses) > arguments.take:
        poses = [
            poses[k]
            for k in sorted(
                np.random.default_rng(arguments.seed).choice(
                    len(poses), arguments.take, replace=False
                )
            )
        ]
    rows = []
    for (number, _), speed in itertools.product(poses, arguments.speeds):
        name = f"{'' if number is None else number:>4} at {1e3 * speed:3.0f} mm/s"
        motion, result, _ = planned(
            arguments.swivel, arguments.problem, arguments.seed, number, speed, 1000, folder
        )
        if motion is None:
            print(f"{name}: not executable", flush=True)
            continue
        found = shortest_motion(motion["t"], motion["s"], joints_of(motion, robot), limits, speed)
        if found is None:
            print(f"{name}: no linear program could be solved", flush=True)
            continue
        shortest, ratios, feasible, rounds = found
        own = float(result["motion"]["duration"])
        rows.append(
            {
                "episode": number, "speed": speed, "duration": own, "shortest": shortest,
                "ratios": ratios, "feasible": feasible, "ideal": result["motion"]["ideal"],
                "slow": result["motion"]["slow"]
            }
        )
        print(
            f"{name}: {own:.4f} s, shortest {shortest:.4f} s, {own / shortest:.4f} times; ideal "
            f"{result['motion']['ideal']:.4f} s; shortest has "
            f"{ratios[0]:.3f} {ratios[1]:.3f} {ratios[2]:.3f} of the limits; "
            f"{'feasible' if feasible else 'not feasible'}, {rounds} programs",
            flush=True,
        )
    (folder / "yardstick.json").write_text(json.dumps(rows, indent=1))
    for speed, feasible in itertools.product(arguments.speeds, (True, False)):
        times = [
            row["duration"] / row["shortest"]
            for row in rows
            if row["speed"] == speed and row["feasible"] == feasible
        ]
        if times:
            print(
                f"{1e3 * speed:.0f} mm/s, {'feasible' if feasible else 'not feasible'}, "
                f"{len(times)} motions: {np.median(times):.4f} (median) "
                f"{np.percentile(times, 95):.4f} (95 %) {max(times):.4f} (most) times the shortest"
            )
    return 0


if __name__ == "__main__":
    sys.exit(main())
