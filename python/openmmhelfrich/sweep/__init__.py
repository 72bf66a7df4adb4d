"""Sweeps over parameter points: parallel, cached, and able to go on after an interruption.

A sweep maps a function over points, each of which is a dictionary of its keyword arguments::

    from openmmhelfrich.sweep import grid, sweep

    def energy(softness, seed):
        ...
        return {"bending": 1.0, "distances": np.zeros(3)}

    points = grid(softness=(0.037, 0.15), seed=range(10))
    results = sweep(energy, points, cache="results")

The function must be pure: its result depends on its arguments alone, among which the seed of all
its random numbers. Each result is stored as soon as it is there, so that a sweep that was
interrupted computes only what is missing. The points are spread by Dask, over the cores of this
machine or over the workers of any running scheduler.
"""

from __future__ import annotations

import functools
import inspect
import itertools
import sys
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from tqdm import tqdm

from .._numbers import whole_number
from ..logs import logger, quiet
from .backends import SweepError, name_of, on_dask, on_this_process
from .cache import Cache
from .plain import plain_point

__all__ = ["Cache", "SweepError", "grid", "sweep"]


def grid(**axes: Any) -> list[dict[str, Any]]:
    """All combinations of values, the last axis varying fastest.

    Parameters
    ----------
    **axes : iterable
        The values of each parameter.

    Returns
    -------
    list of dict

    Examples
    --------
    >>> grid(scheme=["Julicher", "GompperKroll"], seed=range(2))[1]
    {'scheme': 'Julicher', 'seed': 1}
    """
    names = list(axes)
    return [dict(zip(names, row, strict=True)) for row in itertools.product(*axes.values())]


def sweep(
    function: Callable[..., Mapping[str, Any]],
    points: Iterable[Mapping[str, Any]],
    *,
    cache: Any = None,
    version: int = 1,
    scheduler: str | None = None,
    workers: int | None = None,
    description: str | None = None,
    progress: bool = True,
    compute: bool = True,
) -> list[dict[str, Any]]:
    """Call ``function(**point)`` for every point and return the results in the order of the points.

    Parameters
    ----------
    function : callable
        A pure function; with a cache, one that is defined with ``def`` at the top of a module,
        because stored results are found by the names of both. It returns a dictionary of arrays,
        numbers, strings, booleans, None, and lists of these. It is sent to the workers by value if
        it comes from a script, together with the modules beside the script; only installed packages
        must be there already.
    points : iterable of dict
        Keyword arguments: numbers, strings, booleans, None, and lists of these.
    cache : str, Path or Cache, optional
        Folder in which results are stored and looked for, made where needed. Sweeps of several
        functions may share it if their modules, as they are imported, or their names differ; those
        of notebooks are all in a module ``__main__``. Processes may share it too: with
        ``workers=0`` each leaves out what another has stored by then. Default: none.
    version : int
        Part of the key of the stored results: count it up when the function changes.
    scheduler : str, optional
        Address of a running Dask scheduler, such as ``tcp://node1:8786``. Its workers need not
        see the cache folder. A worker that is lost costs the point that it was computing, which
        another worker takes over. Default: a cluster of processes on this machine.
    workers : int, optional
        Number of processes on this machine, each with one thread; 0 computes in this process,
        without Dask. Default: one for each core. Not with `scheduler`.
    description : str, optional
        Text beside the progress bar. Default: the name of the function.
    progress : bool
        Whether to show a progress bar on standard error.
    compute : bool
        Whether to compute what is not stored; if not, it is an error.

    Returns
    -------
    list of dict
        One result for each point. Numbers and lists are as JSON gives them back, whether a result
        was just computed or stored. ``seconds`` is added, the processor time that it took.

    Raises
    ------
    TypeError
        A point that is no dictionary of the above, or a lambda, partial, method or nested function
        together with a cache.
    ValueError
        A negative number of workers, or workers beside a scheduler.
    OSError
        The scheduler does not answer, or the cache folder cannot be written to.
    SweepError
        The function raised an exception, returned no dictionary of the above, or killed its worker
        several times, at some points: the message names them, and the others are computed. Or the
        scheduler has no workers or went away. What was finished is in the cache, if there is one.
        Or results are missing that must not be computed.
    """
    if workers is not None:
        workers = whole_number(workers, "sweep", "workers", 0)
    if scheduler is not None and workers is not None:
        raise ValueError("sweep: give either a scheduler or a number of workers, not both")
    points = [plain_point(point) for point in points]
    name = name_of(function)
    stored_name = name if cache is None else _stored_name(function, name)
    store = cache if cache is None or isinstance(cache, Cache) else Cache(cache)
    keys = [Cache.key(stored_name, point, version) for point in points]
    # Equal points are computed once.
    results: dict[str, dict[str, Any]] = {}
    missing: dict[str, dict[str, Any]] = {}
    for key, point in zip(keys, points, strict=True):
        if key not in results and key not in missing:
            stored = store.load(stored_name, key, point) if store else None
            if stored is None:
                missing[key] = point
            else:
                results[key] = stored
    if missing and not compute:
        raise SweepError(
            f"sweep: {len(missing)} of {len(points)} results of {name} are not stored in "
            f"{store.folder if store else 'a cache'}, the first is {next(iter(missing.values()))}; "
            "run the sweep first"
        )
    log = logger("sweep")
    log.info("%s: %d of %d points are stored", name, len(results), len(results) + len(missing))
    failures: dict[str, BaseException] = {}

    def still_missing(bar):
        """What is computed next; what another sweep has stored by then is not."""
        for key, point in missing.items():
            stored = store.load(stored_name, key, point) if store else None
            if stored is None:
                yield key, point
            else:
                results[key] = stored
                bar.update()

    bar = tqdm(
        total=len(results) + len(missing),
        initial=len(results),
        desc=description or name,
        disable=not progress or quiet(),
    )
    with bar:
        if missing:
            if workers == 0:
                outcomes = on_this_process(function, still_missing(bar))
            else:
                outcomes = on_dask(function, missing, scheduler, workers)
            for key, outcome in outcomes:
                if isinstance(outcome, BaseException):
                    log.info("%s: %s failed: %s", name, missing[key], outcome)
                    failures[key] = outcome
                else:
                    result, seconds = outcome
                    results[key] = {**result, "seconds": seconds}
                    log.debug("%s: %s took %.3g s", name, missing[key], seconds)
                    if store:
                        store.save(stored_name, key, missing[key], results[key])
                bar.update()
    if failures:
        raise _failed(name, missing, failures, store)
    return [results[key] for key in keys]


