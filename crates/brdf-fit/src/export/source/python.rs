//! Python: functions of arrays of NumPy or of Dr.Jit.

use super::dialect::Dialect;
use super::file::{Parts, Source};
use super::formula::Function;

/// The library whose functions are called.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Module {
    /// NumPy, `import numpy as np`.
    NumPy,
    /// Dr.Jit, `import drjit as dr`.
    DrJit,
}

/// A module of functions of NumPy arrays.
pub(super) fn numpy_module(source: &Source) -> String {
    Python::text(source, Module::NumPy, &NUMPY)
}

/// Functions of numbers and Dr.Jit arrays, below a comment that describes the BRDF. Their names
/// have the prefix of the source, so that a file may contain several. Directions are sequences of
/// three components with z along the surface normal, angles are in radians:
///
/// ```text
/// NAME_of_angles(psi, theta, phi)     f_r in 1/sr
/// NAME_of_directions(source, view)    f_r in 1/sr, 0 below the surface
/// NAME_density(source, view)          density of the sampled views in 1/sr
/// NAME_mirrored_density(source, view) density of the views sampled from the specular lobe in 1/sr
/// NAME_draw(source, numbers)          a view from three random numbers in [0, 1)
/// NAME_weight(source, view)           f_r cos theta / density
/// ```
pub(in crate::export) fn dr_jit_functions(source: &Source) -> String {
    Python::text(source, Module::DrJit, &DR_JIT)
}

const NUMPY: Parts = Parts {
    conventions: "
NAME_eval(psi, theta, phi)           f_r in 1/sr, angles in radians; NaN outside the domain
NAME_eval_directions(source, view)   f_r in 1/sr, unit vectors; 0 below the surface
NAME_pdf(source, view)               density of the views that are sampled, in 1/sr
NAME_sample(source, numbers)         view, pdf, f_r cos theta / pdf, from three numbers of [0, 1)

All take numbers or arrays, which are broadcast; vectors are along the last axis.",
    opening: "\nimport numpy as np\n\n",
    constants: "\
NAME_OUTSIDE = np.nan
NAME_BELOW_ONE = 0.9999999999999999
NAME_SPECULAR_WEIGHTS = [
    VALUES
]
",
    specular_weight: "\
def NAME_specular_weight(cos_psi):
    return np.interp(16.0 * np.sqrt(cos_psi), np.arange(17.0), NAME_SPECULAR_WEIGHTS)
",
    closing: r#"

def NAME_components(vectors):
    return np.moveaxis(np.asarray(vectors, dtype=float), -1, 0)


def NAME_eval(psi, theta, phi):
    """f_r in 1/sr; angles in radians, phi = 0 back towards the source, theta may be signed."""
    angles = [np.asarray(angle, dtype=float) for angle in (psi, theta, phi)]
    with np.errstate(all="ignore"):
        return NAME_of_angles(*angles)


def NAME_eval_directions(source, view):
    """f_r in 1/sr; unit vectors away from the surface, z along its normal."""
    with np.errstate(all="ignore"):
        return NAME_of_directions(NAME_components(source), NAME_components(view))


def NAME_pdf(source, view):
    """The density in 1/sr, per solid angle, of the views that NAME_sample draws."""
    with np.errstate(all="ignore"):
        return NAME_density(NAME_components(source), NAME_components(view))


def NAME_sample(source, numbers):
    """View, pdf and weight f_r cos theta / pdf, from three numbers of [0, 1). Pdf and weight are 0
    where the view is below the surface."""
    source = NAME_components(source)
    with np.errstate(all="ignore"):
        view = NAME_draw(source, NAME_components(numbers))
        pdf, weight = NAME_density(source, view), NAME_weight(source, view)
    return np.stack(np.broadcast_arrays(*view), axis=-1), pdf, weight
"#,
};

/// The head and the end of the file are written by the caller. `specular_weight` is a sum of hat
/// functions: without an index it applies to numbers and to arrays.
const DR_JIT: Parts = Parts {
    conventions: "",
    opening: "\n",
    constants: "\
NAME_OUTSIDE = dr.nan
NAME_BELOW_ONE = 0.99999994
NAME_SPECULAR_WEIGHTS = [
    VALUES
]
",
    specular_weight: "\
def NAME_specular_weight(cos_psi):
    position = 16.0 * dr.sqrt(cos_psi)
    weight = 0.0
    for entry, value in enumerate(NAME_SPECULAR_WEIGHTS):
        weight += value * dr.maximum(0.0, 1.0 - dr.abs(position - entry))
    return weight
",
    closing: "",
};

/// The language with one of the libraries.
struct Python<'a> {
    name: &'a str,
    module: Module,
}

impl Python<'_> {
    fn text(source: &Source, module: Module, parts: &Parts) -> String {
        let name = source.name;
        source.text(&Python { name, module }, parts)
    }

    fn module(&self) -> &'static str {
        match self.module {
            Module::NumPy => "np",
            Module::DrJit => "dr",
        }
    }
}

impl Dialect for Python<'_> {
    const COMMENT: &'static str = "#";
    const END: &'static str = "";
    const BEFORE_FUNCTION: &'static str = "\n\n";

    fn prefix(&self) -> &str {
        self.name
    }

    /// The functions for the user of NumPy are written in the closing part.
    fn named(&self, name: &str) -> String {
        format!("{}_{name}", self.name)
    }

    fn library_call(&self, function: &str, arguments: &[String]) -> Option<String> {
        let module = self.module();
        let function = match (function, self.module) {
            ("both", _) => return Some(format!("({})", arguments.join(") & ("))),
            ("select", Module::NumPy) => "where",
            ("max", _) => "maximum",
            ("min", _) => "minimum",
            ("sqrt" | "exp" | "log" | "sin" | "cos" | "abs" | "select", _) => function,
            _ => return None,
        };
        Some(format!("{module}.{function}({})", arguments.join(", ")))
    }

    fn constant(&self, name: &str, value: f64) -> String {
        let name = self.named(name);
        match self.module {
            // A NumPy number may be divided by 0, a Python number may not.
            Module::NumPy => format!("{name} = np.float64({value:?})\n"),
            Module::DrJit => format!("{name} = {value:?}\n"),
        }
    }

    fn head(&self, function: &Function) -> String {
        let parameters: Vec<_> = function.parameters.iter().map(|p| p.name).collect();
        format!(
            "def {}({}):",
            self.named(function.name),
            parameters.join(", ")
        )
    }

    fn tail(&self) -> &'static str {
        ""
    }

    fn local(&self) -> String {
        String::new()
    }

    fn condition(&self) -> &'static str {
        ""
    }

    fn return_vector(&self, components: &[String]) -> Vec<String> {
        vec![format!("return ({})", components.join(", "))]
    }
}

#[cfg(test)]
mod tests {
    use brdf_core::{Family, ModelParameters, Parameters};

    use super::*;
    use crate::export::test_fits::fitted;

    #[test]
    fn functions_of_the_chosen_library_are_called() {
        for family in Family::ALL {
            let three = Parameters::new(0.3, 0.1, 0.2).unwrap();
            let at = ModelParameters::three(three, 1.5);
            let fitted = fitted(family, at);
            let source = Source::new("red", &fitted).unwrap();
            let (numpy, dr_jit) = (numpy_module(&source), dr_jit_functions(&source));
            assert!(numpy.contains("np.where(") && !numpy.contains("dr."));
            assert!(dr_jit.contains("dr.select(") && !dr_jit.contains("np."));
        }
    }
}
