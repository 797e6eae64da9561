//! Names beside marks, none over another, over a mark, or over a line.

use super::canvas::{Canvas, Point as Place};
use super::frame::Area;
use super::svg::{Anchor as Stands, Rgb};

/// Size of the names.
const SIZE: f64 = 11.0;

/// Width of a letter, in sizes: that of a wide sans-serif typeface, since each reader has another.
const LETTER: f64 = 0.56;

/// Half the height of a line of names.
const HALF_HEIGHT: f64 = 6.5;

/// From the middle of a mark to what is beside it.
const BESIDE: f64 = 7.0;

/// Half the side of what a mark covers.
const HALF_MARK: f64 = 4.5;

/// A name farther from its mark than this has a line to it.
const NEAR: f64 = 12.0;

/// From the line to a flag.
const BESIDE_POLE: f64 = 2.5;

/// A name is in the way of the names of marks that are so far above or below it.
const AIR: f64 = 40.0;

/// Distances that are tried, and from one to the next.
const RINGS: u32 = 40;
const STEP: f64 = 7.0;

/// Directions that are tried at each distance.
const DIRECTIONS: u32 = 16;

/// The names of no more marks than this are placed.
const MOST: usize = 100;

/// So often the names are placed.
const ROUNDS: usize = 8;

/// Names nearer to each other than this, to all sides, take each other's room.
const CROWD: f64 = 60.0;

/// A rectangle, y downwards as in the figure.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Rectangle {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

impl Rectangle {
    fn around((x, y): Place, half: f64) -> Self {
        Self {
            left: x - half,
            right: x + half,
            top: y - half,
            bottom: y + half,
        }
    }

    fn grown(&self, sideways: f64, upright: f64) -> Self {
        Self {
            left: self.left - sideways,
            right: self.right + sideways,
            top: self.top - upright,
            bottom: self.bottom + upright,
        }
    }

    fn contains(&self, (x, y): Place) -> bool {
        (self.left..=self.right).contains(&x) && (self.top..=self.bottom).contains(&y)
    }

    fn overlaps(&self, other: &Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    fn within(&self, area: &Area) -> bool {
        self.left >= area.left
            && self.right <= area.right
            && self.top >= area.top
            && self.bottom <= area.bottom
    }

    /// Whether a line passes through (Liang and Barsky's clipping).
    fn meets(&self, (from, to): (Place, Place)) -> bool {
        let (mut enters, mut leaves) = (0.0_f64, 1.0_f64);
        let axes = [
            (from.0, to.0 - from.0, self.left, self.right),
            (from.1, to.1 - from.1, self.top, self.bottom),
        ];
        for (start, way, low, high) in axes {
            if way == 0.0 {
                if start < low || start > high {
                    return false;
                }
                continue;
            }
            let (a, b) = ((low - start) / way, (high - start) / way);
            enters = enters.max(a.min(b));
            leaves = leaves.min(a.max(b));
        }
        enters < leaves
    }
}

/// Whether two lines cross.
fn cross((a, b): (Place, Place), (c, d): (Place, Place)) -> bool {
    let side = |from: Place, to: Place, of: Place| {
        (to.0 - from.0) * (of.1 - from.1) - (to.1 - from.1) * (of.0 - from.0)
    };
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

/// Where a name stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Label {
    place: Place,
    stands: Stands,
    covers: Rectangle,
    distance: f64,
    /// From the mark to the name, where that is far.
    leader: Option<(Place, Place)>,
}

impl Label {
    /// A name in a direction from its mark, the nearest side of it at a distance.
    fn beside(mark: Place, name: &str, distance: f64, direction: f64) -> Self {
        let (sin, cos) = direction.sin_cos();
        let end = (mark.0 + distance * cos, mark.1 - distance * sin);
        let stands = if cos > 0.0 {
            Stands::Start
        } else {
            Stands::End
        };
        Self::at(end, stands, name, distance, (mark, end))
    }

    /// A name straight above its mark (below with a negative height), like a flag at the end of a
    /// pole: so all marks of a row can have one.
    fn flag(mark: Place, name: &str, height: f64, stands: Stands) -> Self {
        let end = (mark.0, mark.1 - height);
        let beside = if stands == Stands::End {
            -BESIDE_POLE
        } else {
            BESIDE_POLE
        };
        let place = (end.0 + beside, end.1);
        Self::at(place, stands, name, height.abs(), (mark, end))
    }

    fn at(place: Place, stands: Stands, name: &str, distance: f64, leader: (Place, Place)) -> Self {
        let width = LETTER * SIZE * name.chars().count() as f64;
        let left = if stands == Stands::End {
            place.0 - width
        } else {
            place.0
        };
        Self {
            place,
            stands,
            covers: Rectangle {
                left,
                right: left + width,
                top: place.1 - HALF_HEIGHT,
                bottom: place.1 + HALF_HEIGHT,
            },
            distance,
            leader: (distance > NEAR).then_some(leader),
        }
    }