def _stored_name(function, name):
    """By what stored results are told from those of other functions: module and name.

    The module of a script is called after its file, as where another script imports it. Refuses
    what has no name of its own.
    """
    if isinstance(function, functools.partial):
        kind = f"a partial of {name}"
    elif name == "<lambda>":
        kind = "a lambda"
    elif getattr(function, "__qualname__", None) != name:
        kind = getattr(function, "__qualname__", f"an object of class {name}")
        kind += ", which is not at the top of a module"
    else:
        return f"{_module_name(function)}.{name}"
    raise TypeError(
        f"sweep: a cache finds results by the name of the function, and got {kind}; define a "
        "function with a name of its own at the top of a module, with all that it depends on as "
        "arguments, or leave out the cache"
    )


def _module_name(function):
    """The name of a function's module; of a script, what it would be called if it were imported."""
    if function.__module__ != "__main__":
        return function.__module__
    main = sys.modules["__main__"]
    code = getattr(inspect.unwrap(function), "__code__", None)
    file = Path(code.co_filename if code else "")
    # A script that is run by another one, such as a profiler, is not the main module's file; and
    # the path of one that is may be relative to where it was started.
    if not file.is_file() and file.name != Path(getattr(main, "__file__", "")).name:
        return "__main__"  # of a notebook, or of a program on standard input
    spec = getattr(main, "__spec__", None)
    is_module = spec is not None and spec.origin and Path(spec.origin).resolve() == file.resolve()
    return spec.name if is_module else file.stem


def _failed(name, points, failures, store):
    lines = [f"  {points[key]}: {type(error).__name__}: {error}" for key, error in failures.items()]
    shown = lines[:10] + ([f"  … and {len(lines) - 10} more"] if len(lines) > 10 else [])
    error = SweepError(
        f"sweep: {name} failed at {len(failures)} of {len(points)} points; the others are "
        + (f"stored in {store.folder}" if store else "lost, as there is no cache")
        + ":\n"
        + "\n".join(shown)
    )
    error.__cause__ = next(iter(failures.values()))
    return error
