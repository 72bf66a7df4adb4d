"""A scheduler of Dask and its workers, for tests that lose some of them."""

import contextlib
import json
import os
import subprocess
import sys
import time


@contextlib.contextmanager
def dask_cluster(folder, num_workers):
    """A scheduler and workers as a user starts them, each a process of its own on loopback."""
    import distributed

    file = folder / "scheduler.json"
    # A worker that was killed is looked for that long, by default half a minute.
    environment = dict(os.environ, DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT="10s")
    common = {
        "stdout": subprocess.DEVNULL,
        "stderr": subprocess.DEVNULL,
        "cwd": folder,
        "env": environment,
    }
    dask = [sys.executable, "-m", "dask"]
    processes = [
        subprocess.Popen(
            [
                *dask,
                "scheduler",
                "--host",
                "127.0.0.1",
                "--port",
                "0",
                "--no-dashboard",
                "--scheduler-file",
                str(file),
            ],
            **common,
        )
    ]
    try:
        address = None
        for _ in range(1200):
            with contextlib.suppress(FileNotFoundError, json.JSONDecodeError):
                address = json.loads(file.read_text())["address"]
                break
            time.sleep(0.1)
        assert address, "the scheduler did not start"
        for _ in range(num_workers):
            command = [*dask, "worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard"]
            processes.append(subprocess.Popen(command, **common))
        # All of them, so that none has done the work when another one comes.
        with distributed.Client(address) as client:
            client.wait_for_workers(num_workers, timeout=120)
        yield address, processes[0], processes[1:]
    finally:
        for process in processes:
            process.kill()
        for process in processes:
            process.wait()
