//! By what the error of a step is weighted.

use crate::parallel::Rows;

/// The weight of a cell in a mean.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Weight {
    Pressure,
    /// The least pressure of the last steps: cells that join a dashpot have a finite pressure at once, and a kink.
    LeastPressure,
    /// Of bodies that parted in this step.
    PressureBefore,
    /// Of bodies apart: the surface recovers everywhere alike.
    Even,
}

impl Weight {
    pub(super) fn new(rows: &Rows, pressure: [&[f64]; 3], dashpot: bool) -> Weight {
        let [tried, now, _] = pressure;
        let [pressed, was_pressed] = [tried, now].map(|pressure| rows.any(pressure.iter().any(|&p| p > 0.0)));
        let inside = || rows.any((0..tried.len()).any(|k| least(pressure.map(|p| p[k])) > 0.0));
        match (pressed, was_pressed) {
            (true, true) if dashpot && inside() => Weight::LeastPressure,
            (true, _) => Weight::Pressure,
            (false, true) => Weight::PressureBefore,
            (false, false) => Weight::Even,
        }
    }

    pub(super) fn of(self, pressure: [f64; 3]) -> f64 {
        match self {
            Weight::Pressure => pressure[0],
            Weight::LeastPressure => least(pressure),
            Weight::PressureBefore => pressure[1],
            Weight::Even => 1.0,
        }
    }

    pub(super) fn is_of_a_contact(self) -> bool {
        matches!(self, Weight::Pressure | Weight::LeastPressure)
    }
}

fn least(states: [f64; 3]) -> f64 {
    states.into_iter().fold(f64::INFINITY, f64::min)
}
