# SPDX-License-Identifier: BSD-3-Clause
# %% [markdown]
# Where should the part stand? Here, and on the workers of a Dask cluster, where there is Dask
# (Debian: python3-distributed).

# %%
from pathlib import Path

import swivel

problem = swivel.load(
    Path(__file__).resolve().parents[2] / "data" / "problems" / "experiment_c.yaml"
)
problem.resolution = swivel.Resolution(ds=0.02, dphi=0.2)

# %% The door is tried on a grid of 5 mm; a third of the cells at most are planned.
grid = swivel.place(
    problem, object="door", x=(-0.1, 0.1, 0.005), y=(-0.1, 0.1, 0.005), refine_grid=True,
    best="clearance"
)
print(grid)
for row in grid.best("clearance", 3):
    print(row)

# %% The best of them is an ordinary problem.
best = grid.best(["clearance", "cost"], 1)[0]
placed = problem.placed(best.offset, object="door")
plan = swivel.plan(placed)
print(
    "planned again:", plan.cost == best.cost, "and checked:", swivel.check(placed, plan.trajectory)
)

# %% The same on a cluster, rows as they come. Two workers within this process here;
# Client("tcp://scheduler:8786") has many machines.
try:
    from dask.distributed import Client, LocalCluster
except ImportError:
    print("no Dask")
else:
    with LocalCluster(
        n_workers=2, threads_per_worker=1, processes=False, dashboard_address=None
    ) as cluster, Client(cluster) as client:
        poses = swivel.campaign(
            problem, episodes=40, client=client,
            progress=lambda rows, done, of: print(f"{done} of {of}: {rows}")
        )
        print("on the cluster:", poses)
    here = swivel.campaign(problem, episodes=40)
    print("here the same:", poses.cost.tobytes() == here.cost.tobytes())
