use super::*;
use crate::model::Model;
use std::path::Path;

const HEMISPHERE: &str = include_str!("../../../../../models/hemisphere-210mm/formula.toml");

fn skin(text: &str) -> Skin {
    Skin::parse(Path::new("skin.toml"), text).unwrap().made().unwrap()
}

/// The hemisphere's skin file with other electrodes and pattern.
fn with(proposal: &Proposal) -> String {
    let rows: Vec<_> = proposal.positions.iter().map(|p| format!("[{}, {}, {}]", p.x, p.y, p.z)).collect();
    HEMISPHERE
        .replace(
            "placement = \"rim\" ",
            &format!("placement = \"points\"\npositions = [{}]\n#", rows.join(", ")),
        )
        .replace("first = ", "#")
        .replace("direction = ", "#")
        .replace("count = 16", &format!("count = {}", rows.len()))
        .replace("pattern = \"adjacent\"", &format!("pattern = \"skip-{}\"", proposal.distance - 1))
}

#[test]
fn a_hemisphere_hears_everywhere_with_the_electrodes_proposed() {
    let before = skin(HEMISPHERE);
    let sought = Sought::finger(0.21, 60.0);
    let start = std::time::Instant::now();
    let proposal = propose(&before, &Wanted { electrodes: 16, sought }, |_| ()).unwrap();
    println!("{} judged in {:?}, {}", proposal.judged, start.elapsed(), proposal.distance);
    for p in &proposal.positions {
        println!("{:.1} {:.1} {:.1}", p.x * 1e3, p.y * 1e3, p.z * 1e3);
    }
    let after = skin(&with(&proposal));
    let figures = [before, after].map(|skin| {
        let found = Model::build(&skin, |_| ()).unwrap().detectability(&sought);
        let least = found.worst().unwrap().significance;
        println!(
            "least {least:.1}, median {:.1}, place {:.2} mm",
            found.median(),
            found.worst_deviation() * 1e3
        );
        least
    });
    assert!(figures[1] > 3.0 * figures[0], "{figures:?}");
}
