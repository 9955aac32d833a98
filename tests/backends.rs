//! The whole mesh, the CPU backend against the GPU.

mod common;

use quadmosaic::compute::{Backend, Cpu};
use quadmosaic::gpu::GpuBackend;
use quadmosaic::mesh::Mesh;
use quadmosaic::mesh::quality::Quality;
use quadmosaic::pipeline::{Fineness, Options, run, unwatched};
use quadmosaic::surface::examples::Example;

fn mesh(name: &str, points: usize, backend: &dyn Backend) -> Mesh {
    let soup = name.parse::<Example>().unwrap().generate(5000);
    run(&soup, &Options::new(Fineness::Points(points)), backend, &unwatched).unwrap().meshed.mesh
}

#[test]
fn the_mesh_is_the_same() {
    let Some(gpu) = common::gpu() else { return };
    let backend = GpuBackend::new(gpu).unwrap();
    for name in Example::NAMES {
        let (cpu, other) = (mesh(name, 1500, &Cpu), mesh(name, 1500, &backend));
        if gpu.adapter().hardware {
            // Roundings differ, and with them which rows end where: the figures agree, not the meshes. A hundredth of
            // the faces is what another seed of the sowing changes too.
            let [a, b] = [Quality::of(&cpu), Quality::of(&other)];
            assert!((a.qr - b.qr).abs() < 0.02, "{name}: Qr {} and {}", a.qr, b.qr);
            assert!((a.vertices as f64 / b.vertices as f64 - 1.0).abs() < 0.03, "{name}");
        } else {
            assert_eq!(cpu, other, "{name}");
        }
    }
}

#[test]
fn another_mesh_is_noticed() {
    let Some(gpu) = common::gpu() else { return };
    let backend = GpuBackend::new(gpu).unwrap();
    assert_ne!(mesh("torus", 1500, &Cpu), mesh("torus", 1510, &backend));
}
