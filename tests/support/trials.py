# SPDX-License-Identifier: BSD-3-Clause
"""How many trials a test makes and from which seed, by the variables that tests/support/seed.hpp
reads: SWIVEL_TEST_TRIALS, SWIVEL_TEST_SCALE and SWIVEL_TEST_SEED."""
import math
import os

SCALE = float(os.environ.get("SWIVEL_TEST_SCALE", 1))


def trials(usual):
    """How many trials to make: SWIVEL_TEST_TRIALS, or SCALE times the usual number, rounded up, at
    least one."""
    given = os.environ.get("SWIVEL_TEST_TRIALS")
    return int(given) if given else max(1, math.ceil(usual * SCALE - 1e-9))


def at_least(usual):
    """How many of the trials must have met something: `usual` at the full scale, half of SCALE
    times as many at a quarter or more, else none."""
    if "SWIVEL_TEST_TRIALS" in os.environ or SCALE < 0.25:
        return 0
    return int(usual * SCALE) // 2 if SCALE < 1 else usual


def seed(usual):
    """SWIVEL_TEST_SEED, or `usual`; printed, so that a failure can be repeated."""
    value = int(os.environ.get("SWIVEL_TEST_SEED") or usual)
    print(f"SWIVEL_TEST_SEED={value}")
    return value
