//! A writer of SVG documents: the few elements that the figures consist of, in whole coordinates.

use std::fmt::{self, Write as _};

use super::palette::{Ground, Rgb};
use super::style::{DARK_PAGE, LIGHT_INK, WHITE};

/// A position in whole coordinates, from the upper left corner.
pub(super) type Coordinates = (i32, i32);

/// A colour with its opacity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Paint {
    colour: Rgb,
    opacity: f64,
}

impl Paint {
    /// A colour through which the ground shows; an opacity of 1 covers it.
    pub(super) fn translucent(colour: Rgb, opacity: f64) -> Self {
        Self { colour, opacity }
    }

    /// The paint on a ground: greys are inverted on a dark one, from [`DARK_PAGE`] for white to nearly
    /// white for black.
    fn on(self, ground: Ground) -> Self {
        let [red, green, blue] = self.colour;
        if ground == Ground::Light || red != green || green != blue {
            return self;
        }
        let range = u16::from(LIGHT_INK - DARK_PAGE);
        let above = u16::from(u8::MAX - red) * range / u16::from(u8::MAX);
        let grey = DARK_PAGE + u8::try_from(above).unwrap_or(LIGHT_INK - DARK_PAGE);
        Self {
            colour: [grey; 3],
            ..self
        }
    }
}

impl From<Rgb> for Paint {
    fn from(colour: Rgb) -> Self {
        Self::translucent(colour, 1.0)
    }
}

/// `opacity="1"`
struct Opacity(Paint);

impl fmt::Display for Opacity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, r#"opacity="{}""#, self.0.opacity)
    }
}

/// `#1E1E1E`
struct Hexadecimal(Paint);

impl fmt::Display for Hexadecimal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [red, green, blue] = self.0.colour;
        write!(f, "#{red:02X}{green:02X}{blue:02X}")
    }
}

/// The part of a line of text that lies at its position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
    /// The middle of a text that runs upwards.
    MiddleUpwards,
}

/// A line of text.
pub(super) struct Text<'a> {
    pub(super) content: &'a str,
    /// Half the height of a lower-case letter above the base line, at the anchor.
    pub(super) position: Coordinates,
    pub(super) anchor: Anchor,
    /// The size of the typeface, in coordinates.
    pub(super) size: f64,
    pub(super) paint: Paint,
}

/// A document that is being written.
pub(super) struct Document {
    text: String,
    ground: Ground,
}

impl Document {
    /// A page of `width` x `height` pixels, each of which is `subdivisions` coordinates long. The greys of
    /// what is drawn are those of a white page; on a dark one they are inverted.
    pub(super) fn new((width, height): (u32, u32), subdivisions: u32, ground: Ground) -> Self {
        let (right, bottom) = (width * subdivisions, height * subdivisions);
        let page = Hexadecimal(Paint::from(WHITE).on(ground));
        Self {
            ground,
            text: format!(
                r#"<svg width="{width}" height="{height}" viewBox="0 0 {right} {bottom}" xmlns="http://www.w3.org/2000/svg">
<rect x="0" y="0" width="{right}" height="{bottom}" opacity="1" fill="{page}" stroke="none"/>
"#
            ),
        }
    }

    /// The text of the complete document.
    pub(super) fn finish(mut self) -> String {
        self.text += "</svg>\n";
        self.text
    }

    /// A line through points.
    pub(super) fn polyline(
        &mut self,
        points: impl Iterator<Item = Coordinates>,
        paint: Paint,
        width: u32,
    ) {
        let (opacity, stroke) = (Opacity(paint), Hexadecimal(paint.on(self.ground)));
        self.push(format_args!(
            r#"<polyline fill="none" {opacity} stroke="{stroke}" stroke-width="{width}" "#
        ));
        self.push_points(points);
    }