    /// How unwelcome the name of a mark is there: far away, in the way of the names of others, its
    /// line over lines and marks.
    fn price(&self, of: Place, marks: &[(Place, &str)], lines: &[(Place, Place)]) -> f64 {
        let air = self.covers.grown(HALF_MARK, AIR);
        let others = || marks.iter().map(|mark| mark.0).filter(|&mark| mark != of);
        let crowding = others().filter(|&mark| air.contains(mark)).count();
        let over_marks = |leader| {
            let near = |mark| Rectangle::around(mark, HALF_MARK).grown(0.0, HALF_MARK);
            let meets = move |&mark: &Place| near(mark).meets(leader);
            others().filter(meets).count()
        };
        let over_lines = |leader| lines.iter().filter(|&&line| cross(line, leader)).count();
        let crossings = |leader| over_marks(leader) + over_lines(leader);
        let crossings = self.leader.map_or(0, crossings);
        // To the left it is where the names of the next marks go.
        let to_the_left = if self.stands == Stands::End {
            25.0
        } else {
            0.0
        };
        self.distance + to_the_left + 15.0 * crowding as f64 + 30.0 * crossings as f64
    }

    /// How unwelcome a flag is: high, or where it goes to the left not high enough for those of the
    /// marks below it, which are placed later.
    fn flag_price(&self, of: Place, marks: &[(Place, &str)]) -> f64 {
        let below = |&&(mark, _): &&(Place, &str)| {
            (self.covers.left..of.0).contains(&mark.0) && (mark.1 - of.1).abs() < CROWD
        };
        let lines = match self.stands {
            Stands::End => marks.iter().filter(below).count(),
            _ => 0,
        };
        let wanted = BESIDE + HALF_HEIGHT + 2.0 * STEP * lines as f64;
        (self.distance - wanted).abs()
    }

    fn clashes_with(&self, other: &Self) -> bool {
        let through = |line: Option<(Place, Place)>, name: &Rectangle| {
            line.is_some_and(|line| name.meets(line))
        };
        self.covers.overlaps(&other.covers)
            || through(self.leader, &other.covers)
            || through(other.leader, &self.covers)
            || self
                .leader
                .zip(other.leader)
                .is_some_and(|(a, b)| cross(a, b))
    }

    fn covers_mark(&self, mark: Place) -> bool {
        let mark = Rectangle::around(mark, HALF_MARK);
        self.covers.overlaps(&mark)
    }

