//! One variant per mistake; each message names the culprit and what to do about it.
//!
//! A message has no subject of its own: whoever reports the error puts the name of the class at fault
//! in front of it, as in "BendingForce: edge (3, 7) belongs to one triangle only …".

use thiserror::Error;

/// What can be wrong with a mesh, a parameter or the positions of an evaluation.
///
/// Vertices are named by the indices that the user gave, which for a force are particle indices.
#[allow(missing_docs, reason = "the message of each variant says what its fields are")]
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Error {
    /// There is nothing to compute on.
    #[error("the mesh has no triangles; add at least four that close a surface")]
    EmptyMesh,

    /// A triangle refers to a vertex or particle that does not exist.
    #[error("triangle {triangle} refers to index {index}, but indices run from 0 to {last}", last = *.count as i64 - 1)]
    IndexOutOfRange { triangle: usize, index: i64, count: usize },

    /// A triangle has two equal corners.
    #[error("triangle {triangle} ({}, {}, {}) repeats vertex {vertex}; its three corners must differ", .corners[0], .corners[1], .corners[2])]
    RepeatedCorner { triangle: usize, corners: [u32; 3], vertex: u32 },

    /// Two triangles have the same three corners.
    #[error("triangles {first} and {second} have the same corners ({}, {}, {}); remove one of them", .corners[0], .corners[1], .corners[2])]
    DuplicateTriangle { first: usize, second: usize, corners: [u32; 3] },

    /// More than two sheets meet in an edge.
    #[error("edge ({}, {}) is shared by {count} triangles (the first three: {}, {}, {}); a surface has two at each edge, or one at a border; remove walls inside of it, or give each sheet vertices of its own", .edge[0], .edge[1], .triangles[0], .triangles[1], .triangles[2])]
    NonManifoldEdge { edge: [u32; 2], count: usize, triangles: [usize; 3] },

    /// Two neighbours are listed with opposite senses of rotation.
    #[error("triangles {} and {} run through edge ({}, {}) in the same direction, so their normals disagree; reverse one of them, or let openmmhelfrich.Mesh orient the surface", .triangles[0], .triangles[1], .edge[0], .edge[1])]
    InconsistentOrientation { edge: [u32; 2], triangles: [usize; 2] },

    /// No choice of orientation is consistent (a Möbius strip or Klein bottle is part of the mesh).
    #[error("the surface is not orientable: going round it, triangles {} and {} disagree at edge ({}, {}), so it has only one side; cut it open there", .triangles[0], .triangles[1], .edge[0], .edge[1])]
    NonOrientable { edge: [u32; 2], triangles: [usize; 2] },

    /// Two parts of the surface touch in one vertex.
    #[error(
        "the triangles at vertex {vertex} form {fans} separate fans, so the surface pinches there; split the vertex"
    )]
    NonManifoldVertex { vertex: u32, fans: usize },

    /// A vertex without triangles.
    #[error("vertex {vertex} belongs to no triangle; remove it")]
    UnusedVertex { vertex: usize },

    /// Two vertices in the same place.
    #[error("vertices {first} and {second} are both at ({}, {}, {}) nm; merge them", .position[0], .position[1], .position[2])]
    RepeatedVertex { first: usize, second: usize, position: [f64; 3] },

    /// NaN or infinity among the coordinates of a mesh.
    #[error("vertex {vertex} has a coordinate that is not finite ({}, {}, {})", .position[0], .position[1], .position[2])]
    NonFiniteVertex { vertex: usize, position: [f64; 3] },

    /// A coordinate of a mesh whose cube and the sums of such are no numbers.
    #[error("vertex {vertex} is at ({:e}, {:e}, {:e}) nm; coordinates must be below 1e100, see whether the file is damaged", .position[0], .position[1], .position[2])]
    FarVertex { vertex: usize, position: [f64; 3] },

    /// NaN or infinity among the positions of a running simulation.
    #[error("particle {particle} is at ({}, {}, {}) nm, which is not finite: the simulation has blown up; use a smaller time step or a better relaxed start", .position[0], .position[1], .position[2])]
    NonFinitePosition { particle: u32, position: [f64; 3] },

    /// A position whose image cannot be counted.
    #[error("particle {particle} is at ({}, {}, {}) nm, which is more than a billion periodic boxes away: the simulation has blown up, or positions were never wrapped; use a smaller time step, or start from positions in the box", .position[0], .position[1], .position[2])]
    FarPosition { particle: u32, position: [f64; 3] },

    /// A position so far out that distances are no numbers in single precision.
    #[error("particle {particle} is at ({:e}, {:e}, {:e}) nm, where nothing can be found near it: the simulation has blown up; use a smaller time step or a better relaxed start", .position[0], .position[1], .position[2])]
    LostPosition { particle: u32, position: [f64; 3] },

    /// NaN or infinity among the velocities of a running simulation.
    #[error("particle {particle} has the velocity ({}, {}, {}) nm/ps, which is not finite: the simulation has blown up; use a smaller time step or a better relaxed start", .velocity[0], .velocity[1], .velocity[2])]
    NonFiniteVelocity { particle: u32, velocity: [f64; 3] },

    /// Two ends of an edge in the same place.
    #[error("particles {} and {}, which an edge joins, are both at ({}, {}, {}) nm, so that it has no direction; use a smaller time step or a better relaxed start", .edge[0], .edge[1], .position[0], .position[1], .position[2])]
    EdgeWithoutLength { edge: [u32; 2], position: [f64; 3] },

    /// An edge is so long that its length is not a number.
    #[error("the edge of particles {} and {} has grown beyond all numbers: the simulation has blown up; use a smaller time step or a better relaxed start", .edge[0], .edge[1])]
    OverflownEdge { edge: [u32; 2] },

    /// A triangle has no area and therefore no normal.
    #[error("triangle {triangle} ({}, {}, {}) has no area, so its normal and the energy's gradient are undefined; keep its corners from falling on one line (TriangleHeightForce, or a smaller time step)", .corners[0], .corners[1], .corners[2])]
    DegenerateTriangle { triangle: usize, corners: [u32; 3] },

    /// A triangle is so large that its area is not a number.
    #[error("triangle {triangle} ({}, {}, {}) has grown beyond all numbers: the simulation has blown up; use a smaller time step or a better relaxed start", .corners[0], .corners[1], .corners[2])]
    OverflownTriangle { triangle: usize, corners: [u32; 3] },

    /// An edge has no image that is certainly the nearest.
    #[error("particles {} and {} are joined by an edge of {length:.6} nm, but in the periodic box with vectors {:?}, {:?} and {:?} nm edges must be shorter than {limit:.6} nm, half of its least width, so that it is clear which images they connect; use a larger box, or a mesh of shorter edges (around the box it needs three vertices, better four)", .edge[0], .edge[1], .vectors[0], .vectors[1], .vectors[2])]
    LongEdge { edge: [u32; 2], length: f64, limit: f64, vectors: Box<[[f64; 3]; 3]> },

    /// The surface of a potential that needs an outside goes on beyond the periodic box.
    #[error(
        "the surface with particle {particle} spans the periodic box, so it encloses no volume; leave {force} out, or give it the triangles of closed surfaces only"
    )]
    Spanning { force: &'static str, particle: u32 },

    /// The surface of a potential that needs an outside is turned inside out.
    #[error(
        "the triangles run clockwise seen from outside, so that the enclosed volume is below zero ({volume} nm^3); swap two corners of each triangle, or let openmmhelfrich.Mesh(vertices, triangles) turn them"
    )]
    InsideOut { force: &'static str, volume: f64 },

    /// The surface of a potential of what it encloses has a border.
    #[error(
        "needs a closed surface, which encloses something, but this one has a border of {length} edges through particles {}; close the hole, or leave {force} out", some(.particles)
    )]
    Border { force: &'static str, length: usize, particles: Vec<u32> },

    /// A term has no finite energy on a mesh whose geometry is finite.
    #[error(
        "the energy of {force} is not finite ({energy} kJ/mol) although every position is: the mesh is folded or collapsed, or a Voronoi area is zero; use a smaller time step or a better relaxed start"
    )]
    NonFiniteEnergy { force: &'static str, energy: f64 },

    /// Things that repel each other are so near that the sum of their energies is not finite.
    #[error(
        "the energy of {force} is not finite: particles are too near to triangles that they should keep away from; start from positions that do not touch, or use a smaller time step"
    )]
    Touching { force: &'static str },

    /// A vertex and a triangle, or two edges, are in one place.
    #[error(
        "{}, so that the energy of {force} is not finite; start from positions that do not touch, or use a smaller time step", meeting(.particles, *.are_edges)
    )]
    TouchingSurface { force: &'static str, particles: [u32; 4], are_edges: bool },

    /// A particle is in one place with a triangle that keeps it away.
    #[error(
        "particle {particle} touches triangle {triangle} ({}, {}, {}), which should keep it away, or is cut by it; start from positions that do not touch, or use a smaller time step", .corners[0], .corners[1], .corners[2]
    )]
    TouchingParticle { force: &'static str, particle: u32, triangle: usize, corners: [u32; 3] },

    /// What must be given for each vertex has been given for more or fewer of them.
    #[error(
        "{name} is of {count} vertices, but there are {vertices}; give one row for each, in ascending order of particle index"
    )]
    Numbers { force: &'static str, name: String, count: usize, vertices: usize },

    /// The corners of a triangle are in one line in the reference.
    #[error(
        "triangle {triangle} ({}, {}, {}) has no area in the reference, so that no strain can be measured against it; give a reference in which its corners are not in one line", .corners[0], .corners[1], .corners[2]
    )]
    FlatReference { force: &'static str, triangle: usize, corners: [u32; 3] },

    /// A side of the reference has no image that is certainly the nearest.
    #[error(
        "particles {} and {} are {length:.6} nm apart in the reference, but in its periodic box edges must be shorter than {limit:.6} nm, half of the least width, so that it is clear which images they connect; give the box that belongs to the reference, or a reference of a larger one", .edge[0], .edge[1]
    )]
    LongReference { force: &'static str, edge: [u32; 2], length: f64, limit: f64 },

    /// A surface spans the periodic box, but its reference has none.
    #[error(
        "the surface with particle {particle} spans the periodic box, but the reference of {force} has no box, which says where it goes on; give a Mesh that has one for the reference, or call setReferenceBox()"
    )]
    NoReferenceBox { force: &'static str, particle: u32 },

    /// A spring is longer than it can be.
    #[error(
        "the edge ({}, {}) of triangle {triangle} is {length:.6} nm long, but its spring must be shorter than {longest:.6} nm, so that the energy of {force} is not finite; use a smaller time step, another reference, or a smaller ratio of lengths at rest to the longest", .edge[0], .edge[1]
    )]
    LongSpring { force: &'static str, triangle: usize, edge: [u32; 2], length: f64, longest: f64 },
    /// A velocity or force that is not finite where masses follow plaquettes.
    #[error(
        "the velocity of particle {particle} or the force on it is not finite: the simulation has blown up; use a smaller time step or a better relaxed start"
    )]
    NonFiniteMomentum { particle: u32 },

    /// A time step whose implicit equations iteration does not solve.
    #[error(
        "the {equation} of a time step with the step size {step} ps has not converged in {iterations} iterations: particle {particle} would go {ways:.2} times as far as its plaquette is wide; use a smaller step size"
    )]
    NotConverged { equation: &'static str, step: f64, iterations: usize, particle: u32, ways: f64 },

    /// A scalar outside its domain.
    #[error("{parameter} must be {domain}, got {value}")]
    Parameter { parameter: String, domain: &'static str, value: f64 },

    /// A name that the registry does not know.
    #[error("there is no {what} called \"{name}\"; known are: {known}")]
    UnknownName { what: &'static str, name: String, known: String },

    /// No adapter, or not the one that was asked for.
    #[error(
        "there is no GPU to compute on: {found}; install its driver (Vulkan on Linux), or choose the processor, set_backend(\"cpu\")"
    )]
    NoAdapter { found: String },

    /// An adapter without something that is needed.
    #[error(
        "the GPU {adapter} {lack}; choose another adapter or precision, or the processor, set_backend(\"cpu\")"
    )]
    AdapterLacks { adapter: String, lack: String },

    /// The device has gone, for good.
    #[error(
        "the GPU {adapter} was lost ({reason}); start again from the last checkpoint, or use set_backend(\"auto\"), with which the processor takes over"
    )]
    LostDevice { adapter: String, reason: String },

    /// The device has too little memory.
    #[error(
        "the GPU {adapter} has not enough memory for a mesh of {vertices} vertices; choose the processor, set_backend(\"cpu\")"
    )]
    OutOfDeviceMemory { adapter: String, vertices: usize },

    /// Anything else that a driver can say.
    #[error("the GPU {adapter} has failed: {reason}; choose the processor, set_backend(\"cpu\")")]
    DeviceFailure { adapter: String, reason: String },

    /// A name that is none of the backends.
    #[error(
        "there is no backend \"{name}\"; known are: auto, cpu, native, gpu, gpu:single, gpu:double"
    )]
    UnknownBackend { name: String },

    /// Forces that share an evaluation ask for different backends.
    #[error(
        "has the backend \"{this}\", but another force on the same triangles has \"{other}\", and they are computed together; give them the same"
    )]
    BackendConflict { this: String, other: String },

    /// A call through the C interface that breaks its contract.
    #[error("{0}")]
    Contract(String),
}

