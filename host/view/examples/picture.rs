//! A press on a disc: its image on the terminal and as PNG, and how the hyperparameter was chosen as SVG.
//! `cargo run -p dermatome-view --example picture [FOLDER]`

use dermatome_model::{model::Model, skin::Skin};
use dermatome_patch::layout::Layout;
use dermatome_view::{
    canvas::{Ink, Room, Scene, draw, legend},
    plot::criterion_svg,
    sheet::{Panel, Scale, Sheet, reconstruction_sheet},
};
use std::{error::Error, fs, path::Path};

const SKIN: &str = include_str!("../../tests/data/tiny.toml");
/// The press lowers voltages near electrode 2 by so much.
const PRESS: f64 = -0.1;

fn main() -> Result<(), Box<dyn Error>> {
    let text = SKIN.replace("hyperparameter = 0.03", "hyperparameter = \"gcv\"");
    let skin = Skin::parse(Path::new("skin.toml"), &text)?.made()?;
    let model = Model::build(&skin, |_| ())?;
    let is_near = |step: &dermatome_shared::stimulation::Step| step.to_bytes()[2..].contains(&2);
    let pairs = model.steps.iter().zip(&model.voltages);
    let change: Vec<f64> = pairs.map(|(step, v)| if is_near(step) { PRESS * v } else { 0.0 }).collect();
    let values = model.image(&change, &model.voltages);
    let maximum = values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let layout = Layout::from(&model.surface()?);
    let scene = Scene { layout: &layout, values: &values, maximum, contacts: &[], electrodes: &[] };
    let room = Room { columns: 80, rows: 24 };
    let ink = Ink::from_environment();
    print!("{}{}", draw(&scene, room, ink), legend(maximum, skin.contact_threshold, ink));
    let panel = Panel { caption: vec!["near electrode 2".to_owned()], values: &values, ..Panel::default() };
    let sheet = Sheet {
        title: &skin.name,
        layout: &layout,
        electrodes: &[],
        scale: Scale::RELATIVE,
        columns: 1,
        panels: vec![panel],
    };
    let folder = std::env::args().nth(1).unwrap_or_else(|| ".".to_owned());
    let folder = Path::new(&folder);
    fs::create_dir_all(folder)?;
    fs::write(folder.join("picture.png"), reconstruction_sheet(&sheet).encode()?)?;
    if let Some(selection) = &model.selection {
        fs::write(folder.join("criterion.svg"), criterion_svg(&skin.name, selection))?;
    }
    Ok(())
}
