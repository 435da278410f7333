//! What the scenes of the page give natively, as JSON: `browser.mjs` compares the page with it.
//!
//! `cargo run --release -p viscocontact-page --example values > target/page/values.json`

use viscocontact_page::scenes::scenes;
use viscocontact_page::simulation::Simulation;

fn main() -> Result<(), String> {
    let mut scenes_of_json = Vec::new();
    for (name, _, settings) in scenes() {
        let mut run = Simulation::new(&settings)?;
        let refused = loop {
            match run.advance() {
                Ok(true) => {}
                Ok(false) => break String::new(),
                Err(error) => break error,
            }
        };
        let line = run.frames.lines.last().map(|line| &line[0]);
        let [displacement, force] = &run.friction;
        scenes_of_json.push(format!(
            r#"{{"name":{name:?},"link":{:?},"refused":{refused:?},"series":{:?},"line":{:?},"loop":{:?}}}"#,
            settings.fragment(),
            run.frames.series,
            line.unwrap_or(&Vec::new()),
            [displacement, force]
        ));
    }
    println!("[{}]", scenes_of_json.join(",\n"));
    Ok(())
}
