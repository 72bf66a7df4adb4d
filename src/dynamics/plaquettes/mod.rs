//! The barycentric areas of plaquettes, aᵢ = Σ aₜ / 3 over the triangles t at vertex i, and how they change with
//! positions: what masses that follow them need.
//!
//! Triangles and vertices are in lanes, vertices breadth first. Results are gathered, never scattered: ∂aⱼ/∂rᵢ is kept
//! for each vertex i beside its neighbours j. Sums are formed over tiles of fixed size and then over tiles, so that the
//! number of threads does not show in the bits.

mod layout;
mod passes;

pub use layout::{Layout, Sheet, Tile};

use crate::error::{Error, Result};
use crate::mesh::Cell;
use crate::mesh::culprit;
use crate::mesh::geometry::Vec3;
use crate::mesh::topology::NONE;
use crate::team::{Parts, Team};
use passes::{Areas, Gather, GatherAreas, Gradients};
use std::ops::Range;

/// How many triangles or vertices are computed at once.
pub const LANES: usize = 8;

/// The share of a vertex in a triangle.
pub(super) const THIRD: f64 = 1.0 / 3.0;

/// A number for each lane.
pub type Lanes = [f64; LANES];

/// x, y and z for each lane.
pub type Vectors = [Lanes; 3];

/// Let the members of a team have a share each of `count` things, or the caller all.
pub(super) fn share(
    team: &mut Option<&mut Team>,
    count: usize,
    work: impl Fn(Range<usize>) + Sync,
) {
    match team {
        Some(team) if team.size() > 1 => team.run(|member| work(member.share(count))),
        _ => work(0..count),
    }
}

/// Whether two arrays have the same bits.
fn is_same(one: &[f64], other: &[f64]) -> bool {
    // A loop that never stops early is compiled to vector instructions.
    let difference =
        one.iter().zip(other).fold(0, |bits, (a, b)| bits | (a.to_bits() ^ b.to_bits()));
    one.len() == other.len() && difference == 0
}

/// The connected surfaces of a System with the geometry of their plaquettes.
pub struct Plaquettes {
    layout: Layout,
    /// Where the vertices are, nm, and in which box, for which all of the geometry holds; none before the first.
    at: Option<Option<Cell>>,
    /// Positions of all particles there, nm.
    placed: Vec<f64>,
    /// The same of the vertices.
    pub(super) positions: Vec<Vectors>,
    /// Of triangles, nm²; the last group is zero, for places in rings that no triangle is at.
    triangle_areas: Vec<Lanes>,
    /// ∂aₜ/∂r of the three corners, nm; the last group is zero.
    gradients: Vec<[Vectors; 3]>,
    /// aᵢ, nm².
    pub(super) areas: Vec<Lanes>,
    /// ∂A/∂rᵢ, nm, A the area of the whole surface; it is 3 ∂aᵢ/∂rᵢ, too.
    pub(super) total_gradients: Vec<Vectors>,
    /// ∂aⱼ/∂rᵢ for each neighbour j, nm.
    pub(super) neighbour_gradients: Vec<Vectors>,
    /// A of each surface, nm².
    pub(super) totals: Vec<f64>,
    tile_sums: Vec<f64>,
}

impl Plaquettes {
    /// The surfaces that the triangles of all forces make up.
    ///
    /// # Errors
    /// Those of [`Layout::new`].
    pub fn new(sheets: &[Sheet], num_particles: usize) -> Result<Self> {
        let layout = Layout::new(sheets, num_particles)?;
        let (groups, triangle_groups) = (layout.particles.len(), layout.corners.len());
        Ok(Self {
            at: None,
            placed: vec![0.0; 3 * num_particles],
            positions: vec![Vectors::default(); groups],
            triangle_areas: vec![Lanes::default(); triangle_groups + 1],
            gradients: vec![Default::default(); triangle_groups + 1],
            areas: vec![Lanes::default(); groups],
            total_gradients: vec![Vectors::default(); groups],
            neighbour_gradients: vec![Vectors::default(); layout.neighbours.len()],
            totals: vec![0.0; layout.is_periodic.len()],
            tile_sums: vec![0.0; layout.triangle_tiles.len()],
            layout,
        })
    }

