//! Every shader is parsed and validated, and the Rust side of its records is laid out as the shader's is.

mod common;

use std::mem::offset_of;
use std::path::Path;

use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{AddressSpace, Expression, Handle, Literal, Module, TypeInner};
use quadmosaic::compute::cpu::{grid, relax};
use quadmosaic::compute::{
    LIST_LENGTH, Link, MIRRORED, MOST_EDGES, NEGLIGIBLE, REACH, Row, SKIN, TARGET_LENGTH, Tile, Triangle,
};
use quadmosaic::gpu::conjugate::Sum;
use quadmosaic::gpu::grid::GridSettings;
use quadmosaic::gpu::smooth::Sweep;
use quadmosaic::gpu::transfer::Transfer;
use quadmosaic::gpu::{Access, GpuError, Program, WORKGROUP};

/// The kernels' files, each joined after `common.wgsl`, and `common.wgsl` alone.
fn sources() -> Vec<(String, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    let common = read("common.wgsl");
    let mut names: Vec<String> = std::fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name.ends_with(".wgsl"))
        .collect();
    names.sort();
    let joined = |name: String| {
        let own = if name == "common.wgsl" { String::new() } else { read(&name) };
        let source = [common.as_str(), &own].join("\n");
        (name, source)
    };
    names.into_iter().map(joined).collect()
}

/// The module, valid without any feature beyond WebGPU's base, or why not.
fn validated(source: &str) -> Result<Module, String> {
    let module = naga::front::wgsl::parse_str(source).map_err(|error| error.emit_to_string(source))?;
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
    validator.validate(&module).map_err(|error| error.emit_to_string(source))?;
    Ok(module)
}

