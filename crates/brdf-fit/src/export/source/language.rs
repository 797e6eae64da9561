//! The languages of source code.

/// A language in which a BRDF can be written as source code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Language {
    /// C99: a header.
    C,
    /// GLSL: functions for any shader.
    Glsl,
    /// WGSL: functions for any shader.
    Wgsl,
    /// The Open Shading Language: functions and a shader.
    Osl,
    /// Python with NumPy: a module.
    Python,
}
