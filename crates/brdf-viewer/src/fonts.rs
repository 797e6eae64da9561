//! Fonts of the system for characters that the built-in font does not have, such as those of file names
//! in other scripts.

use std::collections::BTreeSet;
use std::sync::Arc;

use egui::{Context, FontData, FontDefinitions, FontFamily, FontId};
use fontdb::Database;
use skrifa::{FontRef, MetadataProvider as _};

/// Adds fonts of the system when a text needs them.
#[derive(Debug, Default)]
pub struct FallbackFonts {
    /// The characters for which fonts were searched.
    known: BTreeSet<char>,
    /// The fonts that were added: name, content and index in the file.
    added: Vec<(String, Vec<u8>, u32)>,
}

impl FallbackFonts {
    /// Makes texts legible, if the system has fonts for them. A character is searched for once.
    pub fn provide<'a>(&mut self, ctx: &Context, texts: impl Iterator<Item = &'a str>) {
        let font = FontId::proportional(12.0);
        let unknown = texts.flat_map(str::chars).filter(|c| !c.is_ascii());
        let new: BTreeSet<char> = unknown.filter(|c| !self.known.contains(c)).collect();
        if new.is_empty() {
            return;
        }
        self.known.extend(&new);
        let is_missing = |c: &char| ctx.fonts_mut(|fonts| !fonts.has_glyph(&font, *c));
        let missing: BTreeSet<char> = new.into_iter().filter(is_missing).collect();
        if missing.is_empty() {
            return;
        }
        let mut system = Database::new();
        system.load_system_fonts();
        let found = fonts_for(missing, &system);
        if !found.is_empty() {
            self.added.extend(found);
            ctx.set_fonts(self.definitions());
        }
    }

    /// The built-in fonts, followed by those of the system.
    fn definitions(&self) -> FontDefinitions {
        let mut fonts = FontDefinitions::default();
        for (name, content, index) in &self.added {
            let mut data = FontData::from_owned(content.clone());
            data.index = *index;
            fonts.font_data.insert(name.clone(), Arc::new(data));
            for family in [FontFamily::Proportional, FontFamily::Monospace] {
                fonts.families.entry(family).or_default().push(name.clone());
            }
        }
        fonts
    }
}

/// Fonts that together have as many of the characters as any: each is the first that has one which the
/// fonts before it lack.
fn fonts_for(mut missing: BTreeSet<char>, system: &Database) -> Vec<(String, Vec<u8>, u32)> {
    let mut found = Vec::new();
    for face in system.faces() {
        if missing.is_empty() {
            break;
        }
        let font = system.with_face_data(face.id, |content, index| {
            let font = FontRef::from_index(content, index).ok()?;
            let characters = font.charmap();
            let count = missing.len();
            missing.retain(|c| characters.map(*c).is_none());
            (missing.len() < count).then(|| (content.to_vec(), index))
        });
        if let Some((content, index)) = font.flatten() {
            found.push((face.post_script_name.clone(), content, index));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_font_is_taken_for_the_characters_that_it_has() {
        let mut system = Database::new();
        system.load_font_data(epaint_default_fonts::UBUNTU_LIGHT.to_vec());
        let characters = |text: &str| text.chars().collect();
        assert_eq!(fonts_for(characters("αй漆"), &system).len(), 1);
        assert_eq!(fonts_for(characters("漆面"), &system).len(), 0);
        assert_eq!(fonts_for(characters(""), &system).len(), 0);
    }
}
