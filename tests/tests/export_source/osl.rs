//! The Open Shading Language: its compiler takes the sources, `oslc` where there is one, or that of
//! Blender as a Python module (`pip install bpy`), whose renderer then runs them.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use brdf_core::AnyBrdf;
use brdf_fit::export::Language;
use brdf_tests::python;

use crate::materials::{brdfs, source};
use crate::points::{Errors, Found, Point, check_single, points};

/// The largest error: exp, log, sin and cos have fewer digits in that renderer, and are half of it at
/// most.
const LIMIT: f64 = 2e-4;

/// Points on one side of a picture, a pixel each.
const SIDE: u16 = 16;

/// The three colours of each of the three pictures. Colours of a light are not negative.
const PICTURES: [&str; 3] = [
    "brdf_eval_angles(p[0], p[1], p[2]), brdf_eval(source, view), brdf_pdf(source, view)",
    "2.0 + drawn[0], 2.0 + drawn[1], 2.0 + drawn[2]",
    "density, weight, 0.0",
];

/// A shader of a square of length 1, the values of the point of a pixel being its colour.
const SHADER: &str = "
shader picture(output color Value = 0.0) {
    float points[COUNT] = {NUMBERS};
    int first = 12 * (int(P[0] * SIDE) + SIDE * int(P[1] * SIDE));
    float p[12];
    for (int i = 0; i < 12; ++i) p[i] = points[first + i];
    vector source = vector(p[3], p[4], p[5]);
    vector view = vector(p[6], p[7], p[8]);
    vector drawn = 0.0;
    float density = 0.0;
    float weight = brdf_sample(source, vector(p[9], p[10], p[11]), drawn, density);
    Value = color(COLORS);
}
";

/// Compiles every shader of the folder, renders it, and writes the colours of the pixels.
const RENDER: &str = "
import bpy, glob, hashlib

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.preferences.addon_enable(module='cycles')
import _cycles

scene = bpy.context.scene
scene.render.engine = 'CYCLES'
cycles = scene.cycles
cycles.device, cycles.shading_system = 'CPU', True
cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = 1, False, False
# The one ray of a pixel goes through its middle.
cycles.pixel_filter_type, cycles.filter_width = 'BOX', 0.01
scene.render.resolution_x = scene.render.resolution_y = SIDE
settings = scene.render.image_settings
settings.file_format, settings.color_depth, settings.color_mode = 'OPEN_EXR', '32', 'RGB'
scene.view_settings.view_transform = 'Raw'

camera = bpy.data.cameras.new('camera')
camera.type, camera.ortho_scale = 'ORTHO', 1.0
scene.camera = bpy.data.objects.new('camera', camera)
scene.camera.location = (0.5, 0.5, 1.0)
scene.collection.objects.link(scene.camera)
square = bpy.data.meshes.new('square')
square.from_pydata([(-1, -1, 0), (2, -1, 0), (2, 2, 0), (-1, 2, 0)], [], [(0, 1, 2, 3)])
scene.collection.objects.link(bpy.data.objects.new('square', square))

def compiled(file):
    target = file.replace('.osl', '.oso')
    assert _cycles.osl_compile(file, target), file
    with open(target) as text:
        return text.read()

def shade(code):
    tree = bpy.data.materials.new('picture')
    square.materials.clear()
    square.materials.append(tree)
    tree.use_nodes = True
    tree = tree.node_tree
    tree.nodes.clear()
    script, light, end = [tree.nodes.new('ShaderNode' + kind)
                          for kind in ('Script', 'Emission', 'OutputMaterial')]
    script.mode, script.bytecode = 'INTERNAL', code
    script.bytecode_hash = hashlib.md5(code.encode()).hexdigest()
    script.outputs.new('NodeSocketColor', 'Value')
    tree.links.new(script.outputs['Value'], light.inputs['Color'])
    tree.links.new(light.outputs['Emission'], end.inputs['Surface'])

for file in sorted(glob.glob('FOLDER/*.osl')):
    code = compiled(file)
    if 'picture' not in file:
        continue
    shade(code)
    scene.render.filepath = file.replace('.osl', '.exr')
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    image.colorspace_settings.name = 'Non-Color'
    with open(file.replace('.osl', '.txt'), 'w') as text:
        text.write(' '.join(repr(x) for x in image.pixels))
";

