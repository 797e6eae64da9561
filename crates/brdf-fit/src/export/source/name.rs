//! The prefix of all names in source code, and the names that functions have for their users.

/// A word cannot be the prefix of the names in source code.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "\"{0}\" is not a name in source code: expected letters a-z, digits and single underscores \
     between them, beginning with a letter and not gl or gl_..."
)]
pub struct NameError(String);

/// Checks that a word is an identifier in all languages, and remains one when an underscore and
/// another word are appended. GLSL reserves names that begin with gl_ or contain two underscores.
///
/// # Errors
///
/// It is not.
pub(in crate::export) fn check_name(name: &str) -> Result<(), NameError> {
    let letter = |c: char| c.is_ascii_alphabetic();
    let word = |part: &str| !part.is_empty() && part.chars().all(|c| c.is_ascii_alphanumeric());
    let first = name.split('_').next();
    if name.starts_with(letter) && name.split('_').all(word) && first != Some("gl") {
        Ok(())
    } else {
        Err(NameError(name.to_owned()))
    }
}

/// The name in C of a function of the formulas.
pub(super) fn name_in_c(name: &str) -> &str {
    match name {
        "of_angles" => "eval",
        "of_directions" => "eval_directions",
        "density" => "pdf",
        _ => name,
    }
}

/// The name in shading languages, where directions are the usual arguments.
pub(super) fn name_in_shaders(name: &str) -> &str {
    match name {
        "of_directions" => "eval",
        "of_angles" => "eval_angles",
        "density" => "pdf",
        _ => name,
    }
}
