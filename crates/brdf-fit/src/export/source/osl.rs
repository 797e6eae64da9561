//! The Open Shading Language: functions for any shader, and a shader.

use super::dialect::{Dialect, typed_head};
use super::file::{Parts, Source};
use super::formula::Function;

/// Functions for any shader, and a shader that evaluates f_r.
pub(super) fn shader(source: &Source) -> String {
    let dialect = Osl { name: source.name };
    source.text(&dialect, &PARTS)
}

const PARTS: Parts = Parts {
    conventions: "
NAME_eval(source, view)                       f_r in 1/sr, unit vectors; 0 below the surface
NAME_eval_angles(psi, theta, phi)             f_r in 1/sr, angles in radians; 0 outside the domain
NAME_pdf(source, view)                        density of the views that are sampled, in 1/sr
NAME_sample(source, numbers, view, density)   view and its density from three numbers of [0, 1);
                                              returns f_r cos theta / density, 0 below the surface

Shaders of this language compose materials of closures of the renderer; they cannot define closures.
These functions are for shaders that compute illumination themselves, for patterns and for baking
tables; the shader NAME_value returns f_r for two directions and a normal. A file may contain one
shader only: to include this file in another shader, define NAME_NO_SHADER.",
    opening: "\n",
    constants: "\
#define NAME_OUTSIDE 0.0
#define NAME_BELOW_ONE 0.99999994
",
    specular_weight: "\
float NAME_specular_weight(float cos_psi) {
    float weights[17] = {
        VALUES
    };
    float position = 16.0 * sqrt(max(cos_psi, 0.0));
    int below = int(min(position, 15.0));
    float left = weights[below];
    return left + (position - below) * (weights[below + 1] - left);
}
",
    closing: "
float NAME_sample(vector source, vector numbers, output vector view, output float density) {
    view = NAME_draw(source, numbers);
    density = NAME_pdf(source, view);
    return NAME_weight(source, view);
}

#ifndef NAME_NO_SHADER
// A unit vector in the frame of a normal: z along the normal, x in any direction across it.
vector NAME_about(vector direction, normal n) {
    vector across = abs(n[2]) < 0.5 ? vector(0.0, 0.0, 1.0) : vector(1.0, 0.0, 0.0);
    vector x = normalize(cross(across, n));
    return normalize(vector(dot(direction, x), dot(direction, cross(n, x)), dot(direction, n)));
}

// f_r in 1/sr for the directions to the source and to the viewer.
shader NAME_value(
    vector Source = vector(0.0, 0.0, 1.0),
    vector View = vector(0.0, 0.0, 1.0),
    normal Normal = N,
    output float Value = 0.0) {
    normal n = normalize(Normal);
    Value = NAME_eval(NAME_about(Source, n), NAME_about(View, n));
}
#endif
",
};

/// The language, with the prefix of all names.
struct Osl<'a> {
    name: &'a str,
}

impl Dialect for Osl<'_> {
    fn prefix(&self) -> &str {
        self.name
    }

    /// The language has no constants outside of functions.
    fn constant(&self, name: &str, value: f64) -> String {
        format!("#define {} {value:?}\n", self.named(name))
    }

    fn head(&self, function: &Function) -> String {
        typed_head(&self.named(function.name), function, "float", "vector")
    }

    fn local(&self) -> String {
        "float ".to_owned()
    }

    fn condition(&self) -> &'static str {
        "int "
    }

    fn return_vector(&self, components: &[String]) -> Vec<String> {
        vec![format!("return vector({});", components.join(", "))]
    }
}
