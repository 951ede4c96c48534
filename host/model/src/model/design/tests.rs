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
fn a_hemisphere_hears_more_at_its_deafest_place_with_as_many_electrodes_as_proposed() {
    let before = skin(&HEMISPHERE.replace("count = 16", "count = 8"));
    let sought = Sought::finger(0.21, 60.0);
    let proposal = propose(&before, &Wanted { electrodes: 8, sought }, |_| ()).unwrap();
    assert_eq!(proposal.positions.len(), 8);
    assert!((1..8).contains(&proposal.on_rim), "{proposal:?}");
    let after = skin(&with(&proposal));
    let centres = after.shape.electrode_centres();
    for (a, centre) in centres.iter().enumerate() {
        // The search's mesh and the skin's are chords of the same half sphere.
        assert!((centre - proposal.positions[a]).norm() < 1e-3, "{centre} {:?}", proposal.positions[a]);
        assert!(centres[..a].iter().all(|other| (centre - other).norm() > 1.3 * 0.011), "{centre}");
    }
    let [before, after] = [before, after].map(|skin| {
        let found = Model::build(&skin, |_| ()).unwrap().detectability(&sought);
        println!("{:?}, median {:.1}", found.worst(), found.median());
        found.worst().unwrap().significance
    });
    assert!(after > 2.0 * before, "{before} {after}");
}

#[test]
fn what_no_board_takes_and_what_has_no_room_is_refused() {
    let sought = Sought::finger(0.21, 60.0);
    let of = |skin: &Skin, electrodes| propose(skin, &Wanted { electrodes, sought }, |_| ());
    let hemisphere = skin(HEMISPHERE);
    for electrodes in [0, 5, 17, 255] {
        assert_eq!(of(&hemisphere, electrodes), Err(DesignError::Count { electrodes }));
    }
    let wide =
        HEMISPHERE.replace("count = 16", "count = 4").replace("width = \"11 mm\"", "width = \"120 mm\"");
    assert_eq!(of(&skin(&wide), 16), Err(DesignError::NoRoom { electrodes: 16, width: 0.12 }));
}
