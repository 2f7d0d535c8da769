# SPDX-License-Identifier: BSD-3-Clause
"""Makes many plans of one problem, job or workcell (placements, campaigns, given problems).

They are made here or on workers of a Dask cluster.
"""
from __future__ import annotations

import contextlib
import functools
import operator
import os
import threading
import time
from itertools import islice

from . import _swivel
from .arguments import JOINTS, POSES, numbers_of, paths_of, require


def place(
    problem: Problem | _File,
    *,
    object: str | None = None,
    path: bool = False,
    base: bool = False,
    arm: str | None = None,
    x: _Range | None = None,
    y: _Range | None = None,
    z: _Range | None = None,
    roll: _Range | None = None,
    pitch: _Range | None = None,
    yaw: _Range | None = None,
    hold: Mapping[str, _Range] | None = None,
    sample: int | None = None,
    seed: int = 1,
    refine_grid: bool = False,
    best: _Criterion | Sequence[_Criterion] = "cost",
    planner: _PlannerKind = "parallel",
    threads: int = 0,
    timeout: float | None = None,
    prove: bool = True,
    progress: Callable[[Placements, int, int], Any] | None = None,
    client: Any = None,
) -> Placements:
    """Plans many placements: where should the part, the path, the robot or a held joint stand?

    Does what `swivel place` does.

    problem: a Problem, or the name of its file. object (a name of the
    scene), path, base: what is moved; exactly one of the three; with path, the paths of all strokes
    of a job, or of both arms of a workcell. arm: the arm of a workcell whose path alone is moved.
    x, y, z (m), roll, pitch, yaw (rad): by how much it is moved, in the base frame, where turns are
    about the thing's own origin: a number, or (from, to, step).
    hold: where joints that are not planned stand, by name, {"torso": (-0.5, 0.5, 0.1)}, rad, or m
    of a prismatic one; with nothing moved, object, path and base are left out.
    sample: number of placements drawn at random, by seed, between from and to instead of a grid.
    refine_grid: plan a coarse grid first, then cells between neighbours of unlike verdict and
    beside the best: a third of the cells at most. best: one or several of 'cost', 'clearance',
    'margin', 'slide' and 'speed', by which refine_grid finds the best. planner: a PlannerKind or
    its name. threads: 0 for all cores. timeout: s, after which the rows known so far are returned.
    prove: prove each answer before its row is told.
    progress(placements, done, of): called with new rows, the number of rows so far, and the number
    of all rows, which with refine_grid may still grow. client: a dask.distributed.Client; each
    thread of its workers plans one placement at a time, and `threads` has no effect. Other workers
    replace those that end.

    Returns Placements in the order of their numbers; the rows are the same at any number of
    threads, workers and batches. Clearances, margins and speeds of a job's rows are those of its
    strokes, those of a workcell's the least of both arms. Rows have no trajectories:
    plan(problem.placed(row.offset, base=True, hold=row.hold))
    has that of a row. Raises InvalidArgument, InputError
    and TypeError; Ctrl-C raises KeyboardInterrupt, whose attribute `rows` is the Placements known
    so far.
    """
    problem = _loaded(problem)
    require(object=object, path=path, base=base, arm=arm, x=x, y=y, z=z, roll=roll, pitch=pitch)
    require(yaw=yaw, hold=hold, sample=sample, seed=seed, refine_grid=refine_grid, best=best)
    require(threads=threads, timeout=timeout, prove=prove, progress=progress, client=client)
    moves = [x, y, z, roll, pitch, yaw]
    hold = {} if hold is None else dict(hold)
    cells = _swivel._Cells(moves, hold, sample, seed)
    refinement = (
        cells.refinement([best] if isinstance(best, str) else list(best)) if refine_grid else None
    )
    here = client is None
    make = functools.partial(
        _swivel._Placer,
        problem,
        object,
        path,
        base,
        bool(hold) and all(value is None for value in moves),
        arm,
        cells.joints(),
        planner,
        threads if here else 1,
        timeout if here else None,
        prove,
    )
    make()  # says what is wrong before anything is sent
    deadline = _deadline(time.monotonic(), timeout, client)

    def wanted():
        if refinement is None:
            yield list(range(len(cells)))
        else:
            while numbers := refinement.next():
                yield numbers

    total = 0
    parts = []

    def arrived(placements):
        parts.append(placements)
        if progress is not None:
            progress(placements, sum(map(len, parts)), total)

    with _known_rows(_swivel.Placements, parts), (
        _Here(make, _plan_cells) if here else _Workers(client, make, _plan_cells, deadline)
    ) as workers:
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


