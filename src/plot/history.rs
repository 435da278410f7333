//! Quantities of a contact over time.

use crate::error::{Result, exact_length};
use crate::plot::{COLORS, Chart, Legend, Quantity, Style};
use crate::run::Contact;

/// A quantity of a contact that a [`History`] records.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum HistoryColumn {
    /// [`Contact::force`] \[N\].
    Force,
    /// [`Contact::approach`] \[m\].
    Approach,
    /// [`Contact::contact_area`] \[m²\].
    ContactArea,
    /// [`Contact::mean_pressure`] \[Pa\].
    MeanPressure,
    /// [`Fields::max_pressure`](crate::fields::Fields::max_pressure) \[Pa\]; not recorded of contacts on
    /// elastic states.
    MaxPressure,
}

impl HistoryColumn {
    /// All of them.
    pub const ALL: [HistoryColumn; 5] = [
        HistoryColumn::Force,
        HistoryColumn::Approach,
        HistoryColumn::ContactArea,
        HistoryColumn::MeanPressure,
        HistoryColumn::MaxPressure,
    ];

    /// Name and SI unit.
    pub fn quantity(self) -> Quantity {
        let (name, unit) = match self {
            HistoryColumn::Force => ("force", "N"),
            HistoryColumn::Approach => ("approach", "m"),
            HistoryColumn::ContactArea => ("contact area", "m²"),
            HistoryColumn::MeanPressure => ("mean pressure", "Pa"),
            HistoryColumn::MaxPressure => ("maximum pressure", "Pa"),
        };
        Quantity::new(name, unit)
    }

    /// The value of a contact, if it has one.
    fn value(self, contact: &impl Contact) -> Option<f64> {
        match self {
            HistoryColumn::Force => Some(contact.force()),
            HistoryColumn::Approach => Some(contact.approach()),
            HistoryColumn::ContactArea => Some(contact.contact_area()),
            HistoryColumn::MeanPressure => Some(contact.mean_pressure()),
            HistoryColumn::MaxPressure => contact.in_space().map(|contact| contact.max_pressure()),
        }
    }
}

/// Quantities of a contact recorded over a run, to draw over time.
///
/// ```
/// use viscocontact::plot::{History, HistoryColumn, Scale};
/// use viscocontact::prelude::*;
///
/// let mut contact = ViscoelasticContact::builder(Grid::square(16, 4.0e-3)?)
///     .geometry(&Sphere::new(10.0e-3)?)
///     .material(Material::incompressible(Maxwell::with_time(1.0e6, 1.0)?))
///     .build()?;
/// let mut history = History::new();
/// for dt in [0.0, 0.1, 0.2] {
///     contact.step(dt, Load::force(0.5))?;
///     history.record(&contact);
/// }
/// assert_eq!(history.column(HistoryColumn::Approach)[2], contact.approach());
/// let mut chart = history.chart(HistoryColumn::Approach)?;
/// chart.scale = Scale::LogX;
/// # let path = std::env::temp_dir().join(format!("viscocontact-doc-history-{}.png", std::process::id()));
/// chart.save(&path)?;
/// # std::fs::remove_file(&path).unwrap();
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct History {
    times: Vec<f64>,
    columns: [Vec<f64>; HistoryColumn::ALL.len()],
}

impl History {
    /// An empty history.
    pub fn new() -> History {
        History::default()
    }

    /// Records the current state of a contact, in space or on elastic states, or of a sample within a step
    /// ([`Run::samples`](crate::run::Run::samples)).
    pub fn record(&mut self, contact: &impl Contact) {
        self.times.push(contact.time());
        for (column, observed) in self.columns.iter_mut().zip(HistoryColumn::ALL) {
            column.extend(observed.value(contact));
        }
    }

    /// The recorded times \[s\].
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The recorded values of a quantity, one per time; none of a quantity that the contact does not have.
    pub fn column(&self, observed: HistoryColumn) -> &[f64] {
        &self.columns[observed as usize]
    }

    /// A recorded quantity over time.
    ///
    /// # Errors
    /// If the quantity was not recorded.
    pub fn chart(&self, observed: HistoryColumn) -> Result<Chart> {
        Chart::history("", &self.times, observed.quantity(), &[("", self.column(observed))])
    }
}

impl Chart {
    /// Labelled columns of values of one quantity over time \[s\]. [`Chart::scale`] makes axes logarithmic; time 0 is
    /// left out on those.
    ///
    /// # Errors
    /// If a column does not have one value per time.
    pub fn history(
        title: impl Into<String>,
        times: &[f64],
        quantity: impl Into<Quantity>,
        columns: &[(&str, &[f64])],
    ) -> Result<Chart> {
        let mut chart = Chart::new(title, Quantity::new("time", "s"), quantity, Legend::LowerRight);
        for (k, (label, values)) in columns.iter().enumerate() {
            exact_length("column of a history", values.len(), times.len())?;
            let points = times.iter().copied().zip(values.iter().copied()).collect();
            chart.add(*label, COLORS[k % COLORS.len()], Style::LineAndDots, points);
        }
        Ok(chart)
    }
}
