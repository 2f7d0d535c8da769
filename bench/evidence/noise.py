# SPDX-License-Identifier: BSD-3-Clause
"""How sure a measured ratio is."""
import random
import statistics


def median_and_bounds(values, draws=2000):
    """The median, and the range that holds it in 95 % of bootstrap draws (seeded)."""
    generator = random.Random(1)
    medians = sorted(
        statistics.median(generator.choices(values, k=len(values))) for _ in range(draws)
    )
    return statistics.median(values), medians[int(0.025 * draws)], medians[int(0.975 * draws)]
