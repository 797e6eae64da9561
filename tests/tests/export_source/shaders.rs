//! GLSL and WGSL: naga reads, validates and translates them, and their functions have the values of
//! the model in `f32`.

use brdf_core::{AnyBrdf, Sampler};
use brdf_fit::export::Language;
use naga::Module;

use crate::coatings::{Point, brdfs, geometry, geometry_of_angles, points, source, wide};
use crate::interpreter::{Interpreter, Value};
use crate::shader::{from_glsl, from_wgsl};

/// The largest relative error in `f32`, up to 85 deg and for k1 from 0.01 on: what the batch of the
/// model promises.
const SINGLE: f64 = 1e-5;

/// The largest relative error of the density: where w_s is nearly 1, what is left of 1 has fewer
/// digits. The directions are drawn with the same w_s, so that no estimate suffers.
const DENSITY: f64 = 2e-4;

/// A shader that calls what is for the user, without an output parameter.
const WGSL_MAIN: &str = "
fn sampled(source: vec3<f32>, numbers: vec3<f32>) -> array<f32, 5> {
    let drawn = NAME_sample(source, numbers);
    return array<f32, 5>(drawn.view.x, drawn.view.y, drawn.view.z, drawn.density, drawn.weight);
}

@fragment
fn main(@location(0) source: vec3<f32>, @location(1) view: vec3<f32>) -> @location(0) vec4<f32> {
    let all = sampled(source, view);
    let value = NAME_eval(source, view) + NAME_eval_angles(view.x, view.y, view.z);
    return vec4<f32>(value, NAME_pdf(source, view), all[3], all[4]);
}
";

const GLSL_MAIN: &str = "
float[5] sampled(vec3 source, vec3 numbers) {
    vec3 view;
    float density;
    float weight = NAME_sample(source, numbers, view, density);
    return float[5](view.x, view.y, view.z, density, weight);
}

layout(location = 0) in vec3 source;
layout(location = 1) in vec3 view;
layout(location = 0) out vec4 color;

void main() {
    float[5] all = sampled(source, view);
    float value = NAME_eval(source, view) + NAME_eval_angles(view.x, view.y, view.z);
    color = vec4(value, NAME_pdf(source, view), all[3], all[4]);
}
";

fn wgsl(brdf: &AnyBrdf) -> Module {
    let text = source(brdf, Language::Wgsl, "paint");
    from_wgsl(&(text + &WGSL_MAIN.replace("NAME", "paint")))
}

fn glsl(brdf: &AnyBrdf) -> Module {
    let text = source(brdf, Language::Glsl, "paint");
    from_glsl(&format!(
        "#version 450\n{text}{}",
        GLSL_MAIN.replace("NAME", "paint")
    ))
}

/// The largest relative errors of f_r of directions, of angles, and of the density, and the largest
/// distance of a sampled direction.
fn errors(module: &Module, brdf: &AnyBrdf, points: &[Point]) -> [f64; 4] {
    let mut shader = Interpreter::new(module);
    let sampler = Sampler::new(brdf);
    let mut worst = [0.0_f64; 4];
    for point in points {
        let [source, view, numbers] = [point.source, point.view, point.numbers].map(Value::vector);
        let mut value = |name, arguments: &[Value]| f64::from(shader.call(name, arguments).float());
        let eval = value("paint_eval", &[source.clone(), view.clone()]);
        let of_angles = value("paint_eval_angles", &point.angles.map(Value::Float));
        let pdf = value("paint_pdf", &[source.clone(), view]);
        let expected_pdf = sampler.pdf(&wide(point.source), &wide(point.view));
        let relative = |value: f64, exact: f64| (value / exact - 1.0).abs();
        let found = [
            relative(eval, brdf.value(&geometry(point))),
            relative(of_angles, brdf.value(&geometry_of_angles(point))),
            relative(pdf, expected_pdf.expect("directions")),
            distance(&shader.call("sampled", &[source, numbers]), &sampler, point),
        ];
        worst = std::array::from_fn(|i| worst[i].max(found[i]));
    }
    worst
}

/// The distance of a sampled direction from that of the sampler. Density and weight go with the
/// direction; where that is below the surface, they are 0.
fn distance(sampled: &Value, sampler: &Sampler, point: &Point) -> f64 {
    let [x, y, z, density, weight] = [0, 1, 2, 3, 4].map(|i| sampled.parts()[i].float());
    let expected = sampler.sample(&wide(point.source), point.numbers.map(f64::from));
    let Some(expected) = expected.expect("a source") else {
        assert!(z <= 1e-6 && (z > 0.0 || (density, weight) == (0.0, 0.0)));
        return 0.0;
    };
    let drawn = wide([x, y, z]);
    assert!(
        (f64::from(weight) / expected.weight - 1.0).abs() < 1e-3,
        "{weight} {expected:?}"
    );
    assert!(
        (f64::from(density) / expected.pdf - 1.0).abs() < 1e-3,
        "{density} {expected:?}"
    );
    (drawn - expected.direction).norm()
}

#[test]
fn naga_reads_and_translates_what_has_the_values_of_the_model() {
    println!("largest relative error of eval, eval_angles, pdf, and distance of a sampled view");
    for brdf in brdfs() {
        let k1 = brdf.parameters().k1;
        let points = points(k1, 100);
        for (language, module) in [("WGSL", wgsl(&brdf)), ("GLSL", glsl(&brdf))] {
            let found = errors(&module, &brdf, &points);
            let words = found.map(|error| format!("{error:.1e}")).join(" ");
            println!("{language} {:?} k1 = {k1}: {words}", brdf.family());
            assert!(found[0] <= SINGLE && found[1] <= SINGLE && found[3] <= SINGLE);
            assert!(found[2] <= DENSITY);
        }
    }
}

#[test]
fn below_the_surface_and_outside_the_domain_is_nothing() {
    for brdf in brdfs() {
        for module in [wgsl(&brdf), glsl(&brdf)] {
            let mut shader = Interpreter::new(&module);
            let [up, below] = [[0.0, 0.0, 1.0], [0.6, 0.0, -0.8]].map(Value::vector);
            for directions in [
                [up.clone(), below.clone()],
                [below.clone(), up],
                [below.clone(), below],
            ] {
                assert_eq!(shader.call("paint_eval", &directions), Value::Float(0.0));
                assert_eq!(shader.call("paint_pdf", &directions), Value::Float(0.0));
            }
            for angles in [
                [-0.1, 0.0, 0.0],
                [1.6, 0.0, 0.0],
                [0.0, -1.6, 0.0],
                [6.5, 0.0, 0.0],
            ] {
                let value = shader.call("paint_eval_angles", &angles.map(Value::Float));
                assert_eq!(value, Value::Float(0.0));
            }
        }
    }
}

#[test]
fn three_coatings_fit_into_one_shader() {
    let all = brdfs();
    let pieces = ["red", "green", "blue_2"].iter().zip(&all);
    let [glsl, wgsl] = [Language::Glsl, Language::Wgsl].map(|language| {
        let texts = pieces
            .clone()
            .map(|(name, brdf)| source(brdf, language, name));
        texts.collect::<String>()
    });
    from_glsl(&format!(
        "#version 450\n{glsl}{}",
        GLSL_MAIN.replace("NAME", "green")
    ));
    from_wgsl(&(wgsl + &WGSL_MAIN.replace("NAME", "green")));
}
