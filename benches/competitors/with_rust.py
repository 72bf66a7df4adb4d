"""Evaluations of the forces alone, as `cargo bench` has timed them (`benches/evaluate.rs`)."""

import json
import os
import time
from pathlib import Path

__all__ = ["Evaluations", "read"]

_ROOT = Path(__file__).resolve().parents[2]


class Evaluations:
    """Least microseconds of an evaluation: `cost[scheme, evaluator, N]`, and when they were taken.

    The plain evaluation, called "plain, 1 thread", is the readable reference: an edge list, atan2.
    """

    def __init__(self, cost, newest):
        self.cost = cost
        self.newest = newest

    @property
    def age(self):
        """Seconds since the last of them was measured."""
        return time.time() - self.newest


def read():
    """What criterion has left in cargo's target folder; None if there is nothing."""
    target = Path(os.environ.get("CARGO_TARGET_DIR", _ROOT / "target"))
    cost, newest = {}, 0.0
    for path in (target / "criterion").glob("*/*/*/new/benchmark.json"):
        name = json.loads(path.read_text(encoding="utf-8"))
        sample_path = path.with_name("sample.json")
        sample = json.loads(sample_path.read_text(encoding="utf-8"))
        # Each sample is the time of so many iterations, in ns.
        runs = zip(sample["times"], sample["iters"], strict=True)
        key = name["group_id"], name["function_id"], int(name["value_str"])
        cost[key] = min(total / count for total, count in runs) / 1000
        newest = max(newest, sample_path.stat().st_mtime)
    return Evaluations(cost, newest) if cost else None
