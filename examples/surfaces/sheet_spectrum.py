"""Undulations of a periodic sheet at a given tension, beside kBT / (κ q⁴ + σ q²).

The sheet spans its box, and its frame fluctuates: every 50 steps a Monte Carlo move scales x and y
of box and vertices at the tension σ (isotropic; accepted with min(1, exp −[ΔE − σ ΔA_p − N kBT ln
A_p'/A_p] / kBT), A_p the area of the frame). The area A of the surface itself is kept. Then σ is
the tension that undulations feel, and that of the frame (Farago and Pincus,
doi:10.1140/epje/e2004-00044-y).

h_q = ∫ h(r) exp(−i q·r) d²r / A_p is taken over the triangles, by the middles of their sides. A
regular triangular lattice of edge l has, instead of q², Λ(q) = (2/3l²) Σ (1 − cos q·a) over its six
neighbours a, in both of its terms (Jülicher's curvature of nearly flat equilateral triangles is
this Laplacian), and of a wave the integral sees F(q) = ⟨cos q·a/2⟩, the mean over a. Waves are
waves in the frame, q = 2π (m/Lx, n/Ly), and the frame is smaller than the surface by the area that
undulations take up, 1.2 to 1.7 %; so l is that of a lattice that fills the mean frame. Shorter
undulations soften longer ones, κ(q) = κ − (3 kBT/4π) ln(q_m/q), q_m² = 4π N / A (Peliti and
Leibler, doi:10.1103/PhysRevLett.54.1690). So

    kBT F² / (A_p ⟨|h_q|²⟩) = κ(q) Λ² + σ Λ

with one κ for all modes up to (q l)² = 0.25, fitted; "κ_flat" is without the logarithm. The tension
is measured too, from the virial W and the momenta: τ = ⟨W_xx + W_yy⟩ / 2A_p − N kBT / A_p. Meshes
that keep their neighbours resist shear, and so are a little stiffer at long waves.
"""

import numpy as np
import openmm
from membranes import KBT, TEMPERATURE, box_of, context_of, energy_of, positions_of, strained
from openmmhelfrich import (
    BendingForce,
    Mesh,
    MonteCarloBondFlip,
    SurfaceAreaForce,
    TriangleHeightForce,
    virial,
)
from openmmhelfrich.analysis import mean_with_error
from reports import Report

VERSION = 1
SPACING = 100.0  # nm
RIGIDITY = 20.0  # kBT
SOFTNESS = 0.33  # Ξ
TIME_STEP = 1.3  # ps
EVERY = 50  # steps between moves of the frame
MODES = 8  # along each axis


