"""Where the points of a sweep are computed: in this process, or by Dask."""

from __future__ import annotations

import contextlib
import functools
import logging
import os
import pickle
import queue
import signal
import sys
import threading
import time
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from ..logs import logger
from .plain import plain_result

__all__ = ["SweepError", "name_of", "on_dask", "on_this_process"]

# How long to wait for the first worker of a scheduler, and between looks at its health, s.
_FIRST_WORKER = 60
_HEALTH = 10


class SweepError(RuntimeError):
    """Some points of a sweep failed; the message names them. A cache has the others."""


def on_this_process(function: Any, points: Iterable[tuple[str, Any]]) -> Iterator[Any]:
    """Compute in this process, and yield each key with what `timed` returns or the exception."""
    for key, point in points:
        try:
            yield key, timed(function, point)
        except Exception as error:
            yield key, error


def on_dask(function: Any, points: Any, scheduler: Any, workers: Any) -> Iterator[Any]:
    """Compute on a Dask cluster, and yield each key with what `timed` returns or the exception."""
    try:
        import dask
        import distributed
    except ImportError as error:
        raise ImportError(
            f"sweep: needs dask and distributed ({error}); install openmm-helfrich[paper], or "
            "compute in this process with workers=0"
        ) from error
    payload = _by_value(function)
    with contextlib.ExitStack() as stack:
        # One thread for each worker, also in our own kernels: the points are the parallel part.
        stack.enter_context(
            dask.config.set(
                {
                    "distributed.nanny.pre-spawn-environ.OPENMM_CPU_THREADS": 1,
                    "distributed.comm.timeouts.connect": "15s",
                }
            )
        )
        if scheduler is None:
            count = workers or os.cpu_count() or 1
            with _deaf_to_interrupts():
                cluster = distributed.LocalCluster(
                    n_workers=min(count, len(points)),
                    threads_per_worker=1,
                    processes=True,
                    dashboard_address=":0",
                    silence_logs=logging.CRITICAL,
                )
            stack.enter_context(cluster)
            client = stack.enter_context(distributed.Client(cluster))
            where = "this machine"
        else:
            stack.enter_context(_silent("distributed.client"))
            client = stack.enter_context(distributed.Client(scheduler))
            where = scheduler
            try:
                client.wait_for_workers(1, timeout=_FIRST_WORKER)
            except (TimeoutError, distributed.TimeoutError):
                raise SweepError(
                    f"sweep: the scheduler at {where} got no worker within {_FIRST_WORKER} s; "
                    f"start some with: dask worker {where} --nthreads 1"
                ) from None
        finished: queue.SimpleQueue = queue.SimpleQueue()
        # Not pure in Dask's sense, or it might hand out what an older version has computed.
        futures = {
            client.submit(_call, payload, point, pure=False): key for key, point in points.items()
        }
        for future in futures:
            future.add_done_callback(finished.put)
        try:
            waiting = dict(futures)
            while waiting:
                try:
                    future = finished.get(timeout=_HEALTH)
                except queue.Empty:
                    _check_health(client, where)
                    continue
                if future.status == "lost":
                    # Its worker died before the result was fetched; Dask computes it again.
                    threading.Thread(
                        target=_put_when_done, args=(finished, future), daemon=True
                    ).start()
                    continue
                key = waiting.pop(future)
                if future.status == "cancelled":
                    raise _lost(where)
                try:
                    error = future.exception()
                    outcome = future.result() if error is None else error
                except OSError:
                    # The connection broke while the result was fetched.
                    raise _lost(where) from None
                yield key, outcome
                # The worker may forget the result now.
                future.release()
        finally:
            with contextlib.suppress(Exception):
                client.cancel(list(waiting), force=True)


def _put_when_done(finished, future):
    """Put a lost future into the queue when it is there again; a callback would come at once."""
    import distributed

    # What a cancelled future raises is seen by who takes it out.
    with contextlib.suppress(BaseException), future.client.as_current():
        distributed.wait(future)
    finished.put(future)


@contextlib.contextmanager
def _deaf_to_interrupts():
    """Processes started in here ignore Ctrl-C, which is for this process; it ends them in order."""
    try:
        before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    except ValueError:
        # Only the main thread may do so, and only it gets interrupts.
        yield
        return
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def timed(function: Any, point: Any) -> Any:
    """The checked result of the function at a point, and the processor time that it took, s.

    It is checked here, where it was computed, so that a bad result is a failure of this point.
    """
    started = time.process_time()
    result = function(**point)
    seconds = time.process_time() - started
    return plain_result(result, name_of(function)), seconds


def name_of(function: Any) -> Any:
    """What a function is called, for messages and keys; of a partial, what is partly applied."""
    while isinstance(function, functools.partial):
        function = function.func
    return getattr(function, "__name__", type(function).__name__)


def _call(payload, point):
    return timed(_loaded(payload), point)


@functools.lru_cache(maxsize=4)
def _loaded(payload):
    return pickle.loads(payload)


def _lost(where):
    return SweepError(f"sweep: lost the scheduler of {where}; run again to go on")


@contextlib.contextmanager
def _silent(name):
    """A logger of Dask, which shows tracebacks of lost connections, says nothing in here."""
    logger = logging.getLogger(name)
    before = logger.level
    logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        logger.setLevel(before)


def _check_health(client, where):
    """Raise SweepError if nothing will ever come any more."""
    if client.status != "running":
        raise _lost(where)
    try:
        workers = client.scheduler_info(n_workers=-1)["workers"]
    except OSError:
        raise _lost(where) from None
    if not workers:
        logger("sweep").warning("sweep: %s has no worker left; waiting for one", where)


def _by_value(function):
    """The function as bytes; one of a script, or of a module beside it, travels as a whole.

    Functions of packages stay references: packages are large, and installed where the workers are.
    """
    import cloudpickle

    module = sys.modules.get(getattr(function, "__module__", None))
    beside = _modules_beside(module)
    for other in beside:
        cloudpickle.register_pickle_by_value(other)
    try:
        return cloudpickle.dumps(function)
    finally:
        for other in beside:
            cloudpickle.unregister_pickle_by_value(other)


def _modules_beside(module):
    """The module and its neighbours in the folder, if it belongs to no package; without a script.

    What a script defines goes by value anyway.
    """
    file = getattr(module, "__file__", None)
    if file is None or getattr(module, "__package__", None):
        return []
    folder = Path(file).resolve().parent
    return [
        other
        for other in list(sys.modules.values())
        if getattr(other, "__file__", None)
        and not getattr(other, "__package__", None)
        and other.__name__ not in ("__main__", "__mp_main__")
        and Path(other.__file__).resolve().parent == folder
    ]
