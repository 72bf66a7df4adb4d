"""The nearest minimum of a function under equality constraints, by Newton's method.

Sequential quadratic programming (Nocedal and Wright, *Numerical Optimization*, 2nd ed.,
doi:10.1007/978-0-387-40065-5, ch. 18) with the whole Hessian of the Lagrangian. It stays near its
start, which methods that build a Hessian of the gradients on their way do not: those may leap over
a ridge, to where a discretised energy means nothing.
"""

import numpy as np

STEP = 1e-5
"""Of the differences of gradients that make the Hessian."""

LONGEST = 0.5
"""Most that a variable changes in an iteration."""


def minimum(function, constraints, start, allowed, accuracy=1e-11, flatness=1e-7, iterations=200):
    """Find a minimum near a start.

    Parameters
    ----------
    function : callable
        Of the variables, shape (n,): a number and its gradient, shape (n,).
    constraints : callable
        Of the variables: what has to be zero, shape (k,), and its gradients, shape (k, n).
    start : array_like, shape (n,)
    allowed : callable
        Whether the function means something at the variables.
    accuracy, flatness : float
        What remains of the constraints, and of the gradient along them.
    iterations : int
        The most.

    Returns
    -------
    ndarray, shape (n,)

    Raises
    ------
    RuntimeError
        No minimum was found; the message says what remained, or that it is a saddle.
    """
    x = np.array(start, dtype=float)
    penalty = 0.0
    for _ in range(iterations):
        gradient = function(x)[1]
        values, gradients = constraints(x)
        # Rows that span the constraints' gradients, and what is orthogonal to them.
        q, r = np.linalg.qr(gradients.T, mode="complete")
        count = len(values)
        across, along, r = q[:, :count], q[:, count:], r[:count]
        multipliers = np.linalg.solve(r, across.T @ gradient)
        slope = along.T @ gradient
        remains = f"constraints off by {np.abs(values).max():.1g}, slope {np.abs(slope).max():.1g}"

        def onto(values, r=r, across=across):
            """The least step that meets the constraints where they are linear."""
            return -across @ np.linalg.solve(r.T, values)

        hessian = _hessian(function, constraints, x, multipliers)
        if np.abs(values).max() < accuracy and np.abs(slope).max() < flatness:
            _require_minimum(along.T @ hessian @ along)
            return x
        step = onto(values)
        step = step + along @ _downhill(
            along.T @ hessian @ along, slope + along.T @ (hessian @ step)
        )
        penalty = max(penalty, 2 * np.abs(multipliers).max())
        x = _searched(function, constraints, x, step, onto, penalty, allowed)
        if x is None:
            raise RuntimeError(f"no step leads down: {remains}")
    raise RuntimeError(f"no minimum after {iterations} iterations: {remains}")


def _hessian(function, constraints, x, multipliers):
    """The Hessian of the Lagrangian, by central differences of its gradient."""

    def gradient(y):
        return function(y)[1] - multipliers @ constraints(y)[1]

    rows = [(gradient(x + each) - gradient(x - each)) for each in STEP * np.eye(len(x))]
    return (np.array(rows) + np.array(rows).T) / (4 * STEP)


def _require_minimum(hessian):
    """Refuse a saddle or a maximum, where a symmetric start ends."""
    curvatures = np.linalg.eigvalsh(hessian)
    if curvatures[0] < -1e-6 * np.abs(curvatures).max():
        raise RuntimeError(
            f"a stationary point, but no minimum: a curvature is {curvatures[0]:.3g}; start beside "
            "it"
        )


def _downhill(hessian, slope):
    """Newton's step, which turns round where the curvature is negative."""
    curvatures, directions = np.linalg.eigh(hessian)
    sizes = np.abs(curvatures)
    return -directions @ ((directions.T @ slope) / np.maximum(sizes, 1e-6 * sizes.max()))


def _searched(function, constraints, x, step, onto, penalty, allowed):
    """Where along a step, or beside it on the constraints, things get better; None if nowhere."""

    def merit(y):
        return function(y)[0] + penalty * np.abs(constraints(y)[0]).sum() if allowed(y) else np.inf

    least = merit(x) + 1e-12
    share = min(1.0, LONGEST / np.abs(step).max())
    while share > 1e-6:
        straight = x + share * step
        if merit(straight) < least:
            return straight
        bent = straight + onto(constraints(straight)[0])
        if merit(bent) < least:
            return bent
        share /= 2
    return None
