//! The sizes of a surface from the user's options: sizes at points, and a bound on the turn of the surface within a tile.

use super::growth::Growth;
use super::local::{Limit, LocalSize, least, round_curves};
use super::{Intervals, SizeSample, Sizes, SizesError};
use crate::progress::IsCancelled;
use crate::surface::curvature::{curvatures_above, radius_of_tile};
use crate::surface::girth::girths;
use crate::surface::{Curve, Surface};
use rayon::prelude::*;
use rstar::RTree;
use rstar::primitives::GeomWithData;

/// The least factor by which curvature makes a tile smaller.
const LEAST: f64 = 0.25;
/// The least factor by which the girth of a thin part makes a tile smaller.
const THINNEST: f64 = 0.1;
/// The least number of tiles on a part of the surface.
const LEAST_TILES: f64 = 14.0;
/// A part whose tiles would be smaller than this, in tile sides, has hardly any area and no tiles of its own.
const SPECK: f64 = 0.01;
/// Where thin parts take more tiles than this share of the count beside those that they would have, the count is raised.
const THIN_SHARE: f64 = 0.5;
/// The distance from a place within which tiles are made smaller, in their sides.
const REFINED: f64 = 1.5;
/// A round curve has the asked number of tiles where its sizes give no more than so many times as many.
const MOST_INTERVALS: f64 = 1.2;
/// Where no more tiles than this are asked for, smaller ones are added to them.
const FEW: usize = 300;
/// The samples that the size of a place is a mean of.
const NEAREST: usize = 8;
/// Rounds of fitting the scale to the count; each leaves about a tenth of the error.
const ROUNDS: usize = 8;
/// The error of the count that is small enough; the final scale removes the rest.
const COUNT_ERROR: f64 = 1e-3;

/// What the sizes depend on. Default: nothing, equal tiles.
#[derive(Clone, Debug, PartialEq)]
pub struct SizeOptions {
    /// Sizes at points, spread over the surface: by the inverse squares of the distances of the nearest eight, straight
    /// through space. With a count they are relative, without in model units.
    pub samples: Vec<SizeSample>,
    /// The largest angle by which the surface turns within a tile, in degrees; tiles are made smaller for it, down to a quarter.
    pub curvature: Option<f64>,
    /// The largest ratio of the sides of two tiles beside each other. Default 1.2.
    pub growth: f64,
    /// The number of tiles that go round thin parts and narrow holes; tiles are made smaller for it, down to a tenth. 0: any.
    /// Default 3.
    pub around: f64,
    /// Sizes at places, which are the largest there. Default: none.
    pub local: Vec<LocalSize>,
    /// The least number of tiles round each round hole, and each other closed feature that is round: just so many where others would
    /// be fewer, or up to a fifth more; about as many where the mosaic is laid coarsely and split. 0: any, the default.
    pub around_holes: usize,
    /// The least side, in model units; it counts before all others. Default: none.
    pub least: Option<f64>,
    /// The largest side, in model units. Default: none.
    pub largest: Option<f64>,
}

impl Default for SizeOptions {
    fn default() -> Self {
        Self {
            samples: Vec::new(),
            curvature: None,
            growth: 1.2,
            around: 3.0,
            local: Vec::new(),
            around_holes: 0,
            least: None,
            largest: None,
        }
    }
}