def fluctuate(size, tension, flips, periods, seed):
    """Undulations of a sheet of size × size vertices.

    Parameters
    ----------
    size : int
    tension : float
        σ, as the square of the number of waves in the box where it equals the bending: q² = σ/κ.
    flips : float
        Attempts per edge in 10 steps; 0 for none.
    periods : float
        Length of the run in periods of the longest wave without tension.
    seed : int

    Returns
    -------
    dict
        "square" A_p |h_q|², nm⁴, shape (num_frames, MODES + 1, 2 MODES + 1); "frame" A_p, nm²;
        "tau", kBT/nm²; and scalars.
    """
    mesh = Mesh.sheet(size, size, SPACING, periodic=True)
    kappa = RIGIDITY * KBT
    longest = 2 * np.pi / (size * SPACING)
    sigma = kappa * tension * longest**2
    omega = longest**2 * np.sqrt(kappa * mesh.area / mesh.num_vertices / 50.0)
    forces = [
        BendingForce(mesh, kappa),
        SurfaceAreaForce(mesh, 1.3, mesh.area),
        TriangleHeightForce(mesh, mesh.min_height(SOFTNESS), 4 * KBT),
    ]
    if flips:
        forces.append(MonteCarloBondFlip(mesh, TEMPERATURE, 10, flips))
        forces[-1].setRandomNumberSeed(seed)
    integrator = openmm.LangevinMiddleIntegrator(TEMPERATURE, 2 * omega, TIME_STEP)
    integrator.setRandomNumberSeed(seed)
    context = context_of(mesh, forces, integrator)
    context.setVelocitiesToTemperature(TEMPERATURE, seed)
    frame = Frame(context, sigma, mesh.num_vertices, seed)
    steps = round(2 * np.pi / omega / TIME_STEP / 10)
    run = {"square": [], "frame": [], "tau": []}
    # Three periods of ten frames each come before.
    for count in range(-30, round(10 * periods)):
        for _ in range(max(1, steps // EVERY)):
            integrator.step(EVERY)
            frame.move(settling=count < 0)
        if count >= 0:
            now = forces[0].getTrianglesInContext(context)
            surface = Mesh(positions_of(context), now, box_of(context))
            run["square"].append(frame.area * abs(amplitudes(surface)) ** 2)
            run["frame"].append(frame.area)
            run["tau"].append(frame.tension() / KBT)
    found = {name: np.array(values) for name, values in run.items()}
    scalars = {"sigma": sigma / KBT, "acceptance": frame.accepted / frame.tried}
    return found | scalars | {"box": mesh.box, "vertices": mesh.num_vertices}


class Frame:
    """The Monte Carlo move of the frame, and the tension that it has."""

    def __init__(self, context, tension, num_vertices, seed):
        self.context, self.imposed, self.count = context, tension, num_vertices
        self.random = np.random.default_rng(seed)
        self.step = 1e-4
        self.tried = self.accepted = 0

    @property
    def area(self):
        """A_p, nm²."""
        (a, _, _), (_, b, _), _ = box_of(self.context)
        return a * b

    def move(self, settling):
        """Try to scale x and y by 1 + ε; while it settles, find the width of ε."""
        positions, box = positions_of(self.context), box_of(self.context)
        before, area = energy_of(self.context), self.area
        strain = self.random.uniform(-self.step, self.step)
        strained(self.context, (strain, strain, 0))
        cost = energy_of(self.context) - before - self.imposed * (self.area - area)
        cost -= self.count * KBT * np.log(self.area / area)
        accepted = self.random.random() < np.exp(-max(0, cost) / KBT)
        if not accepted:
            self.context.setPeriodicBoxVectors(*box)
            self.context.setPositions(positions)
        if settling:
            self.step *= 1.02 if accepted else 0.98
        else:
            self.tried += 1
            self.accepted += accepted

    def tension(self):
        """τ = (W_xx + W_yy) / 2A_p − N kBT / A_p at this moment, kJ/mol/nm²."""
        stretching = np.diag(virial(self.context))[:2].mean()
        return (stretching - self.count * KBT) / self.area


def amplitudes(mesh):
    """h_q for q = 2π (m/Lx, n/Ly), m = 0 … MODES, n = −MODES … MODES, of a rectangular box, nm.

    Triangles are taken by the middles of their sides, which is exact for quadratic functions.
    """
    corners = mesh.corner_positions
    middles = (corners + np.roll(corners, -1, axis=1)) / 2
    sides = corners[:, 1:, :2] - corners[:, :1, :2]
    areas = (sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]) / 2
    # One wrapped corner is nearest to the others, so heights need no unfolding but of the mean.
    height = middles[:, :, 2] - (areas @ middles[:, :, 2].mean(axis=1)) / areas.sum()
    weights = (areas[:, np.newaxis] / 3 * height).ravel()
    width, depth = mesh.box[0, 0], mesh.box[1, 1]
    along, across = (
        np.exp(-2j * np.pi / size * middles[:, :, axis].reshape(-1, 1) * modes)
        for axis, size, modes in (
            (0, width, np.arange(MODES + 1)),
            (1, depth, np.arange(-MODES, MODES + 1)),
        )
    )
    return (along * weights[:, np.newaxis]).T @ across / (width * depth)


def dispersion(size, frame=None):
    """q, Λ, nm⁻², and F of each mode of a lattice, shape (MODES + 1, 2 MODES + 1).

    It fills a frame of some area, nm²; by default that of the undistorted sheet.
    """
    mesh = Mesh.sheet(size, size, SPACING, periodic=True)
    if frame is not None:
        mesh = mesh.scaled((frame / mesh.area) ** 0.5)
    spacing = mesh.box[0, 0] / size
    qx = 2 * np.pi / mesh.box[0, 0] * np.arange(MODES + 1)[:, np.newaxis]
    qy = 2 * np.pi / mesh.box[1, 1] * np.arange(-MODES, MODES + 1)
    angles = np.arange(6) * np.pi / 3
    phases = spacing * (qx[..., None] * np.cos(angles) + qy[..., None] * np.sin(angles))
    laplacian = 2 / (3 * spacing**2) * (1 - np.cos(phases)).sum(axis=-1)
    response = np.cos(phases / 2).mean(axis=-1)
    return np.sqrt(qx**2 + qy**2), laplacian, response


def fitted(run, size):
    """κ with and without the logarithm, and the error of the first, kBT."""
    q, laplacian, response = dispersion(size, run["frame"].mean())
    m, n = np.indices(q.shape)
    # Of q and −q, which are one wave, one; and no q = 0.
    kept = (q * SPACING < 0.5) & ((m > 0) | (n > MODES))
    squares = run["square"][:, kept]
    parts = np.array_split(np.arange(len(squares)), min(8, len(squares)))
    log = softening(run, q)

    def kappa(frames, correction):
        # With the right κ the mean of ⟨|h_q|²⟩ over theory is 1; its inverse would be biased.
        ratio = squares[frames].mean(axis=0) / response[kept] ** 2
        rest = run["sigma"] * laplacian[kept] - correction * laplacian[kept] ** 2
        return (1 - ratio * rest).sum() / (ratio * laplacian[kept] ** 2).sum()

    everything = np.arange(len(squares))
    blocks = [kappa(part, log[kept]) for part in parts]
    found = kappa(everything, log[kept]), kappa(everything, 0.0)
    return *found, np.std(blocks, ddof=1) / len(blocks) ** 0.5


def softening(run, q):
    """(3/4π) ln(q_m/q), kBT, but at q = 0."""
    most = np.sqrt(4 * np.pi * run["vertices"] / run["frame"].mean())
    return 3 / (4 * np.pi) * np.log(most / np.where(q > 0, q, most))


def main():
    report = Report("sheet_spectrum", __doc__, add_arguments, folder="surfaces")
    size = 16 if report.quick else report.options.size
    periods = 6 if report.quick else report.options.periods
    seeds = (1,) if report.quick else (1, 2)
    rows, waves = [], []
    for tension in (0.0, 4.0):
        for flips in (0.1, 0.0):
            points = [
                {"size": size, "tension": tension, "flips": flips, "periods": periods, "seed": seed}
                for seed in seeds
            ]
            runs = report.runs(fluctuate, points, VERSION)
            if not runs:
                continue
            run = runs[0] | {
                name: np.concatenate([each[name] for each in runs])
                for name in ("square", "frame", "tau")
            }
            kappa, flat, error = fitted(run, size)
            tau = mean_with_error(run["tau"])
            excess = 1 - run["frame"].mean() / (run["box"][0, 0] * run["box"][1, 1])
            unit = RIGIDITY / SPACING**2
            rows.append(
                (
                    *(size, tension, "flips" if flips else "fixed", kappa, error, flat),
                    *(run["sigma"] / unit, tau.mean / unit, tau.error / unit, excess),
                    run["acceptance"],
                )
            )
            waves += spectrum_rows(run, size, tension, flips)
    columns = "size waves bonds κ error κ_flat σl²/κ τl²/κ error_τ excess acceptance"
    report.table(columns.split(), rows)
    report.table(["waves", "bonds", "ql", "ratio", "error"], waves, "_modes")
    if report.options.picture:
        draw(waves, report.options.picture)


def spectrum_rows(run, size, tension, flips):
    """⟨|h_q|²⟩ over kBT F² / A_p (κ(q) Λ² + σ Λ) with the κ of the input, in shells of q."""
    q, laplacian, response = dispersion(size, run["frame"].mean())
    m, n = np.indices(q.shape)
    half = (m > 0) | (n > MODES)
    softened = RIGIDITY - softening(run, q)
    theory = response**2 / np.where(q > 0, softened * laplacian**2 + run["sigma"] * laplacian, 1)
    ratio = run["square"] / theory
    shells = np.round(q / q[1, MODES]).astype(int)
    rows = []
    for shell in range(1, MODES + 1):
        some = ratio[:, half & (shells == shell)].mean(axis=1)
        mean = mean_with_error(some)
        name = "flips" if flips else "fixed"
        rows.append((tension, name, 2 * np.pi * shell / size, mean.mean, mean.error))
    return rows


def add_arguments(parser):
    from pathlib import Path

    parser.add_argument("--size", type=int, default=64, help="vertices along each side")
    parser.add_argument("--periods", type=float, default=20.0, help="of the longest wave")
    parser.add_argument("--picture", type=Path, help="PNG to draw")


def draw(waves, path):
    """Ratios against q l."""
    import matplotlib.pyplot as plt

    page, axes = plt.subplots(figsize=(5.5, 3.4), layout="constrained")
    for place, (tension, bonds) in enumerate(dict.fromkeys(row[:2] for row in waves)):
        ql, ratio, error = np.array([row[2:] for row in waves if row[:2] == (tension, bonds)]).T
        axes.errorbar(
            ql * (1 + 0.01 * place), ratio, error, fmt="o-" if bonds == "flips" else "s--", lw=0.8,
            ms=4, mfc=f"C{place}" if bonds == "flips" else "white", color=f"C{place}",
            label=f"{bonds}, {'σ > 0' if tension else 'σ = 0'}",
        )  # fmt: skip
    axes.axhline(1, color="black", lw=0.8)
    axes.set(xlabel="q l", ylabel="⟨|h_q|²⟩ / theory", ylim=(0, 1.6))
    axes.legend(fontsize=7)
    page.savefig(path, dpi=110)


if __name__ == "__main__":
    main()