/// The shader of one of the pictures.
fn picture(brdf: &AnyBrdf, points: &[Point], colors: &str) -> String {
    let numbers = points.iter().flat_map(Point::numbers);
    let numbers: Vec<_> = numbers.map(|number| format!("{number:?}")).collect();
    let shader = SHADER
        .replace("COUNT", &numbers.len().to_string())
        .replace("NUMBERS", &numbers.join(", "))
        .replace("SIDE", &SIDE.to_string())
        .replace("COLORS", colors);
    let functions = source(brdf, Language::Osl, "brdf");
    format!("#define brdf_NO_SHADER\n{functions}{shader}")
}

/// The colours of the pixels of a picture.
fn colors(folder: &Path, name: &str) -> Vec<[f64; 3]> {
    let text = fs::read_to_string(folder.join(format!("{name}.txt"))).expect("a picture");
    let numbers = text.split_whitespace();
    let numbers: Vec<f64> = numbers.map(|x| x.parse().expect("a number")).collect();
    let (pixels, rest) = numbers.as_chunks();
    assert!(rest.is_empty());
    pixels.iter().map(|[r, g, b, _]| [*r, *g, *b]).collect()
}

fn found(pixels: [[f64; 3]; 3]) -> Found {
    let [[of_angles, of_directions, pdf], drawn, [density, weight, _]] = pixels;
    Found {
        of_angles,
        of_directions,
        pdf,
        drawn: drawn.map(|x| x - 2.0),
        density,
        weight,
    }
}

#[test]
fn blender_compiles_and_runs_shaders_with_the_values_of_the_model() {
    let Some(python) = python("bpy") else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: String, text| fs::write(folder.path().join(name + ".osl"), text);
    let all = brdfs();
    let points = all
        .iter()
        .map(|brdf| points(brdf.parameters().k1, u64::from(SIDE * SIDE)));
    let points = points.map(|points| points.into_iter().map(Point::single).collect());
    let points: Vec<Vec<Point>> = points.collect();
    for (i, (brdf, points)) in all.iter().zip(&points).enumerate() {
        write(format!("whole{i}"), source(brdf, Language::Osl, "brdf")).expect("a file");
        for (j, colors) in PICTURES.iter().enumerate() {
            write(format!("picture{i}-{j}"), picture(brdf, points, colors)).expect("a file");
        }
    }
    write("three".to_owned(), three(&all)).expect("a file");
    let path = folder.path().to_str().expect("a path of text");
    let program = RENDER
        .replace("FOLDER", path)
        .replace("SIDE", &SIDE.to_string());
    let output = Command::new(python)
        .args(["-c", &program])
        .output()
        .expect("python starts");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    for (i, (brdf, points)) in all.iter().zip(&points).enumerate() {
        let [a, b, c] = [0, 1, 2].map(|j| colors(folder.path(), &format!("picture{i}-{j}")));
        let pixels = a.into_iter().zip(b).zip(c);
        let found: Vec<_> = pixels.map(|((a, b), c)| found([a, b, c])).collect();
        let errors = Errors::largest(brdf, points, &found);
        println!(
            "{:?} k1 = {}: {errors:?}",
            brdf.family(),
            brdf.parameters().k1
        );
        check_single(&errors, LIMIT);
    }
}

/// Three materials in one shader.
fn three(all: &[AnyBrdf]) -> String {
    let mut text = String::new();
    for (name, brdf) in ["red", "green", "blue"].iter().zip(all) {
        let _ = writeln!(text, "#define {name}_NO_SHADER");
        text += &source(brdf, Language::Osl, name);
    }
    text += "shader three(output float Value = 0.0) {\n";
    text += "    vector up = vector(0.0, 0.0, 1.0);\n";
    text + "    Value = red_eval(up, up) + green_eval(up, up) + blue_eval(up, up);\n}\n"
}

#[test]
fn oslc_takes_one_material_and_three() {
    let found = Command::new("oslc")
        .arg("--version")
        .stdout(Stdio::null())
        .status();
    if !found.is_ok_and(|status| status.success()) {
        println!("no oslc: skipped");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let all = brdfs();
    let single = all.iter().map(|brdf| source(brdf, Language::Osl, "brdf"));
    for text in single.chain([three(&all)]) {
        let (file, target) = (folder.path().join("a.osl"), folder.path().join("a.oso"));
        fs::write(&file, text).expect("a file");
        let status = Command::new("oslc")
            .args(["-Werror", "-o"])
            .args([target, file])
            .status();
        assert!(status.expect("oslc starts").success());
    }
}
