//! The figures of the source paper, as the example `paper_figures` draws them.

use crate::common::figures::figure;
use crate::common::paper_figures::{
    ASKED, CLOSED, FEW_STEPS, Merit, OPEN, TIMES, figure_2, figure_3, figure_6, figures_4_and_5, figures_in_few_steps,
    pressed_punch,
};

fn assert_merit(merit: Merit) {
    println!("{merit:?}");
    assert!(merit.holds(), "{merit:?}");
}

#[test]
fn figure_2_is_lures_pressure() {
    for eccentricity in CLOSED {
        assert_merit(figure_2(&pressed_punch(256, eccentricity).unwrap(), eccentricity).unwrap());
    }
}

#[test]
fn figure_3_does_not_depend_on_the_mesh() {
    for eccentricity in OPEN {
        let [contact, finer] = [256, 512].map(|cells| pressed_punch(cells, eccentricity).unwrap());
        figure_3([&contact, &finer], eccentricity).into_iter().for_each(assert_merit);
    }
}

#[test]
fn figures_4_and_5_are_table_1_at_all_times() {
    for figure in [4, 5] {
        let mut shown = 0;
        let show = |_: &_, merit| {
            shown += 1;
            assert_merit(merit);
        };
        figures_4_and_5(figure, 256, show).unwrap();
        assert_eq!(shown, TIMES.len());
    }
}

#[test]
fn figure_6_shows_first_order_and_second_or_more() {
    for study in figure_6(96).unwrap() {
        println!("{}² cells: {:?}", study.cells, study.errors);
        study.orders().into_iter().for_each(assert_merit);
    }
}

/// Steps alone leave the rim as long steps met it; fields asked for are as exact as asked after any number of steps.
#[test]
fn figures_4_and_5_in_few_steps_with_fields_asked_for() {
    let steps = FEW_STEPS.map(|steps| format!("{steps} steps | ")).concat();
    let mut table = format!("| | {steps}fields to 1e-2 | fields to 1e-3 |\n|{}", "---|".repeat(FEW_STEPS.len() + 3));
    let names = ["4: Maxwell", "5: Zener"];
    for (name, few) in names.into_iter().zip(figures_in_few_steps(96).unwrap().chunks(FEW_STEPS.len())) {
        let alone = few.iter().map(|few| format!("{:.1e}, {}", few.errors[0], few.convolutions[0]));
        let asked = ASKED.into_iter().enumerate().map(|(k, asked)| {
            let error = few.iter().fold(0.0, |most: f64, few| most.max(few.errors[k + 1]));
            assert!(error <= asked, "Figure {name}: {error:.1e}");
            let more = few.iter().map(|few| few.convolutions[k + 1] - few.convolutions[0]).max().unwrap();
            format!("{error:.1e}, {more} more")
        });
        table += &format!("\n| {name} | {} |", alone.chain(asked).collect::<Vec<_>>().join(" | "));
    }
    let table: Vec<&str> = table.lines().map(str::trim_end).collect();
    println!("{}", table.join("\n"));
    figure("the paper's figures in few steps", &table.join("\n")).unwrap();
}
