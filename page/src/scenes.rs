//! Scenes to begin with: those of the README and of the guide's tour, and one of each kind.

use crate::settings::Key::*;
use crate::settings::Settings;

/// Name, what is seen, and settings of each scene.
pub fn scenes() -> Vec<(&'static str, &'static str, Settings)> {
    let zener = [(Material, 1.0), (Time, 0.2)];
    let scene = |values: &[(crate::settings::Key, f64)], load: &[(f64, f64)]| Settings::with(values, load);
    vec![
        (
            "A ball sinks in",
            "The first program of the README: 1 N on a body that flows. The contact doubles in 2 s.",
            scene(&[(Cells, 128.0)], &[(0.0, 1.0)]),
        ),
        (
            "A held depth",
            "The tour: the force jumps to 0.5 N and creeps for 0.1 s; then the depth is held, and the force relaxes.",
            scene(&[&zener[..], &[(Duration, 0.6), (Hold, 0.1), (Steps, 60.0)]].concat(), &[(0.0, 0.5)]),
        ),
        (
            "A ramp",
            "The tour: to 0.5 N in 0.1 s, then held.",
            scene(&[&zener[..], &[(Duration, 1.0)]].concat(), &[(0.0, 0.0), (0.1, 0.5)]),
        ),
        (
            "Too small a grid",
            "The tour: 1 kN would press the ball beyond the grid. The step is refused, with a remedy.",
            scene(&[&zener[..], &[(Duration, 0.2)]].concat(), &[(0.0, 0.5), (0.1, 0.5), (0.2, 1000.0)]),
        ),
        (
            "Pressed in and drawn back",
            "The body recovers more slowly than the ball rises: the contact ends before the ball is back at its first touch.",
            scene(
                &[(Material, 1.0), (Time, 0.5), (Control, 1.0), (Duration, 2.0), (Cells, 128.0)],
                &[(0.0, 0.0), (1.0, 60.0), (2.0, 0.0)],
            ),
        ),
        (
            "A flat punch",
            "The pressure is infinite at the edge, and does not change in time; the depth does.",
            scene(&[(Shape, 2.0), (Radius, 1.0), (Material, 1.0), (Cells, 128.0), (Steps, 40.0)], &[(0.0, 1.0)]),
        ),
        (
            "A cone on a slow polymer",
            "A power-law transition: the depth grows through all decades of time.",
            scene(
                &[(Shape, 1.0), (Material, 2.0), (Exponent, 0.3), (Slope, 0.1), (Duration, 4.0)],
                &[(0.0, 0.0), (0.2, 0.5)],
            ),
        ),
        (
            "A rough ball",
            "Asperities touch first; creep brings them together.",
            scene(&[(Roughness, 4.0), (Material, 1.0), (Retarded, 0.2), (Cells, 128.0), (Steps, 40.0)], &[(0.0, 0.3)]),
        ),
        (
            "A fretting loop",
            "A pressed ball is moved to and fro: a ring slips, the middle sticks, and the loop's area is lost.",
            scene(
                &[(Material, 1.0), (Friction, 0.6), (Amplitude, 40.0), (Duration, 3.0), (Cells, 64.0)],
                &[(0.0, 1.0)],
            ),
        ),
    ]
}
