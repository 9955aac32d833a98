use super::*;
use crate::compute::Cpu;
use crate::field::{Field, Sectors, guides};
use crate::surface::{FeatureOptions, Surface, Soup, examples::Example, next};
use std::f64::consts::FRAC_PI_2;
use std::time::Instant;

pub fn load(name: &str) -> Soup {
    let mut soup = Soup::default();
    let text = std::fs::read_to_string(format!("/work/shared/models/{name}.obj")).unwrap();
    for l in text.lines() {
        let w: Vec<&str> = l.split_whitespace().collect();
        match w.first() {
            Some(&"v") => soup.points.push([1, 2, 3].map(|k| w[k].parse().unwrap())),
            Some(&"f") => {
                let ids: Vec<u32> = w[1..].iter().map(|x| x.split('/').next().unwrap().parse::<u32>().unwrap() - 1).collect();
                for k in 2..ids.len() { soup.triangles.push([ids[0], ids[k - 1], ids[k]]); }
            }
            _ => {}
        }
    }
    soup
}

/// plus, minus quarters, and unit energy of the field
fn figures(surface: &Surface, sectors: &Sectors, hierarchy: &Hierarchy, crosses: &[Complex]) -> (i64, i64, f64) {
    let angle = |c: u32| { let z = crosses[sectors.of_corner[c as usize] as usize]; f64::from(z[1]).atan2(f64::from(z[0])) / 4.0 };
    let difference = |h: u32| { let d = angle(next(h)) + sectors.transport(h) - angle(h); d - (d / FRAC_PI_2).round() * FRAC_PI_2 };
    let (mut plus, mut minus) = (0, 0);
    for t in 0..surface.triangle_count() as u32 {
        let h = [3 * t, 3 * t + 1, 3 * t + 2];
        let scaled: f64 = h.iter().map(|&c| sectors.direction(c, sectors.corner_angle(c)) - sectors.direction(c, 0.0)).sum();
        let turned: f64 = h.iter().map(|&h| match surface.twin(h) { Some(twin) if twin < h && !surface.features().is_feature(h) => -difference(twin), _ => difference(h) }).sum();
        let q = ((turned + scaled - std::f64::consts::PI) / FRAC_PI_2).round() as i64;
        if q > 0 { plus += q } else { minus += q }
    }
    let level = &hierarchy.levels[0];
    let mut e = 0.0;
    for i in 0..level.len() { for l in level.links_of(i) {
        let (w, z) = (l.weight.map(f64::from), crosses[l.neighbour as usize].map(f64::from));
        let m = w[0].hypot(w[1]);
        let a = crosses[i].map(f64::from);
        let d = [a[0] - (w[0] * z[0] - w[1] * z[1]) / m, a[1] - (w[0] * z[1] + w[1] * z[0]) / m];
        e += m * (d[0] * d[0] + d[1] * d[1]) / 2.0;
    } }
    (plus, minus, e / 16.0)
}

#[test]
#[ignore]
fn times() {
    for n in [20_000, 200_000, 1_000_000] {
        let soup = "m6".parse::<Example>().unwrap().generate(n);
        let mut best = [f64::MAX; 5];
        for _ in 0..5 {
            let mut k = 0;
            let mut at = Instant::now();
            let mut lap = || { best[k] = f64::min(best[k], at.elapsed().as_secs_f64() * 1e3); at = Instant::now(); k += 1; };
            let surface = Surface::new(&soup, &FeatureOptions::default()).unwrap();
            lap();
            let sectors = Sectors::new(&surface);
            lap();
            let pulls = guides::pulls(&surface, &sectors, &[]);
            lap();
            let hierarchy = Hierarchy::new(&surface, &sectors, &pulls);
            lap();
            smooth(&hierarchy);
            lap();
        }
        eprintln!("{n}: surface, sectors, pulls, hierarchy, smooth {best:.1?}");
    }
}