/// All shaders' modules; a test that needs them fails with every shader's faults at once.
fn modules() -> Vec<(String, Module)> {
    let (mut modules, mut faults) = (vec![], vec![]);
    for (name, source) in sources() {
        match validated(&source) {
            Ok(module) => modules.push((name, module)),
            Err(fault) => faults.push(format!("{name}: {fault}")),
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    modules
}

#[test]
fn every_shader_is_valid() {
    let modules = modules();
    let kernels: usize = modules.iter().map(|(_, module)| module.entry_points.len()).sum();
    println!("{} shader files, {kernels} kernels", modules.len());
    assert!(modules.len() >= 2 && kernels >= 1);
}

#[test]
fn a_broken_shader_is_not_valid() {
    for (name, source) in sources() {
        let broken = format!("{source}\nfn broken() -> u32 {{ return 1.5; }}\n");
        assert!(validated(&broken).is_err(), "{name}");
    }
}

#[test]
fn every_kernel_fits_the_default_limits() {
    for (name, module) in modules() {
        let buffers = |wanted: fn(&AddressSpace) -> bool| {
            module.global_variables.iter().filter(|(_, variable)| wanted(&variable.space)).count()
        };
        let storage = buffers(|space| matches!(space, AddressSpace::Storage { .. }));
        let uniforms = buffers(|space| matches!(space, AddressSpace::Uniform));
        let workgroup_bytes: u32 = module
            .global_variables
            .iter()
            .filter(|(_, variable)| variable.space == AddressSpace::WorkGroup)
            .map(|(_, variable)| module.types[variable.ty].inner.size(module.to_ctx()))
            .sum();
        println!("{name}: {storage} storage buffers, {uniforms} uniforms, {workgroup_bytes} bytes a workgroup");
        assert!(storage <= 8 && uniforms <= 12 && workgroup_bytes <= 16_384, "{name}");
        for kernel in &module.entry_points {
            assert_eq!(kernel.workgroup_size, [WORKGROUP, 1, 1], "{name}: {}", kernel.name);
        }
    }
}

/// A struct's size in bytes, and its fields' names and offsets.
#[derive(Debug, PartialEq)]
struct Layout {
    size: u32,
    fields: Vec<(String, u32)>,
}

macro_rules! layout {
    ($record:ty: $($field:ident),+) => {
        Layout {
            size: size_of::<$record>() as u32,
            fields: vec![$((stringify!($field).to_owned(), offset_of!($record, $field) as u32)),+],
        }
    };
}

/// The records that both sides know: the struct's name in WGSL, and its layout in Rust.
fn shared_records() -> Vec<(&'static str, Layout)> {
    vec![
        ("Grid", layout!(GridSettings: count, stride, mask, per_unit)),
        ("Tile", layout!(Tile: position, h, normal, triangle, axis, quarters)),
        ("Triangle", layout!(Triangle: corners, beyond)),
        ("Sweep", layout!(Sweep: count, step)),
        ("Row", layout!(Row: start, diagonal, mass)),
        ("Transfer", layout!(Transfer: fine, coarse)),
        ("Sum", layout!(Sum: count, numerator, denominator, to)),
    ]
}

fn layout_in(module: &Module, name: &str) -> Option<Layout> {
    module.types.iter().find_map(|(_, ty)| match &ty.inner {
        TypeInner::Struct { members, span } if ty.name.as_deref() == Some(name) => {
            let field = |member: &naga::StructMember| (member.name.clone().unwrap_or_default(), member.offset);
            Some(Layout { size: *span, fields: members.iter().map(field).collect() })
        }
        _ => None,
    })
}

#[test]
fn records_are_laid_out_alike_on_both_sides() {
    let modules = modules();
    for (name, rust) in shared_records() {
        let found: Vec<_> =
            modules.iter().filter_map(|(file, module)| Some((file, layout_in(module, name)?))).collect();
        assert!(!found.is_empty(), "no shader declares {name}");
        for (file, wgsl) in found {
            assert_eq!(rust, wgsl, "{name} in {file}");
        }
    }
}

/// `Link` and `Parent` are one record in Rust, a number and a complex factor; WGSL spells the factor out.
#[test]
fn links_and_parents_have_the_record_s_size_and_places() {
    let modules = modules();
    let rust = layout!(Link: neighbour, weight);
    for name in ["Link", "Parent"] {
        let wgsl = modules.iter().find_map(|(_, module)| layout_in(module, name)).unwrap();
        assert_eq!(rust.size, wgsl.size, "{name}");
        let places: Vec<u32> = wgsl.fields.iter().map(|field| field.1).collect();
        assert_eq!(places, [rust.fields[0].1, rust.fields[1].1, rust.fields[1].1 + 4], "{name}");
    }
}

/// The numbers that both sides know, by their names in WGSL; whole numbers below 2^32 are exact.
fn shared_constants() -> Vec<(&'static str, Vec<f64>)> {
    vec![
        ("WORKGROUP", vec![f64::from(WORKGROUP)]),
        ("NONE", vec![f64::from(quadmosaic::surface::NONE)]),
        ("REACH", vec![f64::from(REACH)]),
        ("SKIN", vec![f64::from(SKIN)]),
        ("LIST_LENGTH", vec![LIST_LENGTH as f64]),
        ("CELL_LIMIT_BITS", vec![f64::from(grid::CELL_LIMIT.to_bits())]),
        ("OUTSIDE", vec![f64::from(grid::OUTSIDE)]),
        ("TARGET_LENGTH", vec![f64::from(TARGET_LENGTH)]),
        ("NEGLIGIBLE", vec![f64::from(NEGLIGIBLE)]),
        ("MIRRORED", vec![f64::from(MIRRORED)]),
        ("LEAST_COSINE", vec![f64::from(relax::LEAST_COSINE)]),
        ("SHEET", vec![f64::from(relax::SHEET)]),
        ("STEP", vec![f64::from(relax::STEP)]),
        ("DIAGONAL", vec![f64::from(relax::DIAGONAL)]),
        ("MOST_EDGES", vec![f64::from(MOST_EDGES)]),
        ("ARC", relax::ARC.map(f64::from).to_vec()),
    ]
}

/// The numbers of a constant expression.
fn numbers(module: &Module, expression: Handle<Expression>) -> Vec<f64> {
    match &module.global_expressions[expression] {
        Expression::Literal(Literal::F32(x)) => vec![f64::from(*x)],
        Expression::Literal(Literal::U32(x)) => vec![f64::from(*x)],
        Expression::Literal(Literal::I32(x)) => vec![f64::from(*x)],
        Expression::Compose { components, .. } => {
            components.iter().flat_map(|&component| numbers(module, component)).collect()
        }
        other => panic!("{other:?} is no constant that this test can read"),
    }
}

/// The constants of a module that have another value than `shared` has, or that it does not know.
fn unlike(module: &Module, shared: &[(&'static str, Vec<f64>)]) -> Vec<String> {
    let named = module.constants.iter().filter_map(|(_, constant)| Some((constant.name.clone()?, constant.init)));
    let known = |name: &str| shared.iter().find(|constant| constant.0 == name).map(|constant| &constant.1);
    named.filter(|(name, init)| known(name) != Some(&numbers(module, *init))).map(|(name, _)| name).collect()
}

#[test]
fn constants_are_the_same_on_both_sides() {
    let (modules, shared) = (modules(), shared_constants());
    for (name, module) in &modules {
        assert_eq!(unlike(module, &shared), Vec::<String>::new(), "{name}");
    }
    let used = |name: &str| {
        modules
            .iter()
            .any(|(_, module)| module.constants.iter().any(|(_, constant)| constant.name.as_deref() == Some(name)))
    };
    for (name, _) in &shared {
        assert!(used(name), "no shader has {name}");
    }
}

#[test]
fn another_constant_is_noticed() {
    let (_, relax) = sources().into_iter().find(|(name, _)| name == "relax.wgsl").unwrap();
    for (one, other, wrong) in [
        ("SHEET: f32 = 0.6", "SHEET: f32 = 0.6000001", "SHEET"),
        ("0.04464286", "0.0446429", "ARC"),
        ("const STEP", "const STRIDE: u32 = 7u; const STEP", "STRIDE"),
    ] {
        assert!(relax.contains(one));
        let module = naga::front::wgsl::parse_str(&relax.replace(one, other)).unwrap();
        assert_eq!(unlike(&module, &shared_constants()), [wrong]);
    }
}

#[test]
fn a_padded_or_renamed_field_is_another_layout() {
    #[repr(C)]
    struct Padded {
        count: u32,
        stride: u64,
        mask: u32,
        per_unit: f32,
    }
    #[repr(C)]
    struct Swapped {
        stride: u32,
        count: u32,
        mask: u32,
        per_unit: f32,
    }
    let module = validated(&sources()[0].1).unwrap();
    let wgsl = layout_in(&module, "Grid").unwrap();
    assert_ne!(layout!(Padded: count, stride, mask, per_unit), wgsl);
    assert_ne!(layout!(Swapped: stride, count, mask, per_unit), wgsl);
}

#[test]
fn the_driver_s_complaints_are_errors_that_name_the_kernel() {
    let Some(gpu) = common::gpu() else { return };
    let program = |source: &str, access: &[Access]| Program::new(gpu, "faulty", source, access);
    let rejected = |error: GpuError| {
        let message = error.to_string();
        assert!(matches!(error, GpuError::Rejected { .. }) && message.contains("faulty"), "{message}");
    };
    rejected(program("fn half( {", &[]).unwrap_err());

    let source = "@group(0) @binding(0) var<storage, read_write> out: array<u32>;
        @compute @workgroup_size(WORKGROUP) fn one() { out[0] = 1u; }";
    rejected(program(source, &[Access::Write]).unwrap().kernel(gpu, "two").unwrap_err());
    rejected(program(source, &[Access::Uniform]).unwrap().kernel(gpu, "one").unwrap_err());
    rejected(program(source, &[Access::Write]).unwrap().bind(gpu, &[]).unwrap_err());

    // After all that the device still works.
    let program = program(source, &[Access::Write]).unwrap();
    let out = gpu.zeros::<u32>("one number", 1).unwrap();
    let bindings = program.bind(gpu, &[&out]).unwrap();
    let mut recording = gpu.record();
    recording.dispatch(&program.kernel(gpu, "one").unwrap(), &bindings, 1);
    recording.submit().unwrap();
    assert_eq!(gpu.read(&out).unwrap(), [1]);
}

#[test]
fn a_buffer_above_the_limits_is_refused_with_both_numbers() {
    let Some(gpu) = common::gpu() else { return };
    match gpu.zeros::<[f32; 4]>("too much", 8 * 1024 * 1024 + 1) {
        Err(GpuError::BufferTooLarge { needed, allowed, .. }) => {
            assert_eq!((needed, allowed), (128 * 1024 * 1024 + 16, 128 * 1024 * 1024));
        }
        other => panic!("{other:?}"),
    }
    assert!(gpu.zeros::<[f32; 4]>("just enough", 8 * 1024 * 1024).is_ok());
    assert!(matches!(gpu.zeros::<u64>("absurd", usize::MAX), Err(GpuError::BufferTooLarge { .. })));
}