impl SizeOptions {
    /// The wanted sizes on a surface, for tiles of about this side in unit-sized coordinates. Thin parts are searched for where
    /// `is_thin` says that the surface has some. `crease` is the angle of creases, in degrees.
    ///
    /// # Errors
    /// Where sizes are given for a place that the surface does not have, or the least is larger than the largest.
    pub(crate) fn on<'a>(
        &'a self,
        surface: &Surface,
        side: f64,
        is_thin: bool,
        crease: f64,
    ) -> Result<Wanted<'a>, SizesError> {
        if let (Some(least), Some(largest)) = (self.least, self.largest)
            && least > largest
        {
            return Err(SizesError::Range { least, largest });
        }
        let places = self.places(surface, crease).collect::<Result<Vec<Limit>, SizesError>>()?;
        Ok(Wanted {
            options: self,
            samples: self.spread(surface),
            turns: self.turns(surface, side),
            girths: if is_thin { self.girths(surface, side, &|| false) } else { None },
            limits: None,
            local: least(&places, surface, 0),
            places,
            unit: surface.frame().diagonal,
            scale: None,
        })
    }

    /// The sides of tiles that thin parts and places ask for, before features that tiles do not resolve are dropped.
    pub(crate) fn small_sides(
        &self,
        surface: &Surface,
        side: f64,
        crease: f64,
        is_cancelled: &IsCancelled,
    ) -> SmallSides {
        let girths = self.girths(surface, side, is_cancelled);
        // Ridges are not known yet; that a place is not there is told with the sizes.
        let places = self.places(surface, crease).filter_map(Result::ok).collect::<Vec<Limit>>();
        let is_thin = girths.is_some();
        if !is_thin && places.is_empty() {
            return SmallSides { is_thin, at_vertices: None };
        }
        let mut sides = least(&places, surface, 0);
        sides.iter_mut().for_each(|limit| *limit = limit.min(side));
        for (limit, girth) in sides.iter_mut().zip(girths.iter().flatten()) {
            *limit = limit.min(self.thin_side(side, *girth));
        }
        Growth::new(surface).limit(&mut sides, self.growth - 1.0);
        SmallSides { is_thin, at_vertices: Some(sides) }
    }

    /// The places with sizes of their own.
    fn places(&self, surface: &Surface, crease: f64) -> impl Iterator<Item = Result<Limit, SizesError>> {
        let local = self.local.iter().map(move |local| Limit::new(surface, local, crease, self.growth));
        let round = (self.around_holes > 0).then(|| Limit::round_holes(surface, self.around_holes, self.growth));
        local.chain(round.map(Ok))
    }

    /// The side of tiles on a part of a girth, where other tiles have this side.
    fn thin_side(&self, side: f64, girth: f64) -> f64 {
        side.min((girth / self.around).max(THINNEST * side))
    }

    /// The number of tiles of the sides that the samples give as they are, in model units.
    ///
    /// # Errors
    /// Where samples give no positive size that an `f32` holds.
    pub fn count(&self, surface: &Surface) -> Result<f64, SizesError> {
        // Thin parts and places raise the count later.
        let flat = Self { samples: self.samples.clone(), growth: self.growth, ..Self::default() };
        let count = flat.on(surface, 1.0, false, 180.0)?.count(surface)?;
        if self.curvature.is_none() {
            return Ok(count);
        }
        let side = f64::from(Sizes::equal().side_for_count(surface, count as usize + 1));
        Self { curvature: self.curvature, ..flat }.on(surface, side, false, 180.0)?.count(surface)
    }

    /// The samples' side at each vertex, in unit-sized coordinates; 1 where there are none.
    fn spread(&self, surface: &Surface) -> Vec<f64> {
        if self.samples.is_empty() {
            return vec![1.0; surface.vertex_count()];
        }
        let frame = surface.frame();
        let place = |sample: &SizeSample| GeomWithData::new(frame.to_unit(sample.point), sample.size / frame.diagonal);
        let samples = RTree::bulk_load(self.samples.iter().map(place).collect());
        let size = |v: u32| {
            let (mut sum, mut total) = (0.0, 0.0);
            for (sample, squared) in samples.nearest_neighbor_iter_with_distance_2(surface.point(v)).take(NEAREST) {
                // Coordinates are rounded to 3e-8: a sample nearer than that is at the place itself.
                let weight = 1.0 / (squared + 1e-14);
                sum += weight * sample.data;
                total += weight;
            }
            sum / total
        };
        (0..surface.vertex_count() as u32).into_par_iter().map(size).collect()
    }

    /// The turn of the surface per length at each vertex, in radians; zero where it does not matter.
    fn turns(&self, surface: &Surface, side: f64) -> Option<Vec<f64>> {
        let angle = self.curvature?.to_radians();
        // Bends as narrow as half a tile are seen; what turns by less than half the angle in a tile does not matter.
        let curvatures = curvatures_above(surface, radius_of_tile(side / 2.0), angle / (2.0 * side), &|| false);
        Some(curvatures.iter().map(|bend| bend.values[0].abs()).collect())
    }

    /// The girth of thin parts at each vertex, infinity elsewhere; `None` without thin parts.
    fn girths(&self, surface: &Surface, side: f64, is_cancelled: &IsCancelled) -> Option<Vec<f64>> {
        if self.around == 0.0 {
            return None;
        }
        let mut girths = girths(surface, (self.around * side) as f32, side as f32, is_cancelled);
        // A part has the girth at which the least number of tiles cover it.
        for (girth, area) in girths.iter_mut().zip(surface.areas_of_parts()) {
            let least = (area / LEAST_TILES).sqrt();
            if (SPECK * side..side).contains(&least) {
                *girth = girth.min(self.around * least);
            }
        }
        girths.iter().any(|girth| girth.is_finite()).then_some(girths)
    }
}

