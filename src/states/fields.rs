//! Fields of a contact on elastic states.

use crate::error::{Result, within};
use crate::fields::KeptFields;
use crate::load::Load;
use crate::run::Contact;
use crate::states::contact::StatesContact;
use crate::states::contacts::{Contacts, SolvedContact, Superposition};
use crate::states::profile::Profile;

impl StatesContact {
    /// The pressure \[Pa\] from the states that the sweep kept
    /// ([`Sweep::keep_pressures`](crate::states::Sweep::keep_pressures)), linear in the level between them: one value
    /// for each cell of the grid, to the accuracy of the sweep.
    ///
    /// # Errors
    /// If none were kept.
    pub fn pressure(&self) -> Result<Vec<f64>> {
        self.states.superposed_field(self.tractions())
    }

    /// All fields to an `accuracy`, the error of the pressure in L1 over the force: from elastic contacts at a few
    /// levels, which are doubled until pressure and displacement change by less. They are about 10 contacts for 1e-2
    /// and 20 for 1e-3, each some 5 convolutions from the one before, and 12 bytes of memory for each of its cells in
    /// contact. The L2 error is about twice as large, relative to the field, and the error of the maximum pressure
    /// five times. An accuracy of 0 takes every group of levels.
    /// The steps that were taken count as exact: a run has
    /// [`Run::fields_to`](crate::run::Run::fields_to).
    ///
    /// # Errors
    /// If the accuracy is outside \[0, 0.1\]; if the states were read from a file or given
    /// as a table; as
    /// [`ElasticContact::solve`](crate::elastic::ElasticContact::solve).
    pub fn fields(&self, accuracy: f64) -> Result<KeptFields> {
        within("accuracy of the fields", accuracy, (0.0..=0.1).contains(&accuracy), "in [0, 0.1]")?;
        let states = self.states();
        let mut elastic = states.elastic_contact()?;
        elastic.solve(Load::Force { normal: 0.0, tilt: states.tilt })?;
        let mut motion = elastic.fields().motion(0);
        let tolerance = elastic.fields().ground.settings.tolerance;
        let mut contacts = Contacts::new(elastic, states.tilt, tolerance);
        let (pressed, displaced) =
            (Profile::new(self.tractions()), Profile::new(self.levels.groups().map(|(top, _, w)| (top, w))));
        let weighted = [(&pressed, pressed.total()), (&displaced, displaced.total())];
        let Superposition { solved, fields, .. } = contacts.superpose(&weighted, accuracy)?;
        let [pressure, source]: [Vec<f64>; 2] = fields.try_into().expect("two profiles");
        // Σ W (u_e(l_i) − u_e(l_i−1)) is the displacement of Σ W (p_e(l_i) − p_e(l_i−1))
        let (elastic, mut displacement) = (contacts.elastic.fields(), vec![0.0; pressure.len()]);
        elastic.kernel().convolve(&source, &mut displacement, &mut elastic.kernel().workspace()?)?;
        let levels: Vec<f64> = solved.iter().map(|solved| solved.level).collect();
        let mut before = motion;
        for (share, SolvedContact { motion: now, .. }) in displaced.means(&levels).into_iter().zip(&solved) {
            motion.approach += share * (now.approach - before.approach);
            (0..2).for_each(|axis| motion.tilt[axis] += share * (now.tilt[axis] - before.tilt[axis]));
            before = *now;
        }
        motion.approach -= self.levels.lift;
        Ok(elastic.keep_with(pressure, displacement, motion, self.time()))
    }
}
