//! Does the answer depend on the steps, on the rule, or on how a load history is followed?

mod adaptive;
mod cost;
mod fields;
mod fixed_steps;
mod honest;
mod inside;
mod own_contact;
mod protocols;
mod protocols_run;
mod pulses;
mod returns;
mod run;
mod several_histories;
mod springs;
mod states;
mod states_accuracy;
mod states_kept;
mod states_limits;
mod states_merging;
mod states_outside;
mod states_population;
mod taps_in_space;
mod taps_on_states;
mod temperature;
mod time_rules;
