//! GLSL: functions for any shader.

use super::dialect::{Dialect, named_component, typed_head};
use super::file::{Parts, Source};
use super::formula::Function;

/// Constants and functions, to be inserted into a shader.
pub(super) fn snippet(source: &Source) -> String {
    let dialect = Glsl { name: source.name };
    source.text(&dialect, &PARTS)
}

const PARTS: Parts = Parts {
    conventions: "
NAME_eval(source, view)                       f_r in 1/sr, unit vectors; 0 below the surface
NAME_eval_angles(psi, theta, phi)             f_r in 1/sr, angles in radians; 0 outside the domain
NAME_pdf(source, view)                        density of the views that are sampled, in 1/sr
NAME_sample(source, numbers, view, density)   view and its density from three numbers of [0, 1);
                                              returns f_r cos theta / density, 0 below the surface

GLSL, version 1.30, 3.00 es or later. Near grazing, directions are more accurate than angles,
because a graphics processor may compute the cosine of an angle with fewer digits.",
    opening: "\n",
    constants: "\
const float NAME_OUTSIDE = 0.0;
const float NAME_BELOW_ONE = 0.99999994;
const float NAME_SPECULAR_WEIGHTS[17] = float[17](
    VALUES
);
",
    specular_weight: "\
float NAME_specular_weight(float cos_psi) {
    float position = 16.0 * sqrt(max(cos_psi, 0.0));
    int below = int(min(position, 15.0));
    float left = NAME_SPECULAR_WEIGHTS[below];
    return left + (position - float(below)) * (NAME_SPECULAR_WEIGHTS[below + 1] - left);
}
",
    closing: "
float NAME_sample(vec3 source, vec3 numbers, out vec3 view, out float density) {
    view = NAME_draw(source, numbers);
    density = NAME_pdf(source, view);
    return NAME_weight(source, view);
}
",
};

/// The language, with the prefix of all names.
struct Glsl<'a> {
    name: &'a str,
}

impl Dialect for Glsl<'_> {
    fn prefix(&self) -> &str {
        self.name
    }

    fn component(&self, vector: &str, axis: usize) -> String {
        named_component(vector, axis)
    }

    fn constant(&self, name: &str, value: f64) -> String {
        format!("const float {} = {value:?};\n", self.named(name))
    }

    fn head(&self, function: &Function) -> String {
        typed_head(&self.named(function.name), function, "float", "vec3")
    }

    fn local(&self) -> String {
        "float ".to_owned()
    }

    fn condition(&self) -> &'static str {
        "bool "
    }

    fn return_vector(&self, components: &[String]) -> Vec<String> {
        vec![format!("return vec3({});", components.join(", "))]
    }
}