impl Error {
    /// The class at fault, where that is known better here than by who reports the error: forces that are evaluated
    /// together report in the name of one of them.
    pub fn class(&self) -> Option<&'static str> {
        match self {
            Self::InsideOut { force, .. }
            | Self::Border { force, .. }
            | Self::Spanning { force, .. }
            | Self::Numbers { force, .. }
            | Self::FlatReference { force, .. }
            | Self::LongReference { force, .. }
            | Self::NoReferenceBox { force, .. }
            | Self::LongSpring { force, .. }
            | Self::Touching { force }
            | Self::TouchingSurface { force, .. }
            | Self::TouchingParticle { force, .. } => Some(force),
            _ => None,
        }
    }

    /// Whether the GPU is at fault, so that the processor could do what the GPU could not.
    pub fn is_of_device(&self) -> bool {
        matches!(
            self,
            Self::NoAdapter { .. }
                | Self::AdapterLacks { .. }
                | Self::LostDevice { .. }
                | Self::OutOfDeviceMemory { .. }
                | Self::DeviceFailure { .. }
        )
    }
}

/// What meets: a particle and the corners of a triangle, or the ends of two edges.
fn meeting([a, b, c, d]: &[u32; 4], are_edges: bool) -> String {
    if are_edges {
        format!("the edges ({a}, {b}) and ({c}, {d}) meet")
    } else {
        format!("particle {a} lies on the triangle ({b}, {c}, {d})")
    }
}

/// The first few of some particles.
fn some(particles: &[u32]) -> String {
    const FEW: usize = 6;
    let names: Vec<_> = particles.iter().take(FEW).map(u32::to_string).collect();
    let more = if particles.len() > FEW { " …" } else { "" };
    format!("{}{more}", names.join(", "))
}

/// The result of everything that can fail in this crate.
pub type Result<T> = std::result::Result<T, Error>;
