//! The evaluator that a mesh uses: the processor's, a GPU's, or whichever is faster.

#[cfg(feature = "gpu")]
use super::gpu::{GpuEvaluator, Precision, calibration};
use super::{CpuEvaluator, InstructionSet, Survey};
use crate::backend::{self, Choice, Kind};
use crate::error::{Error, Result};
#[cfg(feature = "gpu")]
use crate::mesh::Topology;
use crate::mesh::{Cell, Triangulation};
use crate::potentials::{Contribution, Evaluator, Request, Term};
#[cfg(feature = "gpu")]
use crate::team::default_threads;
use smallvec::SmallVec;
#[cfg(feature = "gpu")]
use std::sync::Arc;

/// Below so many vertices no GPU is looked for: starting one takes longer than many evaluations of such a mesh,
/// and an evaluation there no longer than the way to a GPU and back.
pub const LEAST_VERTICES_FOR_GPU: usize = 20_000;

/// Refuse a GPU that does not exist.
///
/// # Errors
/// There is none, or it cannot do what is asked.
#[cfg(feature = "gpu")]
pub fn check_backend(choice: Choice) -> Result<()> {
    use super::gpu::adapters;
    if choice.kind == Kind::Auto && choice.adapter.is_some() {
        adapters::find(choice.adapter)?;
    }
    if choice.kind != Kind::Gpu {
        return Ok(());
    }
    let precision = if choice.double == Some(true) { Precision::Double } else { Precision::Single };
    adapters::find(choice.adapter)?.1.check(precision)
}

/// Refuse any GPU.
///
/// # Errors
/// This build knows none.
#[cfg(not(feature = "gpu"))]
pub fn check_backend(choice: Choice) -> Result<()> {
    if choice.kind != Kind::Gpu {
        return Ok(());
    }
    let found = "openmm-helfrich was built without its feature \"gpu\"".to_owned();
    Err(Error::NoAdapter { found })
}

/// Either evaluator, made when it is first needed.
pub struct ChosenEvaluator {
    /// Threads of the processor that may share the work; 0 for as many as there are.
    threads: usize,
    /// What a force has asked for; otherwise the choice for the process holds.
    own: Option<Choice>,
    /// What holds, once it is known.
    choice: Option<Choice>,
    cpu: Option<CpuEvaluator>,
    /// Whether it has been told of the present connectivity.
    cpu_is_current: bool,
    #[cfg(feature = "gpu")]
    gpu: Option<GpuEvaluator>,
    #[cfg(feature = "gpu")]
    gpu_is_current: bool,
    /// Whether it is settled that the processor computes.
    settled_on_cpu: bool,
}

/// The mesh as it is now, and an order of its vertices in which neighbours are near each other.
#[derive(Clone, Copy)]
pub struct Present<'a> {
    /// Which triangles and vertices touch.
    pub mesh: &'a Triangulation,
    /// All vertices.
    pub order: &'a [u32],
    /// The periodic box, if there is one.
    pub cell: Option<&'a Cell>,
}

impl Default for ChosenEvaluator {
    fn default() -> Self {
        Self::new()
    }
}

impl ChosenEvaluator {
    /// Nothing is chosen yet.
    pub fn new() -> Self {
        Self {
            threads: 0,
            own: None,
            choice: None,
            cpu: None,
            cpu_is_current: true,
            #[cfg(feature = "gpu")]
            gpu: None,
            #[cfg(feature = "gpu")]
            gpu_is_current: true,
            settled_on_cpu: false,
        }
    }

    /// Let so many threads share evaluations on the processor, where that turns out faster; 0 for as many as there
    /// are.
    pub fn set_threads(&mut self, threads: usize) {
        self.threads = threads;
        if let Some(cpu) = &mut self.cpu {
            cpu.set_threads(threads);
        }
    }

