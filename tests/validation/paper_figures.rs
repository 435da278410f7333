//! The figures of the source paper, as the example `paper_figures` draws them.

use crate::common::paper_figures::{
    CLOSED, Merit, OPEN, TIMES, figure_2, figure_3, figure_6, figures_4_and_5, pressed_punch,
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
        println!("{:?}: {:?}", study.rule, study.errors);
        study.orders().into_iter().for_each(assert_merit);
    }
}
