//! What is allocated, counted: by steps next to nothing, by a contact what its builder announces.

mod memory;
mod ranks;
mod steps;
mod threads;

use std::alloc::System;

use viscocontact_scenes as common;

use stats_alloc::{INSTRUMENTED_SYSTEM, StatsAlloc};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

// Without the test harness, whose own threads would be counted: the allocator counts the whole process.
fn main() {
    steps::steps_allocate_nothing();
    steps::steps_on_states_allocate_nothing();
    println!("steps allocate nothing: ok");
    steps::tilting_steps_allocate_nothing();
    println!("tilting steps allocate nothing: ok");
    steps::elastic_solutions_allocate_nothing();
    println!("elastic solutions allocate nothing: ok");
    steps::sheared_steps_allocate_nothing();
    println!("steps with friction allocate nothing: ok");
    threads::steps_on_threads_allocate_blocks_of_a_queue();
    println!("steps on threads allocate blocks of a queue: ok");
    ranks::warm_steps_of_ranks_allocate_nothing();
    println!("warm steps of ranks allocate nothing: ok");
    ranks::ranks_announce_what_is_counted();
    println!("ranks announce what is counted: ok");
    memory::documents_state_what_builders_announce();
    memory::attraction_takes_what_is_announced();
    println!("documents state what builders announce: ok");
    memory::builders_announce_what_is_counted();
    println!("builders announce what is counted: ok");
}
