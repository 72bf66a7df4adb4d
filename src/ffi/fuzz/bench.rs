//! A membrane that is called with anything.

use super::super::*;
use super::wild::{Call, Wild};
use crate::membrane::Membrane;
use crate::mesh::{Topology, Triangulation};
use crate::moves::{FlipRules, FlipState, SwapRules, SwapState};
use crate::potentials::{Contribution, MAX_PARAMETERS, REGISTRY, VertexNumbers};
use proptest::prelude::*;
use std::ffi::c_int;
use std::ptr;

/// What a check comes to.
pub type Checked<T = ()> = std::result::Result<T, TestCaseError>;

/// A call with the terms, positions and box of a bench; what it wants beside these comes last.
macro_rules! with_terms {
    ($function:ident, $bench:ident, $terms:expr $(, $more:expr)*) => {
        unsafe {
            $function(
                c"Fuzz".as_ptr(),
                $bench.membrane,
                $terms.as_ptr(),
                $terms.len() as i64,
                ($bench.positions.len() / 3) as i64,
                $bench.positions.as_ptr(),
                $bench.vectors(),
                $($more,)*
            )
        }
    };
}

/// What a term points to.
pub struct Kept {
    pub field: Vec<f64>,
    pub numbers: *mut VertexNumbers,
}

impl Drop for Kept {
    fn drop(&mut self) {
        unsafe { Helfrich_Numbers_destroy(self.numbers) };
    }
}

/// One membrane and what it is called with.
pub struct Bench {
    pub membrane: *mut Membrane,
    pub positions: Vec<f64>,
    pub vectors: Option<[[f64; 3]; 3]>,
}

impl Drop for Bench {
    fn drop(&mut self) {
        unsafe { Helfrich_Membrane_destroy(self.membrane) };
    }
}

/// A status, and of a failure its message, which names somebody and is no panic's.
pub fn told(status: Status) -> Checked<bool> {
    if status == Status::Success {
        return Ok(true);
    }
    let said = last_error();
    prop_assert_eq!(status, Status::Failure);
    prop_assert!(said.contains(": ") && !said.contains("internal error"), "{}", said);
    Ok(false)
}

impl Bench {
    fn counts(&self) -> [usize; 5] {
        let mesh = unsafe { &*self.membrane }.mesh();
        [mesh.num_vertices(), mesh.triangles().len(), mesh.num_edges(), 2, 7]
    }

    fn inputs(&self, terms: &[Wild]) -> (Vec<TermInput>, Vec<Kept>) {
        let counts = self.counts();
        let mut inputs = Vec::new();
        let mut all = Vec::new();
        for term in terms {
            let cycled =
                |values: &[f64], count| values.iter().copied().cycle().take(count).collect();
            let potential = REGISTRY[term.potential];
            let forms = potential.forms().map_or(1, |(_, names)| names.len());
            let field = term
                .fields
                .as_ref()
                .map_or(Vec::new(), |(_, which, values)| cycled(values, counts[*which]));
            let numbers = term.numbers.as_ref().map_or(ptr::null_mut(), |(fits, values)| {
                let name = std::ffi::CString::new(potential.name()).unwrap();
                let mut called = ptr::null();
                let width =
                    unsafe { Helfrich_Potential_numbers(name.as_ptr(), &mut called) } as usize;
                let count = if *fits { width * counts[0] } else { values.len() };
                let values: Vec<f64> = cycled(values, count);
                let length = values.len() as i64;
                unsafe {
                    Helfrich_Numbers_create(ptr::null(), values.as_ptr(), length, ptr::null())
                }
            });
            let kept = Kept { field, numbers };
            let mut fields = [ptr::null(); MAX_PARAMETERS];
            let mut field_lengths = [0; MAX_PARAMETERS];
            if let Some((place, ..)) = term.fields {
                fields[place] = kept.field.as_ptr();
                field_lengths[place] = kept.field.len() as i64;
            }
            inputs.push(TermInput {
                potential: term.potential as c_int,
                form: (term.form % forms) as c_int,
                switches: term.switches & ((1 << potential.switches().len()) - 1),
                wants_derivatives: term.derivatives.into(),
                values: term.values,
                fields,
                field_lengths,
                particles: term.particles.as_ptr().cast(),
                num_particles: term.particles.len() as i64,
                numbers: kept.numbers.cast(),
            });
            all.push(kept);
        }
        (inputs, all)
    }

