//! Reflexes: what the rules of a patch read of fingers on a simulated skin, by the board's own code.

use dermatome::{
    simulate::{
        Noise, Press,
        rig::{Observer, Rig},
    },
    skin::{Reflex, Region, Skin},
};
use dermatome_shared::{patch::reflexes::Limit, pipeline::reflex::Watch};
use nalgebra::Point3;
use std::path::Path;

/// A board that watches a skin by one rule.
struct Watched {
    rig: Rig,
    watch: Watch,
    /// Radius of the standard press, m.
    radius: f64,
    time_us: u64,
}

/// With where its pixels lie.
fn watched(name: &str, region: Region, seed: u64) -> (Watched, Vec<Point3<f64>>) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models").join(name).join("skin.toml");
    let mut skin = Skin::load(&file).unwrap().made().unwrap();
    let rule = |limit| Reflex {
        name: "rule".to_owned(),
        pin: 1,
        limit,
        region,
        release: 0.8,
        frames: 1,
        hold: 0.0,
        trips_blind: true,
    };
    skin.reflexes = vec![rule(Limit::Strength(0.3))];
    let mut observer = Observer::new(&skin).unwrap();
    let mut rig = Rig::new(&skin, &observer.patch(), Noise { snr_db: 60.0, seed }).unwrap();
    let untouched: Vec<_> = (0..20).map(|_| rig.press(&[])).collect();
    observer.tare(&untouched);
    let state = observer.observe(&rig.press(&[])).clone();
    let mut watch = Watch::new();
    watch.begin(Some(&observer.patch()));
    (0..=observer.patch().reflex_rows().count()).for_each(|_| watch.brief(&observer.patch(), &state));
    let radius = f64::from(observer.patch().header.detection.radius);
    let centres = observer.model().pixels.centres.clone();
    (Watched { rig, watch, radius, time_us: 0 }, centres)
}

impl Watched {
    /// What the rule reads of a finger of so many radii of the standard press, in parts of its load.
    fn reads(&mut self, place: &Point3<f64>, radii: f64, depth: f64) -> f64 {
        let radius = radii * self.radius;
        let frame = self.rig.press(&[Press::finger([place.x, place.y], radius, depth)]);
        self.time_us += 2_500;
        let reflexes = self.watch.see(&frame, self.time_us);
        assert!(!reflexes.is_blind);
        // Under a round tip the mean is two thirds of the most.
        let load = 2.0 / 3.0 * depth * radii * radii;
        f64::from(reflexes.values[0]) / load
    }
}

/// Worst of what fingers read inside and outside a region, over places that are so far from its edge.
fn worst(name: &str, region: Region, seed: u64, radii: f64, depth: f64) -> [f64; 3] {
    let (mut watched, centres) = watched(name, region, seed);
    let margin = 4.0 * watched.radius;
    let (mut least, mut most, mut outside) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
    let mut count = 0;
    for place in centres.iter().skip(3).step_by(13) {
        let beyond = region.beyond(place);
        if beyond > 0.0 && beyond < margin {
            continue;
        }
        let read = watched.reads(place, radii, depth);
        if beyond <= 0.0 {
            (least, most) = (least.min(read), most.max(read));
        } else {
            outside = outside.max(read);
        }
        count += 1;
    }
    eprintln!(
        "{name}, {region:?}, {radii} radii, {depth}: {least:.2} to {most:.2}, outside {outside:.2}, {count} places"
    );
    [least, most, outside]
}

fn around(x: f64, y: f64, z: f64, radius: f64) -> Region {
    Region::Around { centre: Point3::new(x, y, z), radius }
}

/// The linear model and one frame's noise at 60 dB: fingers of the standard size, and wider ones, press firmly.
#[test]
fn a_rule_reads_a_finger_in_its_region_and_less_than_half_of_one_outside() {
    for (name, region, [least, most]) in [
        ("disc-210mm", Region::Whole, [0.2, 1.5]),
        ("disc-210mm", around(0.02, -0.01, 0.0, 0.04), [0.4, 1.2]),
        ("disc-210mm", around(-0.07, 0.03, 0.0, 0.03), [0.4, 1.2]),
        ("square-210mm", around(0.05, 0.05, 0.0, 0.05), [0.4, 1.2]),
        ("square-50mm", around(0.0, 0.01, 0.0, 0.012), [0.4, 1.2]),
        ("hemisphere-120mm", Region::Whole, [0.2, 2.5]),
    ] {
        for (radii, depth) in [(1.0, 0.9), (1.5, 0.6)] {
            let [low, high, outside] = worst(name, region, 4242, radii, depth);
            assert!(low >= least && high <= most, "{name}, {region:?}: {low} to {high}");
            assert!(outside <= 0.5, "{name}, {region:?}: {outside}");
        }
    }
}
