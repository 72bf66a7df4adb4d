//! Solutes that cannot pass the membrane: E = n kT (x − 1 − ln x) with x = c V / n, for n of them inside and a
//! concentration c outside, as ideal solutions (J. H. van 't Hoff, doi:10.1515/zpch-1887-0151). So −∂E/∂V = kT (n/V − c),
//! the difference of their osmotic pressures, and E is least, and zero, at V = n / c.

use super::{Contribution, Domain, Needs, Parameter, Potential, Term, Total};
use crate::mesh::geometry::{TotalPartials, Totals};

/// The membrane is permeable to water only.
pub struct OsmoticPressure;

impl Potential for OsmoticPressure {
    fn name(&self) -> &'static str {
        "OsmoticPressureForce"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const {
            &[
                Parameter::new(c"solutes", 0, 0, Domain::Positive),
                Parameter::new(c"concentration", 0, -3, Domain::Positive),
                Parameter::new(c"thermalEnergy", 1, 0, Domain::Positive),
            ]
        }
    }

    fn needs(&self, _: &Term) -> Needs {
        Needs::TOTALS
    }

    fn needs_outside(&self) -> bool {
        true
    }

    fn reference(
        &self,
        &Term { values: [solutes, concentration, ..], .. }: &Term,
    ) -> Option<Total> {
        Some(Total::Volume(solutes / concentration))
    }

    fn totals(
        &self,
        &Term { values: [solutes, concentration, thermal_energy, ..], .. }: &Term,
        totals: &Totals,
        partials: &mut TotalPartials,
    ) -> Contribution {
        // x − 1. Without a volume the logarithm is no number, and neither is the energy.
        let excess = concentration / solutes * (totals.volume - solutes / concentration);
        let by_thermal_energy = solutes * less_logarithm(excess);
        // kT c (1 − 1/x)
        partials.volume += thermal_energy * concentration * excess / (1.0 + excess).max(0.0);
        Contribution {
            energy: thermal_energy * by_thermal_energy,
            by_parameter: [
                thermal_energy * (less_logarithm(excess) - excess),
                thermal_energy * excess * solutes / concentration,
                by_thermal_energy,
                0.0,
            ],
        }
    }
}

/// d − ln(1 + d), also where that is a small difference.
fn less_logarithm(d: f64) -> f64 {
    if d.abs() > 0.25 {
        return d - d.ln_1p();
    }
    // ln(1 + d) = 2 artanh s with s = d / (2 + d), and d = 2 s + d s.
    let s = d / (2.0 + d);
    let series = (1..12).rev().fold(0.0, |sum, k| 1.0 / f64::from(2 * k + 1) + s * s * sum);
    s * (d - 2.0 * s * s * series)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_differences_keep_their_digits() {
        for d in [1e-12, -1e-9, 1e-5, -1e-3] {
            let expected = d * d * (0.5 - d / 3.0 + d * d / 4.0 - d.powi(3) / 5.0);
            assert!((less_logarithm(d) / expected - 1.0).abs() < 1e-14, "{d}");
        }
        for d in [0.249_f64, -0.249, 0.1, -0.1] {
            assert!((less_logarithm(d) - (d - d.ln_1p())).abs() < 1e-16, "{d}");
        }
    }

    #[test]
    fn a_surface_without_volume_has_no_energy() {
        let term = Term::new("OsmoticPressureForce", 0, &[1e4, 0.1, 2.5]).unwrap();
        for volume in [0.0, -1e5] {
            let (totals, mut partials) = (Totals { area: 1.0, volume }, TotalPartials::default());
            let found = OsmoticPressure.totals(&term, &totals, &mut partials);
            assert!(!found.energy.is_finite() && !partials.volume.is_finite(), "{volume}");
        }
    }
}
