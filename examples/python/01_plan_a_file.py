# SPDX-License-Identifier: BSD-3-Clause
# %% [markdown]
# A problem file is planned, looked at, proved and written. Cells begin with `# %%`: Jupyter (with
# jupytext), VS Code and Spyder run them one by one, `python3` all of them.

# %%
import sys
from pathlib import Path

import numpy as np
import swivel

data = Path(__file__).resolve().parents[2] / "data"

# %% A Motoman SDA5F polishes a car door. `evidence` measures clearances as well.
problem = swivel.load(data / "problems" / "experiment_c.yaml")
print(problem)
plan = swivel.plan(problem, evidence=True)
print(plan)

# %% Joints are an array, a row for each layer along the path, rad.
trajectory = plan.trajectory
print(trajectory, trajectory.joints.shape)
largest = np.abs(np.diff(trajectory.joints, axis=0)).max(axis=0)
for name, step in zip(plan.joint_names, largest):
    print(f"{name}: moves by at most {np.degrees(step):.2f} deg in a step")

# %% The check knows nothing of planners: it proves the rows from the problem alone.
print(swivel.check(problem, trajectory))

# %% Numbers read back as the same doubles.
out = Path(sys.argv[1] if len(sys.argv) > 1 else ".") / "trajectory.csv"
trajectory.save(out)
same = swivel.load_trajectory(out, plan.joint_names)
print("written and read:", np.array_equal(same.joints, trajectory.joints))

# %% Where there is no path, the plan says how far one comes, what ends every one, and `advise` what
# would help.
barred = data / "problems" / "experiment_a_start.yaml"
plan = swivel.plan(barred)
print(plan.status, "-", plan.diagnosis.cause, "at s =", plan.diagnosis.at_s, "m")
for advice in swivel.advise(barred, plan):
    print(advice)
