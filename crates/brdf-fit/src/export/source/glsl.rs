//! GLSL, as a piece of any shader.

use super::dialect::{Dialect, same_call, typed_head, with_operators};
use super::formula::Function;
use super::{AXES, Parts, Source, of_shaders};

/// Constants and functions, to be pasted into a shader.
pub(super) fn snippet(source: &Source) -> String {
    let dialect = Glsl { name: source.name };
    source.file(&dialect, &PARTS)
}

const PARTS: Parts = Parts {
    conventions: CONVENTIONS,
    opening: "\n",
    constants: OWN_CONSTANTS,
    specular_weight: SPECULAR_WEIGHT,
    closing: CLOSING,
};

const CONVENTIONS: &str = "
NAME_eval(source, view)                       f_r in 1/sr, unit vectors; 0 below the surface
NAME_eval_angles(psi, theta, phi)             f_r in 1/sr, angles in radians; 0 outside the domain
NAME_pdf(source, view)                        density of the views that are sampled, in 1/sr
NAME_sample(source, numbers, view, density)   view and its density from three numbers of [0, 1);
                                              returns f_r cos theta / density, 0 below the surface

GLSL, of version 1.30, 3.00 es or later. Next to grazing angles directions are more accurate than
angles, whose cosine a graphics processor may not have to all digits.";

const OWN_CONSTANTS: &str = "\
const float NAME_OUTSIDE = 0.0;
const float NAME_BELOW_ONE = 0.99999994;
const float NAME_SPECULAR_WEIGHTS[17] = float[17](
    VALUES
);
";

const SPECULAR_WEIGHT: &str = "\
float NAME_specular_weight(float cos_psi) {
    float position = 16.0 * sqrt(max(cos_psi, 0.0));
    int below = int(min(position, 15.0));
    float left = NAME_SPECULAR_WEIGHTS[below];
    return left + (position - float(below)) * (NAME_SPECULAR_WEIGHTS[below + 1] - left);
}
";

const CLOSING: &str = "
float NAME_sample(vec3 source, vec3 numbers, out vec3 view, out float density) {
    view = NAME_draw(source, numbers);
    density = NAME_pdf(source, view);
    return NAME_weight(source, view);
}
";

/// The language.
struct Glsl<'a> {
    name: &'a str,
}

impl Dialect for Glsl<'_> {
    const COMMENT: &'static str = "//";

    fn named(&self, name: &str) -> String {
        format!("{}_{}", self.name, of_shaders(name))
    }

    fn component(&self, vector: &str, axis: usize) -> String {
        format!("{vector}.{}", AXES[axis])
    }

    fn library_call(&self, function: &str, arguments: &[String]) -> Option<String> {
        same_call(function, arguments).or_else(|| with_operators(function, arguments))
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