    /// Let a force join that has asked for something, or for nothing. A GPU that is asked for is started now,
    /// so that its errors come when a Context is made.
    ///
    /// # Errors
    /// Another force has asked for something else; there is no such GPU, or it cannot do what is asked.
    pub fn choose(&mut self, mesh: &Triangulation, wish: Option<Choice>) -> Result<()> {
        if let (Some(this), Some(other)) = (wish, self.own)
            && this != other
        {
            let (this, other) = (this.to_string(), other.to_string());
            return Err(Error::BackendConflict { this, other });
        }
        self.own = self.own.or(wish);
        let choice = self.own.map_or_else(backend::global, Ok)?;
        if self.choice == Some(choice) {
            return Ok(());
        }
        check_backend(choice)?;
        self.choice = Some(choice);
        self.settled_on_cpu = matches!(choice.kind, Kind::Cpu | Kind::Native)
            || choice.kind == Kind::Auto && !Self::is_worth_a_look(mesh);
        #[cfg(feature = "gpu")]
        {
            self.gpu = None;
            if choice.kind == Kind::Gpu {
                self.gpu = Some(Self::start_gpu(mesh, choice)?);
                self.gpu_is_current = true;
            }
        }
        Ok(())
    }

    /// What holds, once it is known.
    pub fn choice(&self) -> Option<Choice> {
        self.choice
    }

    /// Whether it is settled that the processor computes.
    pub fn is_settled_on_cpu(&self) -> bool {
        self.settled_on_cpu
    }

    /// Go on with other connectivity, or with another order of the vertices, from the next evaluation on.
    pub fn connectivity_changed(&mut self) {
        self.cpu_is_current = false;
        #[cfg(feature = "gpu")]
        {
            self.gpu_is_current = false;
        }
    }

    /// Evaluate terms, as [`Evaluator::evaluate`] does.
    ///
    /// # Errors
    /// Its errors, and those of a GPU that was asked for. Nothing has been added to the forces then.
    pub fn evaluate(&mut self, present: Present, request: Request) -> Result<()> {
        if self.choice.is_none() {
            self.choose(present.mesh, None)?;
        }
        // What spans a periodic box is for the processor.
        if self.settled_on_cpu || !present.mesh.images().is_empty() {
            return self.on_cpu(present, request);
        }
        self.on_gpu(present, request)
    }

    /// Evaluate some positions on the processor, whatever has been chosen, since its errors name the culprit.
    ///
    /// # Errors
    /// Those of [`Evaluator::evaluate`].
    pub fn look(
        &mut self,
        present: Present,
        terms: &[Term],
        positions: &[f64],
        forces: &mut [f64],
    ) -> Result<()> {
        // Energies that are not finite are errors only where energies are wanted.
        let mut energies = vec![Contribution::default(); terms.len()];
        let request = Request::new(terms, positions).with_energies(&mut energies);
        self.cpu(present).evaluate(request.with_forces(forces))
    }

    fn on_cpu(&mut self, present: Present, request: Request) -> Result<()> {
        backend::count_evaluation(Kind::Cpu);
        self.cpu(present).evaluate(request)
    }

    /// Evaluate terms on the processor, whatever has been chosen, and note what is known of every element.
    ///
    /// # Errors
    /// As [`CpuEvaluator::survey`].
    pub fn survey(
        &mut self,
        present: Present,
        request: Request,
        survey: &mut Survey,
    ) -> Result<()> {
        self.cpu(present).survey(request, survey)
    }

    fn cpu(&mut self, present: Present) -> &mut CpuEvaluator {
        let Present { mesh, order, cell } = present;
        let is_current = std::mem::replace(&mut self.cpu_is_current, true);
        if let Some(cpu) = &mut self.cpu
            && !is_current
        {
            cpu.lay_out(mesh, order);
        }
        let threads = self.threads;
        let cpu = self
            .cpu
            .get_or_insert_with(|| CpuEvaluator::of(mesh, order, InstructionSet::Best, threads));
        if let Some(cell) = cell {
            cpu.set_cell(cell);
        }
        cpu
    }
}

#[cfg(not(feature = "gpu"))]
impl ChosenEvaluator {
    fn is_worth_a_look(_: &Triangulation) -> bool {
        false
    }

    fn on_gpu(&mut self, present: Present, request: Request) -> Result<()> {
        self.on_cpu(present, request)
    }
}

#[cfg(feature = "gpu")]
impl ChosenEvaluator {
    fn is_worth_a_look(mesh: &Triangulation) -> bool {
        mesh.num_vertices() >= LEAST_VERTICES_FOR_GPU || calibration::prefers_gpu()
    }

