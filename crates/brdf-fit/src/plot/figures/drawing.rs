//! A figure of shapes that a caller has placed, such as a solid in projection.

use crate::plot::canvas::render;
use crate::plot::figure::Figure;
use crate::plot::palette::Ground;
use crate::plot::style::{SIZE, TEXT, TITLE};
use crate::plot::svg::Anchor;
use crate::plot::title::LEFT;

/// The width and the height of a figure, in the units of its SVG.
pub const FIGURE_SIZE: (u32, u32) = SIZE;

/// The part of a figure below its two lines of title: the left, upper, right and lower edge.
pub const DRAWING_AREA: [f64; 4] = [20.0, 60.0, 940.0, 570.0];

/// A shape in the units of the figure, x to the right and y downwards from its upper left corner.
///
/// Greys are those on white paper; on a dark ground they are inverted.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A filled polygon: its corners and its colour.
    Area(Vec<[f64; 2]>, [u8; 3]),
    /// A line through points: its width and its colour.
    Line(Vec<[f64; 2]>, f64, [u8; 3]),
    /// A filled circle around a point, by its radius.
    Disc([f64; 2], f64, [u8; 3]),
    /// A text, vertically centred at a point, which is its middle.
    Text(String, [f64; 2], [u8; 3]),
}

/// A figure of shapes, each of which covers those before it, with a name for its file and two lines of
/// title. Its caption is both lines.
pub fn drawing(name: &str, title: [&str; 2], ground: Ground, shapes: &[Shape]) -> Figure {
    let svg = render(0, ground, |canvas| {
        for shape in shapes {
            match shape {
                Shape::Area(corners, colour) => canvas.area(&points(corners), *colour),
                Shape::Line(line, width, colour) => canvas.line(&points(line), *colour, *width),
                Shape::Disc([x, y], radius, colour) => canvas.disc((*x, *y), *radius, *colour),
                Shape::Text(text, [x, y], colour) => {
                    canvas.coloured_text(text, (*x, *y), TEXT, Anchor::Middle, *colour);
                }
            }
        }
        canvas.text(title[0], (LEFT, 22.0), TITLE, Anchor::Start);
        canvas.text(title[1], (LEFT, 45.0), TEXT, Anchor::Start);
    });
    Figure {
        name: name.to_owned(),
        caption: title.join(": "),
        svg,
    }
}

fn points(of: &[[f64; 2]]) -> Vec<(f64, f64)> {
    of.iter().map(|&[x, y]| (x, y)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_are_drawn_in_their_order() {
        let shapes = [
            Shape::Area(vec![[1.0, 2.0], [3.0, 2.0], [3.0, 4.0]], [10, 20, 30]),
            Shape::Line(vec![[1.0, 2.0], [3.0, 4.0]], 1.5, [0; 3]),
            Shape::Disc([5.0, 6.0], 2.0, [200, 0, 0]),
            Shape::Text("a < b".to_owned(), [7.0, 8.0], [0; 3]),
        ];
        let figure = drawing("lobe", ["one", "two"], Ground::Light, &shapes);
        let at = |part: &str| figure.svg.find(part).unwrap();
        assert!(at("<polygon") < at("<polyline") && at("<polyline") < at("<circle"));
        assert!(at("a &lt; b") < at("two"));
        assert_eq!(figure.caption, "one: two");
    }
}
