//! Potentials of the dihedral angles φ between neighbouring triangles: Σ_edges K f(φ − φ₀), with K the
//! stiffness and φ₀ the angle at rest, both of which each edge can have for itself. With x = φ − φ₀, brought into (−π, π],
//! and c = 1 − cos x,
//!
//! | form | f | source |
//! | --- | --- | --- |
//! | `Quartic` | c², about x⁴ / 4 | the paper's potential of fourth order (VCM `smoothTheta4`) |
//! | `Cosine` | c, about x² / 2 | Kantor and Nelson (B5) (VCM `cosine`) |
//! | `Exp` | ½ (e^{2c} − 1) | VCM `exp` |
//! | `SmoothExp` | 0.04 (e^{10c} − 1) | VCM `smoothExp` |
//! | `SmoothExp46` | ½ (e^{2c} − 1 − x²) | VCM `smoothExp46` |
//!
//! (B5): doi:10.1103/PhysRevE.108.015301. Angles at rest: Kantor and Nelson, doi:10.1103/PhysRevLett.58.2774; for red cells
//! Fedosov, Caswell and Karniadakis, doi:10.1016/j.bpj.2010.02.002, equation (6).

use super::codes::Form;
use super::{
    Contribution, Domain, EdgeFormula, Edges, Element, Needs, Parameter, Potential, Sums, Term,
};
use std::f64::consts::{PI, TAU};
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
        const {
            &[
                Parameter::new(c"stiffness", 1, 0, Domain::NonNegative).per(Element::Edge),
                Parameter::new(c"restAngle", 0, 0, Domain::Angle).or(0.0).per(Element::Edge).last(),
            ]
        }
    }

    fn forms(&self) -> Option<(&'static CStr, &'static [&'static CStr])> {
        Some((c"form", Form::NAMES))
    }

    fn needs(&self, _: &Term) -> Needs {
        Needs::EDGES
    }

    fn edges(&self, term: &Term, run: Edges) -> Contribution {
        let function = function(Form::ALL[term.form]);
        if term.vanishes(1) && term.is_scalar(0) {
            return run.apply(&Flat { stiffness: term.values[0], function });
        }
        run.apply_to_each(term, &Hinge { term, function })
    }
}

/// Hinges that are all alike and at rest when flat.
struct Flat {
    stiffness: f64,
    function: Function,
}

impl EdgeFormula for Flat {
    fn apply(&self, _: u32, angle: f64) -> (Sums<f64>, f64) {
        let (value, slope) = (self.function)(angle);
        let slope = self.stiffness * slope;
        (Sums { energy: self.stiffness * value, by_parameter: [value, -slope] }, slope)
    }
}

/// Hinges with angles at rest, or a stiffness of their own.
struct Hinge<'a> {
    term: &'a Term<'a>,
    function: Function,
}

impl EdgeFormula for Hinge<'_> {
    fn apply(&self, edge: u32, angle: f64) -> (Sums<f64>, f64) {
        let [stiffness, rest] = [0, 1].map(|parameter| self.term.value(parameter, edge as usize));
        let (value, slope) = (self.function)(around(angle - rest));
        let slope = stiffness * slope;
        (Sums { energy: stiffness * value, by_parameter: [value, -slope] }, slope)
    }
}

/// The same angle in (−π, π], of one in (−2π, 2π].
fn around(angle: f64) -> f64 {
    if angle > PI {
        angle - TAU
    } else if angle <= -PI {
        angle + TAU
    } else {
        angle
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forms_have_their_energies_and_partials() {
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
    fn angles_at_rest_are_minima_and_go_round() {
        for (form, _) in Form::ALL.iter().enumerate() {
            let term = Term::new("DihedralForce", form, &[2.0, 3.0]).unwrap();
            let hinge = Hinge { term: &term, function: function(Form::ALL[form]) };
            let (sums, slope) = hinge.apply(0, 3.0);
            assert_eq!((sums.energy, slope), (0.0, 0.0));
            // 0.2 beyond, and 0.2 short of it: −3.0832 is 3.2.
            let (beyond, short) = (hinge.apply(0, 3.2 - TAU), hinge.apply(0, 2.8));
            assert!(short.0.energy > 0.0 && short.1 < 0.0);
            assert!((beyond.0.energy / short.0.energy - 1.0).abs() < 1e-12);
            assert!((beyond.1 / short.1 + 1.0).abs() < 1e-12);
            let h = 1e-6;
            let moved = |h: f64| {
                let term = Term::new("DihedralForce", form, &[2.0, 3.0 + h]).unwrap();
                Hinge { term: &term, function: hinge.function }.apply(0, 2.0).0.energy
            };
            let difference = (moved(h) - moved(-h)) / (2.0 * h);
            let by_rest = hinge.apply(0, 2.0).0.by_parameter[1];
            assert!((by_rest - difference).abs() < 1e-7 * by_rest.abs());
        }
    }

    #[test]
    fn small_angles_lose_no_digits() {
        let angle: f64 = 1e-5;
        assert!((quartic(angle).0 / (angle.powi(4) / 4.0) - 1.0).abs() < 1e-9);
        assert!((cosine(angle).0 / (angle * angle / 2.0) - 1.0).abs() < 1e-10);
    }
}
