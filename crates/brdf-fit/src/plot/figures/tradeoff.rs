//! What a choice costs against what it errs: points on two logarithmic axes, with the Pareto front.

use crate::plot::axis::Axis;
use crate::plot::canvas::{Canvas, Point as Place};
use crate::plot::error::PlotError;
use crate::plot::figure::Figure;
use crate::plot::frame::{Frame, WHOLE};
use crate::plot::labels::{Label, placed};
use crate::plot::legend::{Key, Legend};
use crate::plot::palette::MarkShape;
use crate::plot::style::{EMPHASIS, INK, MAIN};
use crate::plot::svg::Rgb;
use crate::plot::text::shortened;
use crate::plot::title::{LONGEST_SAMPLE, Title};
use crate::words::counted;

/// All decades of the costs and errors of a trade.
const DECADES: i32 = 40;

/// What is dominated.
const DOMINATED: Rgb = [140, 140, 140];

/// One choice of a trade.
#[derive(Debug, Clone, PartialEq)]
pub struct TradePoint {
    /// Its name.
    pub label: String,
    /// What it costs, in the unit of the axis; positive.
    pub x: f64,
    /// How far it errs; zero is shown at the lower edge.
    pub y: f64,
    /// Whether it is on the Pareto front: see [`pareto`](crate::trade::pareto::pareto).
    pub pareto: bool,
    /// Whether it is the one that is taken.
    pub chosen: bool,
}

impl TradePoint {
    fn colour(&self) -> Rgb {
        match (self.chosen, self.pareto) {
            (true, _) => EMPHASIS,
            (false, true) => MAIN,
            (false, false) => DOMINATED,
        }
    }

    fn name_colour(&self) -> Rgb {
        match self.colour() {
            DOMINATED => INK,
            colour => colour,
        }
    }

    /// Whether logarithmic axes have a place for it; zero error has one.
    fn can_be_shown(&self) -> bool {
        self.x > 0.0 && self.x.is_finite() && self.y >= 0.0 && self.y.is_finite()
    }
}

/// The picture of a trade: what each choice costs (`x_title`) against how far it errs (`y_title`),
/// both logarithmic, the Pareto front as a step line and the chosen point with a ring.
///
/// Errors of zero stand at the lower edge, which the legend says. Costs that are not positive,
/// negative errors, and what is not finite, have no place: legend and caption count them.
pub fn trade_picture(
    points: &[TradePoint],
    x_title: &str,
    y_title: &str,
    title: &str,
) -> Result<Figure, PlotError> {
    let shown: Vec<&TradePoint> = points.iter().filter(|p| p.can_be_shown()).collect();
    let mut picture = Picture {
        frame: frame(&shown),
        left_out: points.len() - shown.len(),
        labels: Vec::new(),
        title: Title {
            sample: shortened(title, LONGEST_SAMPLE),
            details: format!("{y_title} against {x_title}"),
            theory: String::new(),
            samples: Vec::new(),
        },
        axes: [x_title, y_title],
        shown,
    };
    picture.labels = picture.placed_labels();
    Ok(Figure {
        name: "trade".to_owned(),
        caption: picture.caption(),
        svg: picture.title.render(|canvas| picture.draw(canvas)),
    })
}

/// The axes: every positive value, and room below the smallest error for those that are zero.
fn frame(shown: &[&TradePoint]) -> Frame {
    let costs = shown.iter().map(|point| point.x);
    let errors = shown.iter().map(|point| point.y);
    let positive = errors.filter(|&y| y > 0.0);
    let lowest = positive.clone().fold(f64::INFINITY, f64::min);
    let room = (0.2 * lowest).is_finite().then_some(0.2 * lowest);
    // Where there is nothing, the axes are there all the same.
    let or_one = |axis: Option<Axis>| axis.unwrap_or_else(|| Axis::fixed(0, 1, 1));
    Frame {
        x: or_one(Axis::logarithmic(costs, DECADES)),
        y: or_one(Axis::logarithmic(positive.chain(room), DECADES)),
        area: WHOLE,
    }
}

/// Where a point is; below the axis is at its lower edge.
fn place(frame: &Frame, point: &TradePoint) -> Place {
    frame.point((point.x, point.y.max(frame.y.low())))
}

struct Picture<'a> {
    shown: Vec<&'a TradePoint>,
    left_out: usize,
    frame: Frame,
    labels: Vec<Option<Label>>,
    title: Title,
    axes: [&'a str; 2],
}

