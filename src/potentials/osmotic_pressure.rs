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

    fn at(values: [f64; 3], volume: f64) -> (Contribution, f64) {
        let term = Term::new("OsmoticPressureForce", 0, &values).unwrap();
        let (totals, mut partials) =
            (Totals { volume, ..Totals::default() }, TotalPartials::default());
        (OsmoticPressure.totals(&term, &totals, &mut partials), partials.volume)
    }

    #[test]
    fn derivatives_are_exact() {
        let (values, volume) = ([1e4, 0.1, 2.5], 1.3e5);
        let (found, slope) = at(values, volume);
        let central = |f: &dyn Fn(f64) -> f64| (f(1e-5) - f(-1e-5)) / 2e-5;
        let by_volume = central(&|h| at(values, volume * (1.0 + h)).0.energy) / volume;
        assert!((slope / by_volume - 1.0).abs() < 1e-8);
        for k in 0..3 {
            let energy = |h: f64| {
                let mut moved = values;
                moved[k] *= 1.0 + h;
                at(moved, volume).0.energy
            };
            let expected = central(&energy) / values[k];
            assert!((found.by_parameter[k] / expected - 1.0).abs() < 1e-8, "{k}");
        }
    }

    #[test]
    fn small_differences_keep_their_digits() {
        for d in [1e-12_f64, -1e-9, 1e-5, -1e-4] {
            let expected = d * d * (0.5 - d / 3.0 + d * d / 4.0 - d.powi(3) / 5.0);
            assert!((less_logarithm(d) / expected - 1.0).abs() < 1e-14, "{d}");
        }
        for d in [0.249_f64, -0.249, 0.1, -0.1] {
            assert!((less_logarithm(d) - (d - d.ln_1p())).abs() < 1e-16, "{d}");
        }
    }

    #[test]
    fn a_surface_without_volume_has_no_energy() {
        for volume in [0.0, -1e5] {
            let (found, slope) = at([1e4, 0.1, 2.5], volume);
            assert!(!found.energy.is_finite() && !slope.is_finite(), "{volume}");
        }
    }
}
