# SPDX-License-Identifier: BSD-3-Clause
"""Many plans of one problem: placements and campaigns, here or on the workers of a Dask cluster."""
import functools
import os
import threading
import time
from itertools import islice

from . import _swivel


def place(
    problem,
    *,
    object=None,
    path=False,
    base=False,
    x=None,
    y=None,
    z=None,
    roll=None,
    pitch=None,
    yaw=None,
    sample=None,
    seed=1,
    refine_grid=False,
    best="cost",
    planner="parallel",
    threads=0,
    timeout=None,
    progress=None,
    client=None,
):
    """Plans many placements of one thing: where should the part, the path or the robot stand? What `swivel place` does.

    problem: a Problem, or the name of its file. object (a name of the scene), path, base: what is moved, exactly one of the three.
    x, y, z (m), roll, pitch, yaw (rad): by how much, in the base frame, the turn about the thing's own origin: a number, or
    (from, to, step). sample: so many placements drawn between from and to instead of a grid, from seed.
    refine_grid: a coarse grid first, then between neighbours of unlike verdict and beside the best: a third of the cells at most.
    best: 'cost', 'clearance', 'margin' or 'speed', or several: what it climbs. planner: PlannerKind or its name. threads: 0 for all
    cores. timeout: s; what is known then is returned. progress(placements, done, of): rows as they come, how many there are now,
    and of how many, or with refine_grid at least of how many.
    client: a dask.distributed.Client, whose workers plan, each of their threads a placement at a time; `threads` means nothing
    then. Workers that end meanwhile are made up for by others.

    Returns Placements in the order of their numbers: the same rows at any number of threads, workers and batches. Raises
    InvalidArgument and InputError.
    """
    problem = _loaded(problem)
    cells = _swivel._Cells([x, y, z, roll, pitch, yaw], sample, seed)
    refinement = cells.refinement([best] if isinstance(best, str) else list(best)) if refine_grid else None
    here = client is None
    make = functools.partial(_swivel._Placer, problem, object, path, base, planner, threads if here else 1, timeout if here else None)
    make()  # says what is wrong before anything is sent

    def wanted():
        if refinement is None:
            yield list(range(len(cells)))
        else:
            while numbers := refinement.next():
                yield numbers

    total = 0
    parts = []
    deadline = None if timeout is None else time.monotonic() + timeout

    def arrived(placements):
        parts.append(placements)
        if progress is not None:
            progress(placements, sum(map(len, parts)), total)

    with _Here(make, _plan_cells) if here else _Workers(client, make, _plan_cells, deadline) as workers:
        for numbers in wanted():
            total += len(numbers)
            known = len(parts)
            size = len(numbers) if here else workers.batch(len(numbers))
            batches = (numbers[k : k + size] for k in range(0, len(numbers), size))
            if not workers.plan(((batch, cells.offsets(batch)) for batch in batches), arrived):
                break
            if refinement is not None:
                refinement.learn(_swivel.Placements._joined(parts[known:]))
    return _swivel.Placements._joined(parts)


def campaign(problem, *, episodes=100, seed=1, planner="parallel", threads=0, progress=None, client=None):
    """Plans many episodes: the problem with the objects of its `vary` at random poses. What `swivel campaign` does.

    problem: a Problem, or the name of its file. seed: what the poses are drawn from; Problem.episode(seed, k) is the k-th. planner:
    PlannerKind or its name. threads: 0 for all cores. progress(episodes, done, of): rows as they come, how many there are now, and
    of how many. client: a dask.distributed.Client, as of place().

    Returns Episodes in the order of their numbers, of which all but plan_ms are the same at any number of threads and workers.
    Raises InvalidArgument and InputError.
    """
    here = client is None
    make = functools.partial(_swivel._Campaigner, _loaded(problem), episodes, seed, planner, threads if here else 1)
    make()
    parts = []

    def arrived(rows):
        parts.append(rows)
        if progress is not None:
            progress(rows, sum(map(len, parts)), episodes)

    with _Here(make, _plan_episodes) if here else _Workers(client, make, _plan_episodes, None) as workers:
        count = 1 if here else -(-episodes // workers.batch(episodes))
        workers.plan(((index, count) for index in range(count)), arrived)
    return _swivel.Episodes._joined(parts)


def _loaded(problem):
    return _swivel.load_problem(problem) if isinstance(problem, (str, os.PathLike)) else problem


def _plan_cells(planner, batch, arrived):
    """Whether all of the batch came."""
    planner.plan(*batch, arrived)
    return not planner.stopped


def _plan_episodes(planner, batch, arrived):
    planner.plan(*batch, arrived)
    return True


class _Here:
    """Plans on the threads of this process; rows arrive one by one."""

    def __init__(self, make, plan):
        self._planner, self._plan = make(), plan

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def plan(self, batches, arrived):
        return all(self._plan(self._planner, batch, arrived) for batch in batches)


class _Planners:
    """What batches are planned by, on its way to a worker, where each thread makes one of its own that remembers."""

    def __init__(self, make):
        self._make = make
        self._own = threading.local()

    def __getstate__(self):
        return self._make

    def __setstate__(self, make):
        self.__init__(make)

    def plan(self, plan, batch):
        if not hasattr(self._own, "planner"):
            self._own.planner = self._make()
        parts = []
        plan(self._own.planner, batch, parts.append)
        return type(parts[0])._joined(parts) if parts else None


class _Workers:
    """Plans on the workers of a Dask cluster; rows arrive batch by batch, in any order."""

    def __init__(self, client, make, plan, deadline):
        self._client, self._plan, self._deadline = client, plan, deadline
        # A task, not data that is scattered: it is made again where all workers that had it are gone.
        self._planners = client.submit(_Planners, make, pure=False)
        self._under_way = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._client.cancel([*self._under_way, self._planners])

    def _threads(self):
        return max(1, sum(self._client.nthreads().values()))

    def batch(self, count):
        """Several batches for each thread, so that all end together; not so many that sending them shows."""
        return max(1, min(64, count // (8 * self._threads())))

    def plan(self, batches, arrived):
        from dask.distributed import CancelledError, as_completed

        batches = iter(batches)
        late = threading.Event()

        def send():
            """As many as keep all workers busy; the rest waits here, where nothing has to take it back."""
            free = 0 if late.is_set() else 4 * self._threads() - len(self._under_way)
            sent = [self._client.submit(_Planners.plan, self._planners, self._plan, batch, pure=False) for batch in islice(batches, max(0, free))]
            self._under_way += sent
            return sent

        def stop():
            late.set()
            self._client.cancel(list(self._under_way))

        timer = None if self._deadline is None else threading.Timer(max(0, self._deadline - time.monotonic()), stop)
        coming = as_completed(send())
        if timer is not None:
            timer.start()
        try:
            for future in coming:
                self._under_way.remove(future)
                try:
                    rows = future.result()
                except CancelledError:
                    if not late.is_set():
                        raise
                else:
                    arrived(rows)
                for more in send():
                    coming.add(more)
        finally:
            if timer is not None:
                timer.cancel()
        return not late.is_set()
