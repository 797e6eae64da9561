//! Clipping of lines to the range of an axis.

/// A position across the axis, and one along it as a fraction of the axis: from 0 at its low end to
/// 1 at its high end.
type Position = (f64, f64);

/// The pieces of a line within the axis. Where the line crosses an end of the axis it is cut there;
/// a position that is not finite interrupts it.
pub(super) fn clip(line: &[Position]) -> Vec<Vec<Position>> {
    let mut pieces = Vec::new();
    let mut piece: Vec<Position> = Vec::new();
    for pair in line.windows(2) {
        match clip_segment(pair[0], pair[1]) {
            Some((from, to)) => {
                if piece.last() != Some(&from) {
                    pieces.push(std::mem::take(&mut piece));
                    piece.push(from);
                }
                piece.push(to);
            }
            None => pieces.push(std::mem::take(&mut piece)),
        }
    }
    pieces.push(piece);
    pieces.retain(|piece| !piece.is_empty());
    pieces
}

/// The part of a segment within the axis.
fn clip_segment(a: Position, b: Position) -> Option<(Position, Position)> {
    if !(a.0.is_finite() && a.1.is_finite() && b.0.is_finite() && b.1.is_finite()) {
        return None;
    }
    if a.1.max(b.1) < 0.0 || a.1.min(b.1) > 1.0 {
        return None;
    }
    let cut = |end: Position| {
        let fraction = end.1.clamp(0.0, 1.0);
        if fraction == end.1 {
            return end;
        }
        let t = (fraction - a.1) / (b.1 - a.1);
        (a.0 + t * (b.0 - a.0), fraction)
    };
    Some((cut(a), cut(b)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_cut_where_it_leaves_the_axis_and_where_it_returns() {
        let line = [(0.0, 0.5), (1.0, 1.5), (2.0, 1.5), (3.0, -1.0), (4.0, 0.0)];
        let pieces = clip(&line);
        assert_eq!(
            pieces,
            [
                vec![(0.0, 0.5), (0.5, 1.0)],
                vec![(2.2, 1.0), (2.6, 0.0)],
                vec![(4.0, 0.0), (4.0, 0.0)],
            ]
        );
    }

    #[test]
    fn a_line_within_the_axis_is_unchanged_and_a_gap_interrupts_it() {
        let line = [
            (0.0, 0.1),
            (1.0, 0.2),
            (2.0, f64::NAN),
            (3.0, 0.3),
            (4.0, 1.0),
        ];
        let pieces = clip(&line);
        assert_eq!(
            pieces,
            [vec![(0.0, 0.1), (1.0, 0.2)], vec![(3.0, 0.3), (4.0, 1.0)]]
        );
        assert!(clip(&[(0.0, 7.0), (1.0, 8.0)]).is_empty());
        assert!(clip(&[]).is_empty());
    }
}