    /// Which vertex is in which lane, and what is around it.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Compute all of the geometry at the positions of all particles, nm, unless it is there already.
    ///
    /// # Errors
    /// A position that is not finite, a triangle without area, a surface in a periodic box without one.
    pub fn place(
        &mut self,
        team: &mut Option<&mut Team>,
        positions: &[f64],
        cell: Option<&Cell>,
    ) -> Result<()> {
        if self.at == Some(cell.copied()) && is_same(&self.placed, positions) {
            return Ok(());
        }
        self.at = None;
        self.placed.copy_from_slice(positions);
        for (here, particles) in self.positions.iter_mut().zip(&self.layout.particles) {
            for (lane, &particle) in particles.iter().enumerate().filter(|(_, p)| **p != NONE) {
                let place = positions.as_chunks::<3>().0[particle as usize];
                (0..3).for_each(|axis| here[axis][lane] = place[axis]);
            }
        }
        self.differentiate(team, cell);
        self.sum_totals();
        if self.totals.iter().any(|total| !total.is_finite()) {
            return Err(self.culprit(positions, cell));
        }
        self.at = Some(cell.copied());
        Ok(())
    }

    /// Compute the areas alone, at positions of the vertices in lanes, into `areas`; the rest no longer holds.
    pub(super) fn measure(
        &mut self,
        team: &mut Option<&mut Team>,
        positions: &[Vectors],
        areas: &mut [Lanes],
        cell: Option<&Cell>,
    ) {
        self.at = None;
        let layout = &self.layout;
        {
            let (of_triangles, sums) =
                (Parts::new(&mut self.triangle_areas), Parts::new(&mut self.tile_sums));
            share(team, layout.triangle_tiles.len(), |tiles| {
                for tile in tiles {
                    // SAFETY: each tile has its own groups and its own sum.
                    let (areas, sum) = unsafe {
                        (
                            of_triangles.part(layout.triangle_tiles[tile].groups()),
                            sums.part(tile..tile + 1),
                        )
                    };
                    Areas::run(layout, tile, positions, cell, areas, &mut sum[0]);
                }
            });
        }
        let (of_triangles, areas) = (&self.triangle_areas, Parts::new(areas));
        share(team, layout.tiles.len(), |tiles| {
            for tile in tiles {
                let groups = layout.tiles[tile].groups();
                // SAFETY: each tile has its own groups.
                let areas = unsafe { areas.part(groups.clone()) };
                GatherAreas { layout, groups, of_triangles, areas }.run();
            }
        });
        self.sum_totals();
    }

    /// Areas and their gradients at the present positions.
    fn differentiate(&mut self, team: &mut Option<&mut Team>, cell: Option<&Cell>) {
        let layout = &self.layout;
        {
            let (of_triangles, sums) =
                (Parts::new(&mut self.triangle_areas), Parts::new(&mut self.tile_sums));
            let (gradients, positions) = (Parts::new(&mut self.gradients), &self.positions);
            share(team, layout.triangle_tiles.len(), |tiles| {
                for tile in tiles {
                    let groups = layout.triangle_tiles[tile].groups();
                    // SAFETY: each tile has its own groups and its own sum.
                    let (areas, sum, gradients) = unsafe {
                        (
                            of_triangles.part(groups.clone()),
                            sums.part(tile..tile + 1),
                            gradients.part(groups),
                        )
                    };
                    Gradients::run(layout, tile, positions, cell, areas, gradients, &mut sum[0]);
                }
            });
        }
        let (of_triangles, gradients) = (&self.triangle_areas, &self.gradients);
        let (areas, totals) = (Parts::new(&mut self.areas), Parts::new(&mut self.total_gradients));
        let neighbours = Parts::new(&mut self.neighbour_gradients);
        share(team, layout.tiles.len(), |tiles| {
            for tile in tiles {
                let groups = layout.tiles[tile].groups();
                // SAFETY: each tile has its own groups, and these have their own neighbours.
                let (areas, totals, neighbours) = unsafe {
                    (
                        areas.part(groups.clone()),
                        totals.part(groups.clone()),
                        neighbours.part(layout.slots_of(groups.clone())),
                    )
                };
                GatherAreas { layout, groups: groups.clone(), of_triangles, areas }.run();
                Gather::run(layout, groups, gradients, totals, neighbours);
            }
        });
    }

    fn sum_totals(&mut self) {
        self.totals.fill(0.0);
        for (tile, sum) in self.layout.triangle_tiles.iter().zip(&self.tile_sums) {
            self.totals[tile.surface] += sum;
        }
    }

    fn culprit(&self, positions: &[f64], cell: Option<&Cell>) -> Error {
        let place = |particle: u32| {
            Vec3::from(std::array::from_fn(|axis| positions[3 * particle as usize + axis]))
        };
        let particles: Vec<_> =
            self.layout.particles.as_flattened().iter().copied().filter(|p| *p != NONE).collect();
        let triangles = self.layout.triangles.iter().map(|corners| {
            let first = place(corners[0]);
            corners.map(|particle| {
                let nearest = |cell: &Cell| cell.shift(cell.nearest(&(place(particle) - first)));
                (particle, cell.map_or(Vec3::zeros(), nearest))
            })
        });
        culprit(&particles, triangles, positions)
    }
}