    fn start_gpu(mesh: &Triangulation, choice: Choice) -> Result<GpuEvaluator> {
        let precision =
            if choice.double == Some(true) { Precision::Double } else { Precision::Single };
        GpuEvaluator::new(Arc::new(Topology::of(mesh)), choice.adapter, precision)
    }

    fn on_gpu(&mut self, present: Present, mut request: Request) -> Result<()> {
        let auto = self.choice.is_none_or(|choice| choice.kind == Kind::Auto);
        // Energies that nobody wants come at no cost, and tell whether the device could compute.
        let mut unwanted: SmallVec<[Contribution; 8]> = SmallVec::new();
        unwanted.resize(request.terms.len(), Contribution::default());
        let mut known = request.again();
        if known.energies.is_empty() {
            known = known.with_energies(&mut unwanted);
        }
        match self.try_gpu(present, known) {
            Ok(true) => {
                backend::count_evaluation(Kind::Gpu);
                Ok(())
            }
            // Here the processor names the culprit, or computes what single precision cannot.
            Ok(false) => self.on_cpu(present, request),
            Err(error) if auto && error.is_of_device() => {
                self.gpu = None;
                self.settled_on_cpu = true;
                warn_once(&error);
                self.on_cpu(present, request)
            }
            Err(error) => Err(error),
        }
    }

    /// Whether the GPU has computed; false if it is not to, or cannot.
    fn try_gpu(&mut self, present: Present, request: Request) -> Result<bool> {
        if self.gpu.is_none() {
            let choice = self.choice.map_or_else(backend::global, Ok)?;
            if choice.kind == Kind::Auto && !calibration::has_candidate(choice.adapter) {
                self.settled_on_cpu = true;
                return Ok(false);
            }
            let mut gpu = Self::start_gpu(present.mesh, choice)?;
            if choice.kind == Kind::Auto
                && !self.gpu_is_faster(present, &mut gpu, request.terms, request.positions)?
            {
                self.settled_on_cpu = true;
                return Ok(false);
            }
            self.gpu = Some(gpu);
            self.gpu_is_current = true;
            self.cpu = None;
        }
        let Some(gpu) = &mut self.gpu else { return Ok(false) };
        if !std::mem::replace(&mut self.gpu_is_current, true) {
            gpu.set_topology(Arc::new(Topology::of(present.mesh)));
        }
        gpu.evaluate(request)
    }

    /// What an earlier measurement says, or else one on this mesh.
    fn gpu_is_faster(
        &mut self,
        present: Present,
        gpu: &mut GpuEvaluator,
        terms: &[Term],
        positions: &[f64],
    ) -> Result<bool> {
        if calibration::prefers_gpu() {
            return Ok(true);
        }
        let threads = if self.threads == 0 { default_threads() } else { self.threads };
        let key = calibration::Key::new(gpu, present.mesh.num_vertices(), terms, threads);
        if let Some(known) = calibration::recall(&key) {
            return Ok(known.gpu < known.cpu);
        }
        let mut energies = vec![Contribution::default(); terms.len()];
        let mut forces = vec![0.0; positions.len()];
        let mut cpu_fails = None;
        let cpu = calibration::fastest(|| {
            let request = Request::new(terms, positions).with_energies(&mut energies);
            cpu_fails = self.on_cpu(present, request.with_forces(&mut forces[..])).err();
        });
        if cpu_fails.is_some() {
            // The real evaluation will say so.
            return Ok(false);
        }
        let mut computed = Ok(true);
        let on_gpu = calibration::fastest(|| {
            let request = Request::new(terms, positions).with_energies(&mut energies);
            computed = gpu.evaluate(request.with_forces(&mut forces[..]));
        });
        if !computed? {
            // A failure says nothing about its speed, so nothing is remembered.
            return Ok(false);
        }
        let times = calibration::Times { cpu, gpu: on_gpu };
        calibration::remember(key, times);
        Ok(times.gpu < times.cpu)
    }
}

/// Say on the standard error why the processor computes, once in a process.
#[cfg(feature = "gpu")]
fn warn_once(error: &Error) {
    static SAID: std::sync::Once = std::sync::Once::new();
    SAID.call_once(|| {
        // What could be done about it is after the semicolon, and it has been done.
        let message = error.to_string();
        let reason = message.split("; ").next().unwrap_or_default();
        eprintln!("openmm-helfrich: {reason}; the processor takes over");
    });
}
