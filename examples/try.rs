use quadmosaic::{
    compute::Cpu,
    mesh::{check, quality::Quality},
    surface::Soup,
};
use std::time::Instant;
fn main() {
    let path = std::env::args().nth(1).unwrap();
    let n: usize = std::env::args().nth(2).unwrap().parse().unwrap();
    let out = std::env::args().nth(3).unwrap();
    let t = Instant::now();
    let text = std::fs::read_to_string(&path).unwrap();
    let mut soup = Soup::default();
    for l in text.lines() {
        let w: Vec<&str> = l.split_whitespace().collect();
        match w.first() {
            Some(&"v") => soup.points.push([1, 2, 3].map(|i| w[i].parse().unwrap())),
            Some(&"f") => {
                let id: Vec<u32> =
                    w[1..].iter().map(|s| s.split('/').next().unwrap().parse::<u32>().unwrap() - 1).collect();
                for k in 1..id.len() - 1 {
                    soup.triangles.push([id[0], id[k], id[k + 1]]);
                }
            }
            _ => {}
        }
    }
    let lap = |name: &str| println!("{name:12} {:8.1} ms", t.elapsed().as_secs_f64() * 1e3);
    lap("read");
    let options = quadmosaic::pipeline::Options::new(quadmosaic::pipeline::Fineness::Points(n));
    let gpu;
    let back;
    let mut backend: &dyn quadmosaic::compute::Backend = &Cpu;
    if std::env::args().nth(4).is_some() {
        gpu = quadmosaic::gpu::Gpu::open(None).unwrap();
        lap("gpu");
        back = quadmosaic::gpu::GpuBackend::new(&gpu).unwrap();
        backend = &back;
        lap("kernels");
        println!("{}", backend.adapter());
    }
    let o = quadmosaic::pipeline::run(&soup, &options, backend, &|_, _| {}).unwrap();
    for (s, d) in &o.times {
        print!("{} {:.0} ", s.name(), d.as_secs_f64() * 1e3);
    }
    println!(
        "| {} tiles, {} sites, extra {}, holes {}",
        o.mosaic.count(),
        o.mosaic.sites.len(),
        o.triangulation.extra,
        o.holes
    );
    println!(
        "{:?}",
        o.cleaned.map(|c| (c.merged, c.rows, c.turns, c.removed, c.paired, c.triangles_before, c.triangles_after))
    );
    let q = Quality::of(&o.before);
    println!("before Qr {:.4} Qg {:.4}", q.qr, q.qg.unwrap().mean);
    let mesh = o.mesh;
    let c = check::check(&mesh).to_string();
    println!("{}", c.lines().next().unwrap());
    let mut t = String::new();
    for p in &mesh.points {
        t += &format!("v {} {} {}\n", p[0], p[1], p[2]);
    }
    for f in mesh.faces() {
        t += "f";
        for v in f {
            t += &format!(" {}", v + 1);
        }
        t += "\n";
    }
    std::fs::write(out, t).unwrap();
}
