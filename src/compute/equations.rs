//! Sparse linear equations between complex unknowns, on levels of ever fewer unknowns: the records that kernels read.

use super::{Complex, NEGLIGIBLE, conjugate, modulus};
use bytemuck::{Pod, Zeroable};

/// The bit of a link's unknown for a value that is taken conjugate before it is multiplied.
pub const MIRRORED: u32 = 1 << 31;

/// A mass term draws a value to itself, and one that is shorter than this to this length. Halfway between two constraints 30
/// degrees apart the solution of the field's equations is 0.5 long, and shorter only where constraints contradict each other
/// more or are far away.
pub const TARGET_LENGTH: f32 = 0.45;

/// What the mass term draws a value to.
pub(crate) fn target(z: Complex) -> Complex {
    let length = modulus(z);
    if length > NEGLIGIBLE && length < TARGET_LENGTH {
        [z[0] / length * TARGET_LENGTH, z[1] / length * TARGET_LENGTH]
    } else {
        z
    }
}

/// Another unknown, and the complex number that its value is multiplied by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Link {
    /// The unknown, and [`MIRRORED`].
    pub neighbour: u32,
    /// The factor.
    pub weight: Complex,
}

impl Link {
    /// The unknown.
    #[inline]
    pub fn index(&self) -> usize {
        (self.neighbour & !MIRRORED) as usize
    }

    /// Whether the value is taken conjugate before it is multiplied.
    #[inline]
    pub fn is_mirrored(&self) -> bool {
        self.neighbour & MIRRORED != 0
    }

    /// The product with a value.
    #[inline]
    pub fn of(&self, [x, y]: Complex) -> Complex {
        let y = if self.is_mirrored() { -y } else { y };
        [self.weight[0] * x - self.weight[1] * y, self.weight[0] * y + self.weight[1] * x]
    }

    /// The adjoint of a link from the unknown `to`: it leads back there.
    #[inline]
    pub fn back(&self, to: u32) -> Self {
        let weight = if self.is_mirrored() { self.weight } else { conjugate(self.weight) };
        Self { neighbour: to ^ self.neighbour & MIRRORED, weight }
    }

    /// The composition of `inner` and this link: a link to the unknown of `inner`.
    pub(crate) fn after(&self, inner: &Self) -> Self {
        Self { neighbour: inner.neighbour ^ self.neighbour & MIRRORED, weight: self.of(inner.weight) }
    }
}

/// One unknown's equation: `diagonal z - sum weight z_neighbour = right-hand side + mass z_before`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Row {
    /// Where its links start; the next row's start is their end.
    pub start: u32,
    /// The factor of its own value; 0: its value is fixed.
    pub diagonal: f32,
    /// The part of `diagonal` that is a mass over a time step: it draws the value to the value before.
    pub mass: f32,
}

/// One level.
#[derive(Clone, Debug, Default)]
pub struct Level {
    /// The equations, and one more that ends the last one's links.
    pub rows: Vec<Row>,
    /// The links of all rows.
    pub links: Vec<Link>,
    /// The right-hand side of each equation; the value of a fixed unknown.
    pub right_hand_side: Vec<Complex>,
    /// The unknown on the next coarser level that each one is part of, with the factor that reads its value in the
    /// frame of this one; empty on the coarsest.
    pub parents: Vec<Link>,
    /// Where the members of each aggregate, an unknown of the next coarser level, start, and one more; empty on the
    /// coarsest.
    pub aggregate_starts: Vec<u32>,
    /// The members of the aggregates, one after the other.
    pub members: Vec<u32>,
}

impl Level {
    /// The number of unknowns.
    pub fn len(&self) -> usize {
        self.right_hand_side.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.right_hand_side.is_empty()
    }

    /// The links of an unknown.
    pub fn links_of(&self, unknown: usize) -> &[Link] {
        &self.links[self.rows[unknown].start as usize..self.rows[unknown + 1].start as usize]
    }

    /// Whether the value of an unknown is fixed.
    pub fn is_fixed(&self, unknown: usize) -> bool {
        self.rows[unknown].diagonal == 0.0
    }

    /// The values of fixed unknowns, and zero elsewhere.
    pub fn fixed_values(&self) -> Vec<Complex> {
        (0..self.len()).map(|i| if self.is_fixed(i) { self.right_hand_side[i] } else { [0.0, 0.0] }).collect()
    }

    /// The number of unknowns of the next coarser level; 0 on the coarsest.
    pub fn aggregate_count(&self) -> usize {
        self.aggregate_starts.len().saturating_sub(1)
    }

    /// The members of an aggregate.
    pub fn members_of(&self, aggregate: usize) -> &[u32] {
        &self.members[self.aggregate_starts[aggregate] as usize..self.aggregate_starts[aggregate + 1] as usize]
    }
}
