//! Tables of measured data: from files, from slices, and master curves.

use viscocontact::rheology::{Isotherm, MasterCurve, Measurements, Rheology};

use crate::engine::{Target, Verdict, judged, known};
use crate::models::creeps;
use crate::source::Source;
use viscocontact_scenes::{pairs, triples};

pub fn targets() -> Vec<Target> {
    vec![
        Target { name: "table_slices", short: 150, run: slices },
        Target { name: "table_master", short: 60, run: master },
        Target { name: "table_csv", short: 600, run: csv },
    ]
}

/// A table is known, and creeps, until its end, and no further.
fn look(table: &dyn Rheology) -> Result<(), String> {
    let until = table.known_until();
    known("the end of a table", [until])?;
    creeps(table, until)?;
    match table.fit_report() {
        Some(report) => {
            known("misfits", [report.max_misfit(), report.rms_misfit(), report.wrong_way()])?;
            known("range", report.range().into_iter().flatten())?;
            if report.to_string().is_empty() { Err("a report without words".to_owned()) } else { Ok(()) }
        }
        None => Err("a table without report".to_owned()),
    }
}

/// Abscissae, and two columns that rise, or are anything.
fn columns(source: &mut Source) -> [Vec<f64>; 3] {
    let count = if source.chance(0.9) { source.count(4, 24) } else { source.count(0, 4) };
    let first = source.scale(1e-4, 1e4);
    let factor = source.scale(1.05, 10.0);
    let noise = source.choose(&[0.0, 0.0, 0.0, 0.01, 0.2]);
    let (size, slope) = (source.scale(1e-9, 1e9), source.between(-0.02, 0.6));
    let mut columns = [Vec::new(), Vec::new(), Vec::new()];
    // half of the tables have no slip
    let slips = source.choose(&[0.0, 0.01]);
    for k in 0..count {
        let x = first * factor.powi(k as i32);
        columns[0].push(if source.chance(slips) { source.anything() } else { x });
        for column in [1, 2] {
            let value = size * factor.powf(slope * k as f64) * (1.0 + noise * (source.unit() - 0.5));
            columns[column].push(if source.chance(0.5 * slips) { source.anything() } else { value });
        }
    }
    if source.chance(0.02) {
        columns[1].pop();
    }
    columns
}

/// The same as a relaxation test would give it, which falls.
fn falling(values: &[f64]) -> Vec<f64> {
    values.iter().map(|value| 1.0 / value).collect()
}

fn slices(source: &mut Source) -> Verdict {
    let [x, first, second] = columns(source);
    match source.below(3) {
        0 => judged(Measurements::creep(&pairs(&x, &first)).and_then(|table| table.fit()), |table| look(&table)),
        1 => judged(Measurements::relaxation(&pairs(&x, &falling(&first))).and_then(|table| table.fit()), |table| {
            look(&table)
        }),
        _ => judged(Measurements::dynamic(&triples(&x, &first, &second)).and_then(|table| table.fit()), |table| {
            look(&table)
        }),
    }
}

fn master(source: &mut Source) -> Verdict {
    let kind = source.below(3);
    let mut isotherms = Vec::new();
    let [x, first, second] = columns(source);
    let mut temperatures = Vec::new();
    for _ in 0..source.count(1, 4) {
        let temperature = source.between(250.0, 450.0);
        // the same curve at another place, or another one
        let shift = source.scale(0.03, 30.0);
        let other = source.chance(0.05).then(|| columns(source));
        let [x, first, second] = other.unwrap_or_else(|| {
            let x = x.iter().map(|x| x * shift).collect();
            [x, first.clone(), second.clone()]
        });
        let table = match if source.chance(0.03) { source.below(3) } else { kind } {
            0 => Measurements::creep(&pairs(&x, &first)),
            1 => Measurements::relaxation(&pairs(&x, &falling(&first))),
            _ => Measurements::dynamic(&triples(&x, &first, &second)),
        };
        temperatures.push(temperature);
        isotherms.extend(table.and_then(|table| Isotherm::new(temperature, table)));
    }
    let reference = if source.chance(0.95) { source.choose(&temperatures) } else { source.between(250.0, 450.0) };
    judged(MasterCurve::new(reference, isotherms), |curve| {
        known("shift factors", curve.shift_factors().into_iter().flat_map(|(a, b)| [a, b]))?;
        known("points", curve.points().into_iter().flat_map(|(a, _, b)| [a, b]))?;
        for law in [curve.wlf(), curve.arrhenius()].into_iter().flatten() {
            known("constants", law.wlf_constants().into_iter().flatten().chain(law.activation_energy()))?;
        }
        curve.fit().map_or(Ok(()), |table| look(&table))
    })
}

