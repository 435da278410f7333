//! Scenes drawn at random are the same on 1 to 7 ranks as in one process, bit by bit: every kernel, shapes that come down along
//! curves and are pulled off again, tilts, changing temperature, steps given or chosen by their error, fewer bands of rows than
//! ranks and more. `RANKS_SCENES` (24) and `RANKS_SEED` (1) choose others.

use crate::common::any_scene::AnyScene;
use crate::common::environment::from_environment;
use viscocontact::parallel::Threads;

#[test]
fn random_scenes_are_the_same_on_all_ranks() {
    let (scenes, first) = (from_environment("RANKS_SCENES", 24), 1000 * from_environment("RANKS_SEED", 1));
    let (mut pressed, mut steps, mut failed) = (0, 0, 0);
    for seed in first..first + scenes {
        let scene = AnyScene::new(seed);
        let alone = scene.course(None).unwrap_or_else(|error| panic!("{}: {error}", scene.name));
        let courses = Threads::run(scene.size, |ranks| scene.course(Some(ranks))).unwrap();
        for (rank, course) in courses.into_iter().enumerate() {
            let course = course.unwrap_or_else(|error| panic!("{}, rank {rank}: {error}", scene.name));
            let pairs = course.reports.iter().zip(&alone.reports);
            let differing = pairs.enumerate().find(|(_, (own, alone))| own != alone);
            assert_eq!(differing, None, "{}, rank {rank}", scene.name);
            assert_eq!((course.reports.len(), &course.error), (alone.reports.len(), &alone.error), "{}", scene.name);
            assert_eq!(course.numbers, alone.numbers, "{}, rank {rank}", scene.name);
            assert!(rank > 0 || course.fields == alone.fields, "{}: fields differ", scene.name);
        }
        pressed += usize::from(alone.reports.iter().any(|report| !report.contains("contact_cells: 0,")));
        (steps, failed) = (steps + alone.reports.len(), failed + usize::from(alone.error.is_some()));
    }
    println!("{scenes} scenes, {steps} steps, {pressed} scenes with contact, {failed} end with the same error");
    assert!(2 * pressed > scenes as usize && 3 * failed < scenes as usize, "{pressed} pressed, {failed} failed");
}
