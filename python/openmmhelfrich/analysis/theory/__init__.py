"""The theory of nearly spherical vesicles, r(θ, φ) = r0 [1 + Σ u_lm Y_lm(θ, φ)].

Farnudi, Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023),
doi:10.1103/PhysRevE.108.015301; the numbers in brackets are its equations. Lengths are in nm,
times in ps, masses in amu, energies in kJ/mol; a ratio to kBT has no unit. All functions work
element by element on arrays, which broadcast against each other; `mode_area`, `mode_volume` and
`mode_energy` sum over modes, `area_excess` up to one lmax. They take plain numbers, and raise a
TypeError for Quantities.
"""

from .deformations import area_energy, bending_energy, volume_energy
from .dynamics import (
    brownian_autocorrelation,
    internal_friction,
    langevin_autocorrelation,
    mode_frequency,
    mode_period,
    newtonian_autocorrelation,
    overdamped_time,
)
from .mode_sums import mode_area, mode_energy, mode_volume
from .spectra import (
    area_excess,
    elastic_spectrum,
    fluid_spectrum,
    stiffness,
    tense_spectrum,
    young_modulus,
)

# Boltzmann's constant, kJ/mol/K (exact since the SI of 2019).
BOLTZMANN = 8.31446261815324e-3

__all__ = [
    "BOLTZMANN",
    "area_energy",
    "area_excess",
    "bending_energy",
    "brownian_autocorrelation",
    "elastic_spectrum",
    "fluid_spectrum",
    "internal_friction",
    "langevin_autocorrelation",
    "mode_area",
    "mode_energy",
    "mode_frequency",
    "mode_period",
    "mode_volume",
    "newtonian_autocorrelation",
    "overdamped_time",
    "stiffness",
    "tense_spectrum",
    "volume_energy",
    "young_modulus",
]