    /// A filled polygon.
    pub(super) fn polygon(&mut self, corners: impl Iterator<Item = Coordinates>, paint: Paint) {
        let (opacity, fill) = (Opacity(paint), Hexadecimal(paint.on(self.ground)));
        self.push(format_args!(r#"<polygon {opacity} fill="{fill}" "#));
        self.push_points(corners);
    }

    /// A filled circle.
    pub(super) fn circle(&mut self, (x, y): Coordinates, radius: u32, paint: Paint) {
        let (opacity, fill) = (Opacity(paint), Hexadecimal(paint.on(self.ground)));
        self.push(format_args!(
            r#"<circle cx="{x}" cy="{y}" r="{radius}" {opacity} fill="{fill}" stroke="none" stroke-width="1"/>
"#
        ));
    }

    /// A line of text, in the reader's own sans-serif typeface.
    pub(super) fn text(&mut self, text: &Text) {
        let ((x, y), size) = (text.position, text.size);
        let paint = text.paint.on(self.ground);
        let (opacity, fill) = (Opacity(paint), Hexadecimal(paint));
        let anchor = match text.anchor {
            Anchor::Start => "start",
            Anchor::Middle | Anchor::MiddleUpwards => "middle",
            Anchor::End => "end",
        };
        self.push(format_args!(
            r#"<text x="{x}" y="{y}" dy="0.5ex" text-anchor="{anchor}" font-family="sans-serif" font-size="{size}" {opacity} fill="{fill}""#
        ));
        if text.anchor == Anchor::MiddleUpwards {
            self.push(format_args!(r#" transform="rotate(270, {x}, {y})""#));
        }
        self.text += ">\n";
        self.push_escaped(text.content);
        self.text += "\n</text>\n";
    }

    fn push(&mut self, content: fmt::Arguments) {
        // Writing to a string cannot fail.
        let _ = self.text.write_fmt(content);
    }

    /// The last attribute of an element, its points.
    fn push_points(&mut self, points: impl Iterator<Item = Coordinates>) {
        self.text += "points=\"";
        for (x, y) in points {
            self.push(format_args!("{x},{y} "));
        }
        self.text += "\"/>\n";
    }

    /// Text as XML, which has no way to represent control characters.
    fn push_escaped(&mut self, text: &str) {
        for character in text.chars() {
            match character {
                '<' => self.text += "&lt;",
                '>' => self.text += "&gt;",
                '&' => self.text += "&amp;",
                '"' => self.text += "&quot;",
                '\'' => self.text += "&apos;",
                '\u{fffe}' | '\u{ffff}' => self.text.push(' '),
                control if control.is_control() => self.text.push(' '),
                other => self.text.push(other),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_element_has_its_form() {
        let black = Paint::from([0; 3]);
        let mut document = Document::new((3, 2), 10, Ground::Light);
        document.polyline([(1, 2), (-3, 4)].into_iter(), black, 7);
        let faint = Paint::translucent([30, 0, 255], 0.25);
        document.polygon([(0, 0), (1, 0), (0, 1)].into_iter(), faint);
        document.circle((5, 6), 4, black);
        document.text(&Text {
            content: "a < b\u{7}",
            position: (8, 9),
            anchor: Anchor::MiddleUpwards,
            size: 12.5,
            paint: black,
        });
        assert_eq!(
            document.finish(),
            r##"<svg width="3" height="2" viewBox="0 0 30 20" xmlns="http://www.w3.org/2000/svg">
<rect x="0" y="0" width="30" height="20" opacity="1" fill="#FFFFFF" stroke="none"/>
<polyline fill="none" opacity="1" stroke="#000000" stroke-width="7" points="1,2 -3,4 "/>
<polygon opacity="0.25" fill="#1E00FF" points="0,0 1,0 0,1 "/>
<circle cx="5" cy="6" r="4" opacity="1" fill="#000000" stroke="none" stroke-width="1"/>
<text x="8" y="9" dy="0.5ex" text-anchor="middle" font-family="sans-serif" font-size="12.5" opacity="1" fill="#000000" transform="rotate(270, 8, 9)">
a &lt; b 
</text>
</svg>
"##
        );
    }
}
