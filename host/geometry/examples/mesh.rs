//! A disc of 210 mm with 16 electrodes on its rim becomes triangles, in a file that Gmsh reads:
//! `cargo run -p dermatome-geometry --example mesh -- disc.msh`.

use dermatome_geometry::{
    embedding::Embedding,
    mesh::{Lattice, export, generate, quality::quality},
    outline::Outline,
    sheet::{EdgeLengths, ElectrodeModel, Place, Sheet},
};

const ELECTRODES: usize = 16;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let outline = Outline::disc(0.105);
    let spacing = outline.perimeter() / ELECTRODES as f64;
    let places = (0..ELECTRODES).map(|electrode| Place::Rim(electrode as f64 * spacing)).collect();
    let sheet = Sheet { outline, embedding: Embedding::Flat, places };
    let model = ElectrodeModel::Complete {
        width: vec![0.011; ELECTRODES],
        contact_impedance: vec![0.18; ELECTRODES],
    };
    let edges = EdgeLengths { skin: 0.0045, electrodes: 0.0045 };
    let mesh = generate(&sheet, &model, edges, Lattice::default())?;
    let found = quality(&mesh);
    println!("{} elements on {:.1} cm2", found.elements, found.area * 1e4);
    if let Some(file) = std::env::args().nth(1) {
        std::fs::write(file, export::msh(&mesh))?;
    }
    Ok(())
}