    /// Writes the name, and the line to its mark.
    pub(super) fn draw(&self, canvas: &mut Canvas, name: &str, colour: Rgb, line: Rgb) {
        if let Some((mark, name)) = self.leader {
            canvas.line(&[mark, name], line, 0.7);
        }
        canvas.coloured_text(name, self.place, SIZE, self.stands, colour);
    }
}

/// Where the names of marks stand within an area, over none of the lines; `None` where there is no
/// room.
///
/// The names are placed from right to left, since most go to the right of their marks. Around a
/// name that finds no room all are flags in the next round: those leave each other room, each one
/// higher than that to its right.
pub(super) fn placed(
    marks: &[(Place, &str)],
    lines: &[(Place, Place)],
    area: &Area,
) -> Vec<Option<Label>> {
    let mut flags = vec![false; marks.len()];
    let mut best = vec![None; marks.len()];
    for _ in 0..ROUNDS {
        let labels = placed_once(marks, &flags, lines, area);
        if unplaced(&labels).count() < unplaced(&best).count() {
            best.clone_from(&labels);
        }
        for i in unplaced(&labels) {
            for (flag, (mark, _)) in flags.iter_mut().zip(marks) {
                *flag |= Rectangle::around(marks[i].0, CROWD).contains(*mark);
            }
        }
    }
    best
}

/// The marks without a name.
fn unplaced(labels: &[Option<Label>]) -> impl Iterator<Item = usize> {
    (0..labels.len()).filter(|&i| labels[i].is_none())
}

/// One name after the other, each where it is least in the way.
fn placed_once(
    marks: &[(Place, &str)],
    flags: &[bool],
    lines: &[(Place, Place)],
    area: &Area,
) -> Vec<Option<Label>> {
    let mut order: Vec<usize> = (0..marks.len()).collect();
    order.sort_by(|&a, &b| marks[b].0.0.total_cmp(&marks[a].0.0));
    order.truncate(MOST);
    let mut labels: Vec<Option<Label>> = vec![None; marks.len()];
    for i in order {
        let (mark, name) = marks[i];
        let free = |label: &Label| {
            let mut others = labels.iter().flatten();
            label.covers.within(area)
                && !lines.iter().any(|&line| label.covers.meets(line))
                && !marks.iter().any(|&(other, _)| label.covers_mark(other))
                && !others.any(|other| label.clashes_with(other))
        };
        let price = |label: &Label| {
            if flags[i] {
                label.flag_price(mark, marks)
            } else {
                label.price(mark, marks, lines)
            }
        };
        let candidates = if flags[i] {
            flag_places(mark, name, area)
        } else {
            all_places(mark, name)
        };
        let candidates = candidates.into_iter().filter(free);
        labels[i] = candidates.min_by(|a, b| price(a).total_cmp(&price(b)));
    }
    labels
}

/// Flags to the right, or where the area ends there to the left.
fn flag_places(mark: Place, name: &str, area: &Area) -> Vec<Label> {
    let flags = |stands| {
        let height = |ring| BESIDE + HALF_HEIGHT + STEP * f64::from(ring);
        (0..RINGS).map(move |ring| Label::flag(mark, name, height(ring), stands))
    };
    let right: Vec<Label> = flags(Stands::Start).collect();
    if right.iter().any(|label| label.covers.right <= area.right) {
        return right;
    }
    flags(Stands::End).collect()
}

/// Places all around, flags among them.
fn all_places(mark: Place, name: &str) -> Vec<Label> {
    let directions: Vec<f64> = (0..DIRECTIONS)
        .map(|i| f64::from(i) / f64::from(DIRECTIONS) * std::f64::consts::TAU)
        .filter(|direction| direction.cos().abs() > 0.2)
        .collect();
    let at_distance = |added: f64| {
        let beside = move |&direction: &f64| Label::beside(mark, name, BESIDE + added, direction);
        let height = BESIDE + HALF_HEIGHT + added;
        let flags = [height, -height].into_iter().flat_map(move |height| {
            [Stands::Start, Stands::End].map(|stands| Label::flag(mark, name, height, stands))
        });
        directions.iter().map(beside).chain(flags)
    };
    let rings = (0..RINGS).map(|ring| STEP * f64::from(ring));
    rings.flat_map(at_distance).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::frame::WHOLE;

    #[test]
    fn a_mark_by_itself_has_its_name_to_the_right() {
        let labels = placed(&[((300.0, 300.0), "name")], &[], &WHOLE);
        let label = labels[0].unwrap();
        assert_eq!((label.place, label.leader), ((307.0, 300.0), None));
    }

    #[test]
    fn names_of_a_crowd_overlap_neither_each_other_nor_a_mark() {
        let marks: Vec<(Place, &str)> = (0..20)
            .map(|i| {
                (
                    (300.0 + 12.0 * f64::from(i), 500.0),
                    "a name of some length",
                )
            })
            .collect();
        let labels = placed(&marks, &[], &WHOLE);
        let labels: Vec<Label> = labels.into_iter().flatten().collect();
        assert!(labels.len() == marks.len(), "{}", labels.len());
        for (i, label) in labels.iter().enumerate() {
            assert!(label.covers.within(&WHOLE));
            assert!(!marks.iter().any(|&(mark, _)| label.covers_mark(mark)));
            assert!(!labels[..i].iter().any(|other| label.clashes_with(other)));
        }
    }

    #[test]
    fn two_marks_at_the_right_end_both_have_names() {
        let marks = [((703.6, 514.0), "NM"), ((720.1, 514.0), "NM + check")];
        let labels = placed(&marks, &[], &WHOLE);
        assert!(labels.iter().all(Option::is_some));
    }

    #[test]
    fn names_keep_off_the_lines() {
        let line = ((300.0, 300.0), (400.0, 300.0));
        let labels = placed(&[((300.0, 300.0), "name")], &[line], &WHOLE);
        assert!(!labels[0].unwrap().covers.meets(line));
    }

    #[test]
    fn a_name_that_has_no_room_is_left_out() {
        let long = "n".repeat(1000);
        assert_eq!(placed(&[((300.0, 300.0), &long)], &[], &WHOLE), [None]);
    }

    #[test]
    fn a_line_meets_what_it_passes_through() {
        let square = Rectangle::around((0.0, 0.0), 1.0);
        assert!(square.meets(((-2.0, 0.5), (2.0, 0.5))));
        assert!(square.meets(((-2.0, -2.0), (0.0, 0.0))));
        assert!(!square.meets(((-2.0, 2.0), (2.0, 2.0))));
        assert!(!square.meets(((-2.0, 0.0), (-1.5, 0.0))));
    }
}