/// Sides of tiles, in unit-sized coordinates.
pub(crate) struct SmallSides {
    /// Whether the surface has thin parts.
    pub is_thin: bool,
    /// The sides at each vertex; `None`: all are as large as others.
    pub at_vertices: Option<Vec<f64>>,
}

/// The wanted sizes at the vertices of a surface.
pub(crate) struct Wanted<'a> {
    options: &'a SizeOptions,
    /// The side that samples give, in unit-sized coordinates.
    samples: Vec<f64>,
    /// The turn of the surface per length, in radians.
    turns: Option<Vec<f64>>,
    /// The girth of thin parts, in unit-sized coordinates; infinity elsewhere.
    girths: Option<Vec<f64>>,
    /// The largest side, in unit-sized coordinates; infinity where it is any.
    limits: Option<Vec<f64>>,
    /// The places with sizes of their own.
    places: Vec<Limit>,
    /// The largest side that these allow, in unit-sized coordinates.
    local: Vec<f64>,
    /// The length of a unit, in model units.
    unit: f64,
    /// The scale that smaller tiles do not change, in unit-sized coordinates; `None`: it follows from the count.
    scale: Option<f64>,
}

impl Wanted<'_> {
    /// Sizes for which `count` tiles can be laid.
    ///
    /// # Errors
    /// Where samples give no positive size that an `f32` holds.
    pub fn sizes(&self, surface: &Surface, count: usize) -> Result<Sizes, SizesError> {
        if self.options.samples.is_empty() && self.turns.is_none() && self.is_any(surface) {
            return Ok(Sizes::equal());
        }
        Ok(self.fitted(surface, count)?.0)
    }

    /// Whether nothing bounds the sides but samples and curvature.
    fn is_any(&self, surface: &Surface) -> bool {
        let SizeOptions { least, largest, .. } = self.options;
        let is_bounded = least.is_some() || largest.is_some() || !self.places.is_empty() || surface.keeps_boundary();
        self.girths.is_none() && self.limits.is_none() && !is_bounded
    }

    /// The round curves on which fewer tiles of these sizes would lie than are asked for, or few more, where `count` cover the surface.
    pub fn intervals(&self, surface: &Surface, sizes: &Sizes, count: usize) -> Vec<Intervals> {
        if self.options.around_holes == 0 {
            return Vec::new();
        }
        let scale = f64::from(sizes.side_for_count(surface, count));
        let side = |v: u32| scale * f64::from(sizes.at_vertex(v));
        let asked = self.options.around_holes;
        let of = |(index, curve): (usize, &Curve)| {
            let ends = curve.vertices.windows(2).zip(curve.arcs.windows(2));
            let tiles: f64 = ends.map(|(v, arcs)| 2.0 * (arcs[1] - arcs[0]) / (side(v[0]) + side(v[1]))).sum();
            (tiles < MOST_INTERVALS * asked as f64).then_some(Intervals { curve: index, count: asked })
        };
        round_curves(surface).filter_map(of).collect()
    }

    /// Keeps the scale for `count` tiles of the sizes of the samples: smaller ones are added to them.
    ///
    /// # Errors
    /// As [`Wanted::sizes`].
    pub fn keep_scale(&mut self, surface: &Surface, count: usize) -> Result<(), SizesError> {
        self.scale = Some(f64::from(relative(surface, &self.samples, 1.0)?.side_for_count(surface, count)));
        Ok(())
    }

    /// Sizes for which `count` tiles cover the surface, and their sides, in unit-sized coordinates.
    fn fitted(&self, surface: &Surface, count: usize) -> Result<(Sizes, Vec<f64>), SizesError> {
        let growth = Growth::new(surface);
        if let Some(scale) = self.scale {
            let sides = self.sides(&growth, scale);
            return Ok((relative(surface, &sides, scale)?, sides));
        }
        let mut scale = f64::from(relative(surface, &self.samples, 1.0)?.side_for_count(surface, count));
        let mut rounds = 0..ROUNDS;
        loop {
            let sides = self.sides(&growth, scale);
            let sizes = relative(surface, &sides, scale)?;
            let found = sizes.count_for_side(surface, scale) / count as f64;
            if found.ln().abs() < COUNT_ERROR || rounds.next().is_none() {
                return Ok((sizes, sides));
            }
            scale *= found.sqrt();
        }
    }

    /// Half the sides where they are, within [`REFINED`] of the places, in model units.
    ///
    /// # Errors
    /// As [`Wanted::sizes`].
    pub fn refined(mut self, surface: &Surface, count: usize, places: &[[f64; 3]]) -> Result<Self, SizesError> {
        let (_, sides) = self.fitted(surface, self.raised(surface, count)?)?;
        let places = RTree::bulk_load(places.iter().map(|&place| surface.frame().to_unit(place)).collect());
        let mut limits = self.limits.take().unwrap_or_else(|| vec![f64::INFINITY; surface.vertex_count()]);
        for (v, (limit, side)) in (0..).zip(limits.iter_mut().zip(&sides)) {
            let near = places.nearest_neighbor_iter_with_distance_2(surface.point(v)).next();
            if near.is_some_and(|(_, squared)| squared < (REFINED * side).powi(2)) {
                *limit = side / 2.0;
            }
        }
        Ok(Self { limits: Some(limits), ..self })
    }

    /// The number of tiles that are laid where `count` are asked for: more where most would lie on thin parts or where they are
    /// limited; where the scale is kept, the number that follows.
    ///
    /// # Errors
    /// As [`Wanted::sizes`].
    pub fn raised(&self, surface: &Surface, count: usize) -> Result<usize, SizesError> {
        if self.is_any(surface) && (self.turns.is_none() || self.scale.is_none()) {
            return Ok(count);
        }
        let scale = f64::from(relative(surface, &self.samples, 1.0)?.side_for_count(surface, count));
        let whole = relative(surface, &self.sides(&Growth::new(surface), scale), scale)?.count_for_side(surface, scale);
        if self.scale.is_some() {
            return Ok(whole.round() as usize);
        }
        let is_few = self.limits.is_some() && count <= FEW;
        let share = if is_few || self.options.largest.is_some() { 0.0 } else { THIN_SHARE };
        Ok(if whole > (1.0 + share) * count as f64 { whole as usize } else { count })
    }

    fn count(&self, surface: &Surface) -> Result<f64, SizesError> {
        Ok(relative(surface, &self.sides(&Growth::new(surface), 1.0), 1.0)?.count_for_side(surface, 1.0))
    }

    /// The same where vertices were added to the surface, each in the middle between two.
    pub fn divided(self, surface: &Surface, middles: &[[u32; 2]]) -> Self {
        let between = |values: Option<Vec<f64>>, between: fn(f64, f64) -> f64| {
            values.map(|mut values| {
                for &[a, b] in middles {
                    values.push(between(values[a as usize], values[b as usize]));
                }
                values
            })
        };
        let turns = between(self.turns, |a, b| (a + b) / 2.0);
        let girths = between(self.girths, f64::max);
        let limits = between(self.limits, f64::max);
        let mut local = self.local;
        local.extend(least(&self.places, surface, local.len()));
        Self { samples: self.options.spread(surface), turns, girths, limits, local, ..self }
    }

    /// The sides at this scale: no larger than curvature allows, nor than growth.
    fn sides(&self, growth: &Growth, scale: f64) -> Vec<f64> {
        let mut sides: Vec<f64> = self.samples.iter().map(|side| scale * side).collect();
        if let (Some(degrees), Some(turns)) = (self.options.curvature, &self.turns) {
            for (side, bend) in sides.iter_mut().zip(turns) {
                *side = side.min((degrees.to_radians() / bend).max(LEAST * *side));
            }
        }
        if let Some(girths) = &self.girths {
            for (side, girth) in sides.iter_mut().zip(girths) {
                *side = self.options.thin_side(*side, *girth);
            }
        }
        for (side, limit) in sides.iter_mut().zip(self.limits.iter().flatten()) {
            *side = side.min(*limit);
        }
        sides.iter_mut().zip(&self.local).for_each(|(side, limit)| *side = side.min(*limit));
        let SizeOptions { least, largest, .. } = self.options;
        if let Some(largest) = largest {
            sides.iter_mut().for_each(|side| *side = side.min(largest / self.unit));
        }
        growth.limit(&mut sides, self.options.growth - 1.0);
        if let Some(least) = least {
            sides.iter_mut().for_each(|side| *side = side.max(least / self.unit));
        }
        growth.keep_boundary(&mut sides, self.options.growth - 1.0);
        sides
    }
}

