use quadmosaic::{
    compute::*,
    field::*,
    gpu::*,
    mosaic::*,
    surface::{examples::Example, *},
};
use std::time::Instant;
fn main() {
    let n: usize = std::env::args().nth(1).unwrap().parse().unwrap();
    let soup = "m6".parse::<Example>().unwrap().generate(20000);
    let s = Surface::new(&soup, &FeatureOptions::default()).unwrap();
    let gpu = Gpu::open(None).unwrap();
    let g = GpuBackend::new(&gpu).unwrap();
    let f = Field::new(&s, &[], &Cpu).unwrap();
    let f2 = Field::new(&s, &[], &g).unwrap();
    let d = f.crosses().iter().zip(f2.crosses()).filter(|(a, b)| a != b).count();
    println!("field: {d} of {} differ", f.crosses().len());
    let h = side_for_count(&s, n);
    let m = Mosaic::default();
    let _ = m;
    let gc = Cpu.ground(&s, &f).unwrap();
    let gg = g.ground(&s, &f).unwrap();
    let mut tiles = sow::sow(&s, &f, h);
    for steps in [1u32, 1, 1, 1, 8] {
        let r = Relaxation::new(steps, h);
        let t = Instant::now();
        let a = gc.relax(&tiles, &r).unwrap();
        let ta = t.elapsed();
        let t = Instant::now();
        let b = gg.relax(&tiles, &r).unwrap();
        let tb = t.elapsed();
        let (mut p, mut ax, mut nn, mut tr) = (0, 0, 0, 0);
        for (x, y) in a.iter().zip(&b) {
            p += (x.position != y.position) as u32;
            ax += (x.axis != y.axis) as u32;
            nn += (x.normal != y.normal) as u32;
            tr += (x.triangle != y.triangle) as u32;
        }
        println!("{steps} steps: pos {p} axis {ax} normal {nn} tri {tr} of {}  cpu {ta:?} gpu {tb:?}", a.len());
        if let Some((x, y)) = a.iter().zip(&b).find(|(x, y)| x.position != y.position) {
            println!("{x:?}\n{y:?}");
        }
        tiles = a;
    }
}
