# SPDX-License-Identifier: BSD-3-Clause
# %% [markdown]
# A rule of one's own, a cost of one's own, and the path as a motion in time that a controller can
# run, plotted where matplotlib is installed.

# %%
import sys
from pathlib import Path

import numpy as np
import swivel

folder = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
problem = swivel.load(
    Path(__file__).resolve().parents[2] / "data" / "problems" / "experiment_c.yaml"
)
planner = swivel.Planner(problem)

# %% A hose allows joints 5 and 7 together so much twist and no more. Asked about arrays of states,
# (n, 7), rad.
asked = []


def hose(joints):
    asked.append(len(joints))
    return np.abs(joints[:, 4] + joints[:, 6]) <= 2.5


plan = planner.plan(check=hose)
print(plan)
print(f"the hose was asked {len(asked)} times, about {sum(asked)} states")
if plan.solved:
    print("largest twist:", np.abs(plan.joints[:, 4] + plan.joints[:, 6]).max(), "rad")

# %% Joints are to stay near the middle of their ranges; the cost of states is added to that of
# steps.
low, high = problem.joint_limits.T
middle, reach = (low + high) / 2, (high - low) / 2


def off_the_middle(joints):
    return 0.01 * (((joints - middle) / reach) ** 2).sum(axis=1)


for cost in (None, off_the_middle):
    plan = planner.plan(cost=cost)
    share = np.abs((plan.joints - middle) / reach).max()
    print(
        f"with{'' if cost else 'out'} it joints come to {100 * share:.0f} % of the way from the "
        "middle to a limit"
    )

# %% Refined, and timed at 0.1 m/s: speeds, accelerations and jerks of the joints are kept, and
# proved.
plan = planner.plan(refine=True, speed=0.1)
motion = plan.motion
print(motion)
print(planner.check(motion))
motion.save(folder / "motion.csv")  # or .json, .yaml: ROS 2's JointTrajectory; .mcap: JointState

# %%
try:
    import matplotlib
except ImportError:
    print("matplotlib is not installed: no plot")
else:
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, (above, below) = plt.subplots(2, sharex=True, figsize=(8, 6))
    above.plot(motion.t, np.degrees(motion.joints), label=motion.joint_names)
    above.set_ylabel("joints, deg")
    above.legend(fontsize="x-small", ncols=2)
    below.plot(motion.t, motion.velocities)
    below.set_ylabel("speeds, rad/s")
    below.set_xlabel("t, s")
    figure.savefig(folder / "motion.png")
    print("plotted:", folder / "motion.png")