#[test]
#[ignore]
fn lab() {
    let mut models: Vec<(String, Soup, f64)> = vec![];
    for (n, c) in [("torus", 3_000), ("torus", 20_000), ("torus", 100_000), ("sphere", 3_000), ("sphere", 20_000), ("sphere", 100_000), ("m6", 100_000), ("block", 20_000)] {
        models.push((format!("{n}{c}"), n.parse::<Example>().unwrap().generate(c), 40.0));
    }
    for m in if std::env::var("FREE").is_ok() { vec![] } else { vec!["fish_blub", "spot", "fandisk", "anchor", "m6_gen"] } { models.push((m.into(), load(m), 40.0)); }
    for m in ["fish_blub", "spot", "anchor"] { models.push((format!("{m}-smooth"), load(m), 180.0)); }
    if std::env::var("FREE").is_ok() { models.retain(|m| m.2 > 90.0 || m.0.starts_with('t') || m.0.starts_with('s')); for m in ["holes_cgal","fandisk"] { models.push((m.into(), load(m), 180.0)); } }
 for (name, soup, crease) in &models {
        let surface = Surface::new(soup, &FeatureOptions { crease: *crease, ..Default::default() }).unwrap();
        let sectors = Sectors::new(&surface);
        let pulls = guides::pulls(&surface, &sectors, &[]);
        let hierarchy = Hierarchy::new(&surface, &sectors, &pulls);
        let sizes: Vec<usize> = hierarchy.levels.iter().map(|l| l.len()).collect();
        let _ = sizes;
        let crosses = smooth(&hierarchy);
        let (p, m, e) = figures(&surface, &sectors, &hierarchy, &crosses);
        // flow it far, for comparison
        let mut work = Work::new(&hierarchy.levels);
        work.states[0].crosses = crosses;
        for _ in 0..2000 { work.flow(0, 0.75).unwrap(); }
        let (p2, m2, e2) = figures(&surface, &sectors, &hierarchy, &work.states[0].crosses);
        eprintln!("{name:14} quarters {p:3} {m:3} energy {e:9.3}; after 2000 sweeps {p2:3} {m2:3} {e2:9.3}");
    }
    strip();
}

fn strip() {
    for columns in [20usize, 64, 128] {
        let soup = crate::field::smooth::lab::flat(columns, columns);
        let surface = Surface::new(&soup, &FeatureOptions::default()).unwrap();
        let sectors = Sectors::new(&surface);
        let at = |s: usize| { let p = surface.points[surface.origin(sectors.first_corner[s]) as usize]; surface.frame().to_model(p.to_array().map(f64::from)) };
        let frame = |s: usize| {
            let c = sectors.first_corner[s];
            let d = surface.points[surface.target(c) as usize] - surface.points[surface.origin(c) as usize];
            f64::from(d.y).atan2(f64::from(d.x))
        };
        let n = columns as f64;
        let pulls: Vec<_> = (0..sectors.count()).map(|s| {
            let x = at(s)[0] / n;
            let a = if x < 1e-5 { 0.0 } else if x > 0.99999 { 30f64.to_radians() } else { return guides::Pull::none() };
            let t = 4.0 * (a - frame(s));
            guides::Pull::fixed([t.cos() as f32, t.sin() as f32])
        }).collect();
        let hierarchy = Hierarchy::new(&surface, &sectors, &pulls);
        let crosses = smooth(&hierarchy);
        let (mut chord, mut arc) = (0.0f64, 0.0f64);
        for s in 0..sectors.count() {
            let x = at(s)[0] / n;
            let z = crosses[s];
            let a = f64::from(z[1]).atan2(f64::from(z[0])) / 4.0 + frame(s);
            let w = |d: f64| (d - (d / FRAC_PI_2).round() * FRAC_PI_2).abs().to_degrees();
            let (sn, cs) = 120f64.to_radians().sin_cos();
            chord = chord.max(w(a - (x * sn).atan2(1.0 - x + x * cs) / 4.0));
            arc = arc.max(w(a - x * 30f64.to_radians()));
        }
        eprintln!("strip {columns}: from the chord {chord:.3}, from the arc {arc:.3}");
    }
}

pub fn flat(columns: usize, rows: usize) -> Soup {
    let at = |i: usize, j: usize| (j * (columns + 1) + i) as u32;
    let mut soup = Soup::default();
    for j in 0..=rows { soup.points.extend((0..=columns).map(|i| [i as f64, j as f64, 0.0])); }
    for j in 0..rows { for i in 0..columns {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        soup.triangles.extend(if (i + j) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
    } }
    soup
}
