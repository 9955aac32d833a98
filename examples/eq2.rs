use quadmosaic::{compute::*, field::*, gpu::*};
fn main() {
    let gpu = Gpu::open(None).unwrap();
    let g = GpuBackend::new(&gpu).unwrap();
    let mut s = 12345u64;
    let mut r = move || {
        s = s.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((s >> 40) as f32) / (1u64 << 24) as f32 - 0.5
    };
    let n = 1000usize;
    for (deg, constrained, pulls, rot) in [
        (1, false, false, false),
        (1, false, false, true),
        (2, false, false, true),
        (6, false, false, true),
        (6, true, false, true),
        (6, true, true, true),
    ] {
        let mut l = Level::default();
        l.starts.push(0);
        for i in 0..n {
            for _ in 0..deg {
                l.neighbours.push(((r() + 0.5) * n as f32) as u32 % n as u32);
                l.weights.push(if rot { [r() / 3.0, r() / 3.0] } else { [r(), 0.0] });
            }
            l.starts.push(l.neighbours.len() as u32);
            l.pulls.push(if pulls || i % 3 == 0 { [r(), r()] } else { [0.0, 0.0] });
        }
        let h = Hierarchy { levels: vec![l.clone()], constrained };
        let a = Cpu.smooth_field(&h).unwrap();
        let b = g.smooth_field(&h).unwrap();
        println!("{deg} {constrained} {pulls} {rot}: {} differ", a.iter().zip(&b).filter(|(x, y)| x != y).count());
        let p = Level {
            parents: (0..n).map(|i| (i / 2) as u32).collect(),
            turns: (0..n).map(|_| [r(), r()]).collect(),
            starts: vec![0; n + 1],
            neighbours: vec![],
            weights: vec![],
            pulls: vec![[0.0, 0.0]; n],
        };
        let _ = p;
    }
}