def campaign(
    problem: Problem | _File,
    *,
    episodes: int = 100,
    seed: int = 1,
    planner: _PlannerKind = "parallel",
    threads: int = 0,
    prove: bool = True,
    progress: Callable[[Episodes, int, int], Any] | None = None,
    client: Any = None,
) -> Episodes:
    """Plans many episodes: the problem, job or workcell with its `vary` at random poses.

    Does what `swivel campaign` does.

    problem: a Problem, or the name of its file. episodes: how many. seed:
    of the random poses; Problem.episode(seed, k), is the k-th episode.
    planner: a PlannerKind or its name. threads: 0 for all cores. prove: prove each answer before
    its row is told. progress(episodes, done, of): called with new rows, the number of rows so far,
    and the number of all rows. client: a dask.distributed.Client, as for place().

    Returns Episodes in the order of their numbers; all columns but plan_ms are the same at any
    number of threads and workers. Raises InvalidArgument, InputError and TypeError; Ctrl-C raises
    KeyboardInterrupt, whose attribute `rows` is the Episodes known so far.
    """
    problem = _loaded(problem)
    require(episodes=episodes, seed=seed, threads=threads, prove=prove)
    require(progress=progress, client=client)
    here = client is None
    make = functools.partial(
        _swivel._Campaigner,
        problem,
        episodes,
        seed,
        planner,
        threads if here else 1,
        prove,
    )
    make()
    parts = []

    def arrived(rows):
        parts.append(rows)
        if progress is not None:
            progress(rows, sum(map(len, parts)), episodes)

    with _known_rows(_swivel.Episodes, parts), (
        _Here(make, _plan_episodes) if here else _Workers(client, make, _plan_episodes, None)
    ) as workers:
        count = 1 if here else -(-episodes // workers.batch(episodes))
        workers.plan(((index, count) for index in range(count)), arrived)
        return _swivel.Episodes._joined(parts)


def plan_many(
    problem: Problem | _File,
    *,
    paths: ArrayLike | Sequence[ArrayLike] | None = None,
    poses: Mapping[str, ArrayLike] | None = None,
    bases: ArrayLike | None = None,
    starts: ArrayLike | None = None,
    ends: ArrayLike | None = None,
    planner: _PlannerKind = "parallel",
    threads: int = 0,
    timeout: float | None = None,
    timeout_each: float | None = None,
    prove: bool = True,
    explain: bool = True,
    progress: Callable[[Plans, int, int], Any] | None = None,
    client: Any = None,
    shard: str | tuple[int, int] | None = None,
) -> Plans:
    """Plans many problems that differ from one: in paths, places of objects, base, start and end.

    problem: a Problem, or the name of its file. The next five have one entry for each of the n
    problems; one or more of them are given, and what is not given is that of the problem.
    paths: of one path: waypoints in the path's frame, (n, m, 7) rows x y z qw qx qy qz, m,
    (n, m, 4, 4), or a sequence of (m, 7) or (m, 4, 4), whose m may differ; not of problems with
    windows of the roll. poses: name of a scene object -> its poses in the base frame, (n, 7) or
    (n, 4, 4). bases: of one arm: poses of the robot's base in the base frame that the problem has,
    (n, 7) or (n, 4, 4); objects stay where they are, at `poses` if these are given, and so does a
    path in the base frame. starts, ends: of one path: joints in which it begins and ends, (n, 7),
    rad.
    planner: a PlannerKind or its name. threads: problems planned at once, 0 for all cores.
    timeout: s, after which the rows known so far are returned. timeout_each: s for each problem;
    one that takes longer has the status 'timeout'. prove: prove each answer before its row is told.
    explain: find out what ends the paths of problems without one, which may take several times as
    long as finding that there is none; else their `cause` is 'not_asked', but for 'not_closed',
    'transition', 'conflict' and 'given_motion', which are known anyway.
    progress(plans, done, of): called with new rows, in their order, the number of rows so far, and
    the number of all rows. client: a dask.distributed.Client, as for place(); its rows come in any
    order. shard: (I, N) or "I/N": only the problems I, I + N, I + 2 N, ...; their numbers stay.

    Returns Plans in the order of their numbers. All but plan_ms is the same at any number of
    threads, workers and shards: what plan() finds for each problem alone. Problems with one path
    share what is computed of it, and should follow each other. Where time is up, the rows are the
    first ones, without a gap; over a client `number` says which they are. What is wrong with one
    problem alone, such as a start off its path, is a row of the status 'error' with the message as
    `reason`; of two arms, a given motion that an object bars is a row without a path. Raises
    InvalidArgument, InputError and TypeError before anything is planned; Ctrl-C raises
    KeyboardInterrupt, whose attribute `rows` is the Plans known so far.
    """
    begin = time.monotonic()
    problem = _loaded(problem)
    require(poses=poses, threads=threads, timeout=timeout, timeout_each=timeout_each, prove=prove)
    require(explain=explain, progress=progress, client=client)
    arrays = (
        None if given is None else numbers_of(name, given, allowed)
        for name, given, allowed in (
            ("bases", bases, POSES), ("starts", starts, JOINTS), ("ends", ends, JOINTS)
        )
    )
    varied = _swivel._Varied(
        problem,
        None if paths is None else paths_of(paths),
        {name: numbers_of(f"poses: '{name}'", given) for name, given in dict(poses or {}).items()},
        *arrays,
    )
    if shard is not None:
        index, count = _share(shard)
        varied = varied.part(range(index, len(varied), count))
    here = client is None
    make = functools.partial(_swivel._ManyPlanner, problem, planner)
    # Says what is wrong before anything is sent, and how many joints a row has.
    parts = [make(threads, timeout, timeout_each, prove, explain).nothing()]
    deadline = _deadline(begin, timeout, client)
    if here:
        make = functools.partial(make, threads, timeout, timeout_each, prove, explain)
    else:
        make = functools.partial(make, 1, None, timeout_each, prove, explain)
    total, done = len(varied), 0

    def arrived(plans):
        nonlocal done
        parts.append(plans)
        done += len(plans)
        if progress is not None:
            progress(plans, done, total)

    with _known_rows(_swivel.Plans, parts), (
        _Here(make, _plan_varied) if here else _Workers(client, make, _plan_varied, deadline)
    ) as workers:
        size = total if here else workers.batch(total)
        batches = (
            varied if size == total else varied.part(range(k, min(k + size, total)))
            for k in range(0, total, max(1, size))
        )
        workers.plan(batches, arrived)
        return _swivel.Plans._joined(parts)


def _deadline(begin, timeout, client):
    """Returns when time is up, on the clock of time.monotonic(); None for never."""
    if timeout is None:
        return None
    if client is not None and timeout > threading.TIMEOUT_MAX:
        raise ValueError(
            f"timeout: {float(timeout):g}: too long for a client: allowed are values above 0, at "
            f"most {threading.TIMEOUT_MAX:.0f}, or None"
        )
    return begin + timeout


def _share(shard):
    """Returns I and N of a shard that is given as (I, N) or "I/N"."""
    try:
        index, count = (
            map(int, shard.split("/")) if isinstance(shard, str) else map(operator.index, shard)
        )
    except (TypeError, ValueError):
        index = count = 0
    if not 0 <= index < count:
        raise _swivel.InvalidArgument(
            f"shard: {shard!r}: allowed are (I, N) and 'I/N', with I from 0 to N - 1"
        )
    return index, count


@contextlib.contextmanager
def _known_rows(table, parts):
    """Gives a KeyboardInterrupt that passes through the rows that have arrived, joined."""
    try:
        yield
    except KeyboardInterrupt as interrupt:
        interrupt.rows = table._joined(parts)
        raise


def _loaded(problem):
    """Returns the Problem that is given, or that the file has."""
    if isinstance(problem, (str, os.PathLike)):
        return _swivel.load(problem)
    if not isinstance(problem, _swivel.Problem):
        raise TypeError(f"problem: {type(problem).__name__}: allowed are a Problem, or its file")
    return problem


def _plan_cells(planner, batch, arrived):
    """Plans a batch of placements; returns whether all of it was planned."""
    planner.plan(*batch, arrived)
    return not planner.stopped


def _plan_episodes(planner, batch, arrived):
    planner.plan(*batch, arrived)
    return True


def _plan_varied(planner, batch, arrived):
    """Plans a batch of problems; returns whether all of it was planned."""
    return planner.plan(batch, arrived)


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
    """The planners of a worker, sent to it as a recipe.

    Each thread of the worker makes a planner of its own, which remembers earlier plans.
    """

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
        # A task rather than scattered data: it runs again if all workers with its result are gone.
        self._planners = client.submit(_Planners, make, pure=False)
        self._under_way = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._client.cancel([*self._under_way, self._planners])

    def _threads(self):
        return max(1, sum(self._client.nthreads().values()))

    def batch(self, count):
        """Returns how many of `count` cells a batch has.

        Each thread gets several batches, so that all threads end at about the same time, but not so
        many that sending them takes noticeable time.
        """
        return max(1, min(64, count // (8 * self._threads())))

    def plan(self, batches, arrived):
        from dask.distributed import CancelledError, as_completed

        batches = iter(batches)
        late = threading.Event()

        def send():
            """Sends as many batches as keep all workers busy, and returns their futures.

            The other batches wait here, where nothing has to cancel them.
            """
            free = 0 if late.is_set() else 4 * self._threads() - len(self._under_way)
            sent = [
                self._client.submit(_Planners.plan, self._planners, self._plan, batch, pure=False)
                for batch in islice(batches, max(0, free))
            ]
            self._under_way += sent
            return sent

        def stop():
            late.set()
            self._client.cancel(list(self._under_way))

        timer = (
            None
            if self._deadline is None
            else threading.Timer(max(0, self._deadline - time.monotonic()), stop)
        )
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
