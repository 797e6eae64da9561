//! WGSL: functions for any shader.

use super::dialect::{Dialect, named_component, same_call, with_operators};
use super::file::{Parts, Source};
use super::formula::Function;

/// Constants and functions, to be inserted into a shader.
pub(super) fn snippet(source: &Source) -> String {
    let dialect = Wgsl { name: source.name };
    source.text(&dialect, &PARTS)
}

const PARTS: Parts = Parts {
    conventions: "
NAME_eval(source, view)             f_r in 1/sr, unit vectors; 0 below the surface
NAME_eval_angles(psi, theta, phi)   f_r in 1/sr, angles in radians; 0 outside the domain
NAME_pdf(source, view)              density of the views that are sampled, in 1/sr
NAME_sample(source, numbers)        view, its density and f_r cos theta / density, which is 0 below
                                    the surface, from three numbers of [0, 1)

Near grazing, directions are more accurate than angles, because a graphics processor may compute the
cosine of an angle with fewer digits.",
    opening: "\n",
    constants: "\
const NAME_OUTSIDE: f32 = 0.0;
const NAME_BELOW_ONE: f32 = 0.99999994;
const NAME_SPECULAR_WEIGHTS = array<f32, 17>(
    VALUES
);
",
    specular_weight: "\
fn NAME_specular_weight(cos_psi: f32) -> f32 {
    let position = 16.0 * sqrt(max(cos_psi, 0.0));
    let below = i32(min(position, 15.0));
    let left = NAME_SPECULAR_WEIGHTS[below];
    return left + (position - f32(below)) * (NAME_SPECULAR_WEIGHTS[below + 1] - left);
}
",
    closing: "
struct NAME_Sample {
    view: vec3<f32>,
    density: f32,
    weight: f32,
}

fn NAME_sample(source: vec3<f32>, numbers: vec3<f32>) -> NAME_Sample {
    let view = NAME_draw(source, numbers);
    return NAME_Sample(view, NAME_pdf(source, view), NAME_weight(source, view));
}
",
};

/// The language, with the prefix of all names.
struct Wgsl<'a> {
    name: &'a str,
}

impl Dialect for Wgsl<'_> {
    fn prefix(&self) -> &str {
        self.name
    }

    fn component(&self, vector: &str, axis: usize) -> String {
        named_component(vector, axis)
    }

    fn library_call(&self, function: &str, arguments: &[String]) -> Option<String> {
        match (function, arguments) {
            ("select", [condition, then, otherwise]) => {
                Some(format!("select({otherwise}, {then}, {condition})"))
            }
            _ => same_call(function, arguments).or_else(|| with_operators(function, arguments)),
        }
    }

    fn constant(&self, name: &str, value: f64) -> String {
        format!("const {}: f32 = {value:?};\n", self.named(name))
    }

    fn head(&self, function: &Function) -> String {
        let kind = |is_vector| if is_vector { "vec3<f32>" } else { "f32" };
        let parameters = function.parameters.iter();
        let parameters = parameters.map(|p| format!("{}: {}", p.name, kind(p.is_vector)));
        let parameters = parameters.collect::<Vec<_>>().join(", ");
        let result = kind(function.returns_vector);
        format!(
            "fn {}({parameters}) -> {result} {{",
            self.named(function.name)
        )
    }

    fn local(&self) -> String {
        "let ".to_owned()
    }

    fn condition(&self) -> &'static str {
        "let "
    }

    fn return_vector(&self, components: &[String]) -> Vec<String> {
        vec![format!("return vec3<f32>({});", components.join(", "))]
    }
}