impl Picture<'_> {
    fn placed_labels(&self) -> Vec<Option<Label>> {
        let named = self.shown.iter();
        let named = named.map(|point| (place(&self.frame, point), point.label.as_str()));
        let marks: Vec<(Place, &str)> = named.collect();
        let front: Vec<Place> = self
            .front()
            .into_iter()
            .map(|at| self.frame.point(at))
            .collect();
        let lines: Vec<(Place, Place)> = front.windows(2).map(|two| (two[0], two[1])).collect();
        placed(&marks, &lines, &self.frame.area)
    }

    fn zeros(&self) -> usize {
        self.shown.iter().filter(|point| point.y == 0.0).count()
    }

    fn unnamed(&self) -> usize {
        self.labels.iter().filter(|label| label.is_none()).count()
    }

    fn caption(&self) -> String {
        let notes = self.notes().into_iter();
        let notes = notes.map(|note| format!(" {note}."));
        format!(
            "{}. The line is the Pareto front: no other choice costs \
             and errs less.{}",
            self.title.details,
            notes.collect::<String>()
        )
    }

    /// What the marks do not show.
    fn notes(&self) -> Vec<String> {
        let of = |count: usize, words: &str| {
            (count > 0).then(|| format!("{} {words}", counted(count, "point")))
        };
        [
            of(self.zeros(), "of zero at the lower edge"),
            of(self.left_out, "not shown: no place on these axes"),
            of(self.unnamed(), "without a name: no room"),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    fn draw(&self, canvas: &mut Canvas) {
        let [x_name, y_name] = self.axes;
        self.frame.draw(canvas, x_name, y_name);
        self.frame.line(canvas, self.front().into_iter(), MAIN, 1.5);
        for (point, label) in self.shown.iter().zip(&self.labels) {
            if let Some(label) = label {
                label.draw(canvas, &point.label, point.name_colour(), DOMINATED);
            }
        }
        let (rest, best): (Vec<_>, Vec<_>) =
            self.shown.iter().partition(|p| p.colour() == DOMINATED);
        for point in rest.into_iter().chain(best) {
            self.mark(canvas, point);
        }
        self.legend().draw(canvas);
    }

    fn mark(&self, canvas: &mut Canvas, point: &TradePoint) {
        let at = place(&self.frame, point);
        canvas.mark(at, MarkShape::Circle, point.colour());
        if point.chosen {
            canvas.line(&ring(at), EMPHASIS, 1.2);
        }
    }

    fn legend(&self) -> Legend {
        let mut legend = Legend::default();
        if self.shown.iter().any(|point| point.chosen) {
            legend.add(Key::Mark(EMPHASIS), "chosen");
        }
        legend.add(Key::Curve(MAIN, Some(MarkShape::Circle)), "Pareto front");
        legend.add(Key::Mark(DOMINATED), "dominated");
        for note in self.notes() {
            legend.add(Key::Note, &note);
        }
        legend
    }

    /// The front as a step line, from the upper edge to the right one: with what a point costs its
    /// error can be had, until the next one can be paid.
    fn front(&self) -> Vec<(f64, f64)> {
        let (x, y) = (&self.frame.x, &self.frame.y);
        let mut points: Vec<(f64, f64)> = self
            .shown
            .iter()
            .filter(|p| p.pareto)
            .map(|p| (p.x, p.y.max(y.low())))
            .collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut line = Vec::new();
        let mut error = y.high();
        for &(cost, lower) in &points {
            line.extend([(cost, error), (cost, lower)]);
            error = lower;
        }
        line.extend(line.last().map(|&(_, error)| (x.high(), error)));
        line
    }
}

/// A ring around a mark.
fn ring((x, y): Place) -> Vec<Place> {
    const RADIUS: f64 = 6.5;
    let at = |i: u32| {
        let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 24.0).sin_cos();
        (x + RADIUS * cos, y + RADIUS * sin)
    };
    (0..=24).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use resvg::usvg::{Options, Tree};

    fn point(label: &str, x: f64, y: f64, pareto: bool) -> TradePoint {
        TradePoint {
            label: label.to_owned(),
            x,
            y,
            pareto,
            chosen: label == "chosen",
        }
    }

    fn picture(points: &[TradePoint]) -> Figure {
        let figure = trade_picture(points, "time / ns", "error", "a title").unwrap();
        Tree::from_str(&figure.svg, &Options::default()).unwrap();
        assert!(!figure.svg.contains("NaN") && !figure.svg.contains("inf"));
        figure
    }

    #[test]
    fn every_point_is_named_and_zero_is_said_to_be_at_the_edge() {
        let figure = picture(&[
            point("fast", 1.0, 1e-3, true),
            point("chosen", 10.0, 0.0, true),
            point("slow", 100.0, 1e-2, false),
        ]);
        for name in ["fast", "chosen", "slow", "Pareto front", "a title"] {
            assert!(figure.svg.contains(name), "{name}");
        }
        assert!(
            figure
                .caption
                .contains("1 point of zero at the lower edge.")
        );
        assert!(!figure.caption.contains("not shown"));
    }

    #[test]
    fn what_has_no_place_is_counted() {
        let figure = picture(&[
            point("free", 0.0, 1.0, false),
            point("endless", f64::INFINITY, 1.0, false),
            point("unknown", 1.0, f64::NAN, false),
            point("here", 1.0, 1.0, true),
        ]);
        let words = "3 points not shown: no place on these axes.";
        assert!(figure.caption.contains(words), "{}", figure.caption);
        assert!(!figure.svg.contains("endless"));
    }

    #[test]
    fn nothing_and_zeros_alone_have_a_picture() {
        picture(&[]);
        picture(&[point("exact", 1.0, 0.0, true)]);
        picture(&[point("least", f64::MIN_POSITIVE, f64::MIN_POSITIVE, true)]);
        picture(&[point("most", f64::MAX, f64::MAX, true)]);
    }

    #[test]
    fn the_front_goes_down_in_steps() {
        let points = [
            point("b", 10.0, 0.1, true),
            point("a", 1.0, 1.0, true),
            point("c", 5.0, 0.5, false),
        ];
        let shown: Vec<&TradePoint> = points.iter().collect();
        let picture = Picture {
            frame: frame(&shown),
            shown,
            left_out: 0,
            labels: Vec::new(),
            title: Title {
                sample: String::new(),
                details: String::new(),
                theory: String::new(),
                samples: Vec::new(),
            },
            axes: ["", ""],
        };
        let (x, y) = (&picture.frame.x, &picture.frame.y);
        let expected = [
            (1.0, y.high()),
            (1.0, 1.0),
            (10.0, 1.0),
            (10.0, 0.1),
            (x.high(), 0.1),
        ];
        assert_eq!(picture.front(), expected);
    }
}
