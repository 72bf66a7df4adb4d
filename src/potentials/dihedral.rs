//! Potentials of the dihedral angles φ between neighbouring triangles: Σ_edges K f(φ), with K the
//! stiffness. With c = 1 − cos φ,
//!
//! | form | f | source |
//! | --- | --- | --- |
//! | `Quartic` | c², about φ⁴ / 4 | the paper's potential of fourth order (VCM `smoothTheta4`) |
//! | `Cosine` | c, about φ² / 2 | Kantor and Nelson (B5) (VCM `cosine`) |
//! | `Exp` | ½ (e^{2c} − 1) | VCM `exp` |
//! | `SmoothExp` | 0.04 (e^{10c} − 1) | VCM `smoothExp` |
//! | `SmoothExp46` | ½ (e^{2c} − 1 − φ²) | VCM `smoothExp46` |
//!
//! (B5): doi:10.1103/PhysRevE.108.015301.

use super::codes::Form;
use super::{Contribution, Domain, EdgeFormula, Edges, Needs, Parameter, Potential, Sums, Term};
use std::ffi::CStr;

/// Stiffness of hinges, which depends on the mesh as curvature elasticity does not.
pub struct Dihedral;

/// f and f′ as functions of φ.
type Function = fn(f64) -> (f64, f64);

/// 1 − cos φ, without cancellation, and sin φ.
#[inline]
fn versine_and_sine(angle: f64) -> (f64, f64) {
    let (sine, cosine) = (0.5 * angle).sin_cos();
    (2.0 * sine * sine, 2.0 * sine * cosine)
}

fn quartic(angle: f64) -> (f64, f64) {
    let (c, sine) = versine_and_sine(angle);
    (c * c, 2.0 * c * sine)
}

fn cosine(angle: f64) -> (f64, f64) {
    versine_and_sine(angle)
}

fn exp(angle: f64) -> (f64, f64) {
    let (c, sine) = versine_and_sine(angle);
    let growth = (2.0 * c).exp_m1();
    (0.5 * growth, (growth + 1.0) * sine)
}

fn smooth_exp(angle: f64) -> (f64, f64) {
    let (c, sine) = versine_and_sine(angle);
    let growth = (10.0 * c).exp_m1();
    (0.04 * growth, 0.4 * (growth + 1.0) * sine)
}

fn smooth_exp46(angle: f64) -> (f64, f64) {
    let (c, sine) = versine_and_sine(angle);
    let growth = (2.0 * c).exp_m1();
    (0.5 * (growth - angle * angle), (growth + 1.0) * sine - angle)
}

fn function(form: Form) -> Function {
    match form {
        Form::Quartic => quartic,
        Form::Cosine => cosine,
        Form::Exp => exp,
        Form::SmoothExp => smooth_exp,
        Form::SmoothExp46 => smooth_exp46,
    }
}

impl Potential for Dihedral {
    fn name(&self) -> &'static str {
        "DihedralForce"
    }

    fn parameters(&self) -> &'static [Parameter] {
        const { &[Parameter::new(c"stiffness", 1, 0, Domain::NonNegative)] }
    }

    fn forms(&self) -> Option<(&'static CStr, &'static [&'static CStr])> {
        Some((c"form", Form::NAMES))
    }

    fn needs(&self, _: &Term) -> Needs {
        Needs::EDGES
    }

    fn edges(&self, term: &Term, run: Edges) -> Contribution {
        run.apply(&Hinge { stiffness: term.values[0], function: function(Form::ALL[term.form]) })
    }
}

struct Hinge {
    stiffness: f64,
    function: Function,
}

impl EdgeFormula for Hinge {
    fn apply(&self, angle: f64) -> (Sums<f64>, f64) {
        let (value, slope) = (self.function)(angle);
        let sums = Sums { energy: self.stiffness * value, by_parameter: [value, 0.0] };
        (sums, self.stiffness * slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forms_have_their_energies_and_slopes() {
        let expected: [fn(f64) -> f64; 5] = [
            |x| (1.0 - x.cos()).powi(2),
            |x| 1.0 - x.cos(),
            |x| 0.5 * ((2.0 * (1.0 - x.cos())).exp() - 1.0),
            |x| 0.04 * ((10.0 * (1.0 - x.cos())).exp() - 1.0),
            |x| 0.5 * ((2.0 * (1.0 - x.cos())).exp() - 1.0 - x * x),
        ];
        for (form, expected) in Form::ALL.iter().zip(expected) {
            for angle in [-2.9, -1.0, -0.2, 0.3, 0.9, 2.0] {
                let form = function(*form);
                let (value, slope) = form(angle);
                assert!((value - expected(angle)).abs() <= 1e-12 * expected(angle).abs());
                let h = 1e-6;
                let difference = (form(angle + h).0 - form(angle - h).0) / (2.0 * h);
                assert!((slope - difference).abs() < 1e-7 * slope.abs().max(1.0));
            }
        }
    }

    #[test]
    fn small_angles_lose_no_digits() {
        let angle: f64 = 1e-5;
        assert!((quartic(angle).0 / (angle.powi(4) / 4.0) - 1.0).abs() < 1e-9);
        assert!((cosine(angle).0 / (angle * angle / 2.0) - 1.0).abs() < 1e-10);
    }
}