fn csv(source: &mut Source) -> Verdict {
    use viscocontact::rheology::{Experiment, Units};
    use viscocontact::{Delimiter, TextFormat};

    const FILES: [&str; 8] = [
        "# PMMA, 23 C\ntime [s], J [1/Pa]\n10, 1.2e-9\n1, 1.0e-9\n100, 1.3e-9\n3, 1.1e-9\n30, 1.25e-9\n300, 1.4e-9\n",
        "1; 4.0e6\n3; 3.1e6\n10; 2.4e6\n30; 2.1e6\n100; 1.9e6\n300; 1.8e6\n",
        "omega,G',G''\n0.1,1.0e6,2e5\n1,1.5e6,4e5\n10,2.2e6,4e5\n100,2.5e6,1e5\n30,2.3e6,3e5\n",
        "t\tE\n0.1\t\"3e6\"\n1\t2e6\n10\t1e6\n100\t0.5e6\n\n",
        "1,5 2,5\n2,5 2,6\n1 2,4\n3 2,7\n",
        "remark;t / min;J (1/GPa)\na;0,5;1,0\n\"b;c\";1;1,25\n;2;1,5\n;4;1,75\n",
        " 1.0D-01 3.0D+06\n 1.0D+00 2.0D+06\n 1.0D+01 1.0D+06\n 1.0D+02 0.5D+06\n",
        "f [Hz],E' [10^6 Pa],E'' [N/mm²]\r\n\"0,1\",\"1,0\",\"0,2\"\r\n1,\"1,5\",\"0,4\"\r\n10,2,\"0,4\"\r\n100,\"2,5\",\"0,1\"\r\n",
    ];
    use Experiment::{Creep, Dynamic, Relaxation};
    const KINDS: [Experiment; 8] = [Creep, Relaxation, Dynamic, Relaxation, Creep, Creep, Relaxation, Dynamic];
    const UNITS: [[f64; 2]; 8] = {
        let mut units = [[1.0; 2]; 8];
        units[5] = [60.0, 1e-9];
        units[7] = [std::f64::consts::TAU, 1e6];
        units
    };
    let which = source.below(FILES.len());
    let file = FILES[which].as_bytes();
    let file = match source.below(8) {
        0 => file.to_vec(),
        1 => source.damage(file),
        _ => source.damage_text(file),
    };
    // those of the headings, mostly
    let [abscissa, value] =
        if source.chance(0.7) { UNITS[which] } else { [source.scale(1e-3, 1e3), source.scale(1e-3, 1e3)] };
    let units = match Units::new(abscissa, value) {
        Ok(units) => units,
        Err(error) => return judged(Err::<(), _>(error), |()| Ok(())),
    };
    let format = if source.chance(0.9) {
        match which {
            4 | 5 => TextFormat::default().with_decimal_comma(true),
            7 => TextFormat::default().with_delimiter(Delimiter::Comma).with_decimal_comma(true),
            _ => TextFormat::default(),
        }
    } else {
        let delimiters = [Delimiter::Comma, Delimiter::Semicolon, Delimiter::Tab, Delimiter::Blanks];
        TextFormat::default().with_delimiter(source.choose(&delimiters)).with_decimal_comma(source.chance(0.5))
    };
    let experiment = if source.chance(0.9) { KINDS[which] } else { source.choose(&[Creep, Relaxation, Dynamic]) };
    let table = Measurements::from_csv_reader(experiment, &file[..], units, format);
    judged(table.and_then(|table| table.fit()), |body| look(&body))
}