    /// Terms, as a Context checks them before it uses them.
    fn checked(&self, terms: &[Wild]) -> Checked<(Vec<TermInput>, Vec<Kept>)> {
        let (inputs, kept) = self.inputs(terms);
        let mut good = Vec::new();
        for input in inputs {
            let subject = c"Fuzz".as_ptr();
            let fits =
                told(unsafe { Helfrich_Membrane_checkTerm(subject, self.membrane, &input) })?;
            let exist =
                told(unsafe { Helfrich_Membrane_checkParticles(subject, self.membrane, &input) })?;
            if fits && exist {
                good.push(input);
            }
        }
        Ok((good, kept))
    }

    fn vectors(&self) -> *const f64 {
        self.vectors.as_ref().map_or(ptr::null(), |vectors| vectors.as_flattened().as_ptr())
    }

    fn triangles(&self) -> Vec<[c_int; 3]> {
        let mut corners = vec![[0; 3]; self.counts()[1]];
        unsafe { Helfrich_Membrane_triangles(self.membrane, corners.as_mut_ptr().cast()) };
        corners
    }

    /// Its triangles are those of a surface, which has the numbers that it says.
    pub fn is_whole(&self) -> Checked {
        let corners: Vec<_> = self.triangles().iter().map(|t| t.map(i64::from)).collect();
        let again = Topology::new(&corners, 1 << 31);
        prop_assert!(again.is_ok(), "{:?}", again.err());
        let again = Triangulation::new(&again.unwrap());
        let mesh = unsafe { &*self.membrane }.mesh();
        prop_assert_eq!(again.degrees(), mesh.degrees());
        prop_assert_eq!(again.num_edges(), mesh.num_edges());
        prop_assert_eq!(again.fingerprint(), mesh.fingerprint());
        Ok(())
    }

