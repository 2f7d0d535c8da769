# SPDX-License-Identifier: BSD-3-Clause
# %% [markdown]
# Robot, scene and task are made here. An object moves, and the planner plans again, re-using what
# did not change.

# %%
import time
from pathlib import Path

import numpy as np
import swivel

robots = Path(__file__).resolve().parents[2] / "data" / "robots"

# %% An arm from its URDF; base and tip are found where they are not given. The tool's point lies
# 0.1 m past the flange.
robot = swivel.Robot(robots / "iiwa14.urdf", robots / "iiwa14.srdf", tool=swivel.pose([0, 0, 0.1]))
print(robot)

# %% Rows x y z qw qx qy qz: the tool looks down and draws a square.
down = [0, 1, 0, 0]
corners = [(0.45, -0.1), (0.45, 0.1), (0.65, 0.1), (0.65, -0.1), (0.45, -0.1)]
task = swivel.Task(
    [[x, y, 0.4, *down] for x, y in corners],
    limits=swivel.Limits(clearance=0.01, joint_margin=0.05),
    resolution=swivel.Resolution(ds=0.01),
)
scene = swivel.Scene()
scene.add("table", swivel.Box([0.8, 0.8, 0.02]), [0.6, 0, 0.2])
scene.add("post", swivel.Cylinder(radius=0.03, length=0.5), [0.3, 0.4, 0.5])

# %%
planner = swivel.Planner(robot, task, scene)
print(planner.plan(evidence=True))

# %% The post comes nearer.
for y in np.linspace(0.35, 0.1, 6):
    planner.move("post", [0.3, y, 0.5])
    begin = time.perf_counter()
    plan = planner.plan()
    took = 1e3 * (time.perf_counter() - begin)
    print(
        f"post at y = {y:.2f} m: {plan.status}, "
        f"{'cost %.4f' % plan.cost if plan.solved else plan.diagnosis.cause}, {took:.1f} ms"
    )

# %% The same in the words of other software: straight lines from a posture, as far as that goes.
start = planner.plan().joints[0] if plan.solved else swivel.Planner(robot, task).plan().joints[0]
there = robot.tool_pose(start)
there[:3, 3] += [0.1, -0.1, 0.1]
fraction, trajectory = swivel.compute_cartesian_path(robot, scene, [there], start)
print(f"0.17 m upwards: {100 * fraction:.0f} % of the way, {len(trajectory)} rows")
