//! Scalar products: trees of blocks, so that the order of additions does not depend on the number of threads.

use crate::compute::{Complex, WORKGROUP};
use rayon::prelude::*;

/// Fewer values than this are not worth another thread.
pub(super) const GRAIN: usize = 2048;

/// The real scalar product.
pub(crate) fn product(a: &[Complex], b: &[Complex]) -> f32 {
    let terms = |(a, b): (&[Complex], &[Complex])| {
        let mut terms = [0.0; WORKGROUP];
        for ((term, a), b) in terms.iter_mut().zip(a).zip(b) {
            *term = a[0] * b[0] + a[1] * b[1];
        }
        block_sum(terms)
    };
    let mut sums: Vec<f32> = if a.len() <= GRAIN {
        a.chunks(WORKGROUP).zip(b.chunks(WORKGROUP)).map(terms).collect()
    } else {
        let blocks = a.par_chunks(WORKGROUP).zip(b.par_chunks(WORKGROUP));
        blocks.with_min_len(GRAIN / WORKGROUP).map(terms).collect()
    };
    while sums.len() > 1 {
        sums = sums
            .chunks(WORKGROUP)
            .map(|chunk| {
                let mut terms = [0.0; WORKGROUP];
                terms[..chunk.len()].copy_from_slice(chunk);
                block_sum(terms)
            })
            .collect();
    }
    sums.first().copied().unwrap_or(0.0)
}

/// The sum of a block: the second half is added to the first, and so on.
fn block_sum(mut terms: [f32; WORKGROUP]) -> f32 {
    let mut half = WORKGROUP / 2;
    while half > 0 {
        let (first, second) = terms.split_at_mut(half);
        for (a, b) in first.iter_mut().zip(second) {
            *a += *b;
        }
        half /= 2;
    }
    terms[0]
}