    /// Make a call, and check what it leaves.
    pub fn make(&mut self, call: &Call) -> Checked {
        let (subject, membrane) = (c"Fuzz".as_ptr(), self.membrane);
        match call {
            Call::Evaluate { terms, energies, forces } => {
                let (terms, _kept) = self.checked(terms)?;
                let mut sums: Vec<_> = terms.iter().map(|_| Contribution::default()).collect();
                let mut gradient = vec![0.0; self.positions.len()];
                let status = with_terms!(
                    Helfrich_Membrane_evaluate,
                    self,
                    terms,
                    if *energies { sums.as_mut_ptr() } else { ptr::null_mut() },
                    if *forces { gradient.as_mut_ptr() } else { ptr::null_mut() }
                );
                if told(status)? && *energies {
                    prop_assert!(sums.iter().all(|sum| sum.energy.is_finite()), "{:?}", sums);
                }
            }
            Call::Virial(terms) => {
                let (terms, _kept) = self.checked(terms)?;
                let mut virial = [0.0; 9];
                told(with_terms!(Helfrich_Membrane_addVirial, self, terms, virial.as_mut_ptr()))?;
            }
            Call::Check(term) => {
                let (inputs, _kept) = self.inputs(std::slice::from_ref(term));
                told(unsafe { Helfrich_Membrane_checkTerm(subject, membrane, &inputs[0]) })?;
            }
            Call::Flip { terms, rules, attempts, demon, change } => {
                let (temperature, min_degree, max_degree, max_edge_length, is_demon) = *rules;
                let rules = FlipRules {
                    temperature,
                    min_degree,
                    max_degree,
                    max_edge_length,
                    demon: is_demon,
                };
                let (terms, _kept) = self.checked(terms)?;
                if !told(unsafe { Helfrich_Membrane_checkFlips(subject, membrane, &rules) })? {
                    return Ok(());
                }
                let mut state =
                    FlipState { key: [7, 9], demon_energy: *demon, ..FlipState::default() };
                let (mut made, mut forces) = (0, vec![0.0; self.positions.len()]);
                told(with_terms!(
                    Helfrich_Membrane_flip,
                    self,
                    terms,
                    &rules,
                    *attempts,
                    &mut state,
                    &mut made,
                    if *change { forces.as_mut_ptr() } else { ptr::null_mut() },
                    ptr::null(),
                    0
                ))?;
                self.is_whole()?;
            }
            Call::Swap { terms, rules, attempts, kinds, demon } => {
                let rules = SwapRules { temperature: rules.0, demon: rules.1 };
                let (terms, _kept) = self.checked(terms)?;
                let mut state =
                    SwapState { key: [3, 5], demon_energy: *demon, ..SwapState::default() };
                let (mut made, mut sources) = (0, vec![0; kinds.len()]);
                let mut forces = vec![0.0; self.positions.len()];
                let fine = told(with_terms!(
                    Helfrich_Membrane_swap,
                    self,
                    terms,
                    &rules,
                    *attempts,
                    &mut state,
                    kinds.as_ptr(),
                    sources.as_mut_ptr(),
                    Helfrich_Numbers_takeVersion(),
                    &mut made,
                    forces.as_mut_ptr()
                ))?;
                if fine {
                    let count = self.counts()[0];
                    let mut met = sources[..count].to_vec();
                    met.sort_unstable();
                    prop_assert_eq!(met, (0..count as u32).collect::<Vec<_>>());
                }
            }
            Call::SetTriangles(changes) => {
                let (before, corners) = (self.triangles(), self.changed(changes));
                let count = corners.len() as i64;
                let status = unsafe {
                    Helfrich_Membrane_setTriangles(
                        subject,
                        membrane,
                        corners.as_ptr().cast(),
                        count,
                    )
                };
                let expected = if told(status)? { corners } else { before };
                prop_assert_eq!(self.triangles(), expected);
            }
            Call::Restore { corners, order, flips } => {
                let (before, corners) = (self.triangles(), self.changed(corners));
                let count = self.counts()[0];
                let mut present = vec![0; count];
                unsafe { Helfrich_Membrane_order(membrane, present.as_mut_ptr()) };
                for (place, vertex) in order {
                    present[place % count] = *vertex;
                }
                let status = unsafe {
                    let corners = corners.as_ptr().cast();
                    Helfrich_Membrane_restore(subject, membrane, corners, present.as_ptr(), *flips)
                };
                let expected = if told(status)? { corners } else { before };
                prop_assert_eq!(self.triangles(), expected);
            }
            Call::Move(changes) => {
                let count = self.positions.len();
                changes.iter().for_each(|(place, value)| self.positions[place % count] = *value);
            }
            Call::Coincide(one, other) => {
                let count = self.positions.len() / 3;
                let (from, to) = (3 * (one % count), 3 * (other % count));
                self.positions.copy_within(from..from + 3, to);
            }
            Call::Scale(factor) => self.positions.iter_mut().for_each(|x| *x *= factor),
            Call::Box(vectors) => {
                let rows =
                    |v: &[f64; 9]| [[v[0], v[1], v[2]], [v[3], v[4], v[5]], [v[6], v[7], v[8]]];
                self.vectors = vectors.as_ref().map(rows);
            }
        }
        Ok(())
    }

    fn changed(&self, changes: &[(usize, usize, i32)]) -> Vec<[c_int; 3]> {
        let mut corners = self.triangles();
        let count = corners.len();
        for (triangle, corner, particle) in changes {
            corners[triangle % count][*corner] = *particle;
        }
        corners
    }
}