fn relative(surface: &Surface, sides: &[f64], scale: f64) -> Result<Sizes, SizesError> {
    Sizes::from_vertices(surface, sides.iter().map(|side| (side / scale) as f32).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::FeatureOptions;
    use crate::surface::examples::Example;
    use glam::DVec3;

    #[test]
    fn refined_sides_are_half_at_the_places_and_the_count_is_held() {
        let torus = "torus".parse::<Example>().expect("an example").generate(20_000);
        let surface = Surface::new(&torus, &FeatureOptions::default()).expect("a surface");
        let options = SizeOptions::default();
        let (count, side) = (2_000, f64::from(Sizes::equal().side_for_count(&surface, 2_000)));
        let place = surface.frame().near(surface.point(0));
        let sides = |wanted: &Wanted| {
            let sizes = wanted.sizes(&surface, count).expect("sizes");
            let scale = f64::from(sizes.side_for_count(&surface, count));
            let held = sizes.count_for_side(&surface, scale) / count as f64;
            assert!((held - 1.0).abs() < 0.01, "{held}");
            (0..surface.vertex_count() as u32).map(|v| scale * f64::from(sizes.at_vertex(v))).collect::<Vec<_>>()
        };
        let equal = options.on(&surface, side, false, 40.0).expect("sizes");
        assert!(sides(&equal).iter().all(|found| (found / side - 1.0).abs() < 0.01));
        let refined = equal.refined(&surface, count, &[place]).expect("sizes");
        let found = sides(&refined);
        let off = |v: u32| DVec3::from(surface.point(v)).distance(DVec3::from(surface.point(0))) / side;
        for (v, found) in (0..).zip(&found) {
            match off(v) {
                near if near < 0.9 * REFINED => assert!(found / side < 0.51, "{near}: {found}"),
                far if far > 10.0 => assert!(found / side > 0.99, "{far}: {found}"),
                _ => {}
            }
        }
        assert_eq!(refined.raised(&surface, count), Ok(count), "few tiles are more");
        assert!(refined.raised(&surface, 200).expect("a count") > 200, "of few tiles the rest would be too large");
    }
}
