//! GLSL and WGSL: naga reads, validates and translates them, and their functions have the values of
//! the model in `f32`.

use brdf_core::AnyBrdf;
use brdf_fit::export::Language;
use naga::Module;

use crate::interpreter::{Interpreter, Value};
use crate::materials::{brdfs, source};
use crate::points::{Errors, Found, Point, SINGLE, check_single, narrow, points};
use crate::shader::{from_glsl, from_wgsl};

/// A shader that calls the functions for the user, without output parameters.
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

/// The results of the functions of a shader.
fn found(module: &Module, points: &[Point]) -> Vec<Found> {
    let mut shader = Interpreter::new(module);
    let at = |point: &Point| {
        let [angles, source, view, numbers] =
            [point.angles, point.source, point.view, point.numbers].map(narrow);
        let [source, view, numbers] = [source, view, numbers].map(Value::vector);
        let of_angles = shader.call("paint_eval_angles", &angles.map(Value::Float));
        let of_directions = shader.call("paint_eval", &[source.clone(), view.clone()]);
        let pdf = shader.call("paint_pdf", &[source.clone(), view]);
        let sampled = shader.call("sampled", &[source, numbers]);
        let [x, y, z, density, weight] = [0, 1, 2, 3, 4].map(|i| sampled.parts()[i].float());
        let [of_angles, of_directions, pdf] = [of_angles, of_directions, pdf].map(|v| v.float());
        let numbers = [of_angles, of_directions, pdf, x, y, z, density, weight];
        Found::from_numbers(numbers.map(f64::from))
    };
    points.iter().map(at).collect()
}

#[test]
fn naga_reads_and_translates_shaders_with_the_values_of_the_model() {
    for brdf in brdfs() {
        let k1 = brdf.parameters().k1;
        let points: Vec<_> = points(k1, 50).into_iter().map(Point::single).collect();
        for (language, module) in [("WGSL", wgsl(&brdf)), ("GLSL", glsl(&brdf))] {
            let errors = Errors::largest(&brdf, &points, &found(&module, &points));
            println!("{language} {:?} k1 = {k1}: {errors:?}", brdf.family());
            check_single(&errors, SINGLE);
        }
    }
}

#[test]
fn f_r_is_0_below_the_surface_and_outside_the_domain() {
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
fn three_materials_fit_into_one_shader() {
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
