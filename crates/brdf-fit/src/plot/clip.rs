//! What of a line is within an axis.

/// The pieces of a line of (x, height) with heights from 0 to 1. Where the line crosses an end it
/// is cut there; what is not a number interrupts it.
pub(super) fn within(points: &[(f64, f64)]) -> Vec<Vec<(f64, f64)>> {
    let mut pieces = Vec::new();
    let mut piece: Vec<(f64, f64)> = Vec::new();
    for pair in points.windows(2) {
        match segment_within(pair[0], pair[1]) {
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

/// The part of a segment with heights from 0 to 1.
fn segment_within(a: (f64, f64), b: (f64, f64)) -> Option<((f64, f64), (f64, f64))> {
    if !(a.0.is_finite() && a.1.is_finite() && b.0.is_finite() && b.1.is_finite()) {
        return None;
    }
    if a.1.max(b.1) < 0.0 || a.1.min(b.1) > 1.0 {
        return None;
    }
    let cut = |end: (f64, f64)| {
        let height = end.1.clamp(0.0, 1.0);
        if height == end.1 {
            return end;
        }
        let t = (height - a.1) / (b.1 - a.1);
        (a.0 + t * (b.0 - a.0), height)
    };
    Some((cut(a), cut(b)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_cut_where_it_leaves_and_comes_back() {
        let line = [(0.0, 0.5), (1.0, 1.5), (2.0, 1.5), (3.0, -1.0), (4.0, 0.0)];
        let pieces = within(&line);
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
    fn a_line_inside_stays_and_a_gap_interrupts_it() {
        let line = [
            (0.0, 0.1),
            (1.0, 0.2),
            (2.0, f64::NAN),
            (3.0, 0.3),
            (4.0, 1.0),
        ];
        let pieces = within(&line);
        assert_eq!(
            pieces,
            [vec![(0.0, 0.1), (1.0, 0.2)], vec![(3.0, 0.3), (4.0, 1.0)]]
        );
        assert!(within(&[(0.0, 7.0), (1.0, 8.0)]).is_empty());
        assert!(within(&[]).is_empty());
    }
}
