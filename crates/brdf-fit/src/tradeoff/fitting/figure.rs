//! The figure of a trade-off of fitting: excess E against time.

use super::result::{Alternative, FitTradeoff};
use crate::plot::{Figure, TradePoint, trade_picture};

impl FitTradeoff {
    /// Excess E against time on logarithmic axes. The reference is marked as the chosen alternative.
    pub fn figure(&self) -> Figure {
        let points: Vec<TradePoint> = self
            .alternatives
            .iter()
            .enumerate()
            .filter_map(|(i, alternative)| point(i == 0, alternative))
            .collect();
        let figure = trade_picture(
            &points,
            "time of a fit on one thread / us",
            "excess E = E over all readings / lowest - 1",
            &self.title(),
        );
        let failed = self.alternatives.len() - points.len();
        Figure {
            caption: match failed {
                0 => figure.caption,
                _ => format!("{} Not fitted: {failed}.", figure.caption),
            },
            ..figure
        }
    }

    fn title(&self) -> String {
        let name = self.sample.as_ref().unwrap_or(&self.source);
        let wavelength = self.wavelength_um;
        wavelength.map_or_else(|| name.clone(), |w| format!("{name}, {w} um"))
    }
}

fn point(chosen: bool, alternative: &Alternative) -> Option<TradePoint> {
    let measured = alternative.measured()?;
    Some(TradePoint {
        label: alternative.name.clone(),
        x: 1e6 * measured.seconds,
        y: measured.excess_e,
        pareto: measured.pareto,
        chosen,
    })
}
