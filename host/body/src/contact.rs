//! Contact as robots want it: what iCub's `skinContact` holds, in the link's frame.
//!
//! The board gives centre of pressure, normal, pressure and force of each contact. How the force is spread, and so its
//! resultant on a curved skin, its moment and which pixels are active, follows from the image of the same frame: each
//! pixel takes its share by its conductivity change times its area, along its own normal.

use crate::placed::{PlacedSkin, square_distance};
use dermatome_shared::{
    contact::{Contact, Contacts},
    protocol::PackedImage,
};
use serde::{Deserialize, Serialize};

/// Force and moment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Wrench {
    /// N
    pub force: [f64; 3],
    /// About a point that goes with it, N m.
    pub moment: [f64; 3],
}

/// A contact on a robot's link.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SkinContact {
    /// As the board gives it, in the link's frame: centre of pressure, normal, area, pressure, identity, and how sure it is.
    pub contact: Contact,
    /// Area-weighted mean of its active pixels, m; the centre of pressure where there is no image.
    pub geometric_centre: [f64; 3],
    /// What it does to the link, about its centre of pressure; none on a skin whose calibration does not tell forces.
    pub wrench: Option<Wrench>,
    /// Pixels that it covers; none where there is no image.
    pub pixels: Vec<u16>,
}

impl SkinContact {
    /// What it does to the link, about the link's origin.
    #[must_use]
    pub fn on_link(&self) -> Option<Wrench> {
        let wrench = self.wrench?;
        let arm = cross(self.contact.position.map(f64::from), wrench.force);
        Some(Wrench { moment: add(wrench.moment, arm), ..wrench })
    }
}

impl Wrench {
    /// Both together, about the same point.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self { force: add(self.force, other.force), moment: add(self.moment, other.moment) }
    }
}

/// The contacts of a frame, `contacts` as the board gives them in the skin's frame, strongest first, with the image of the
/// same frame where there is one.
#[must_use]
pub fn on_link(skin: &PlacedSkin, contacts: &Contacts, image: Option<&PackedImage>) -> Vec<SkinContact> {
    let contacts: Vec<Contact> = contacts.iter().map(|contact| skin.pose.contact(contact)).collect();
    let image: Option<Vec<f64>> = image.map(|image| image.values().collect());
    let image = image.filter(|image| image.len() == skin.centres.len());
    let mut regions = image.as_ref().map(|image| regions(skin, &contacts, image)).unwrap_or_default();
    regions.resize(contacts.len(), Vec::new());
    let spread = |(contact, pixels): (Contact, Vec<u16>)| {
        let image = image.as_deref().unwrap_or_default();
        spread_over(skin, contact, pixels, image)
    };
    contacts.into_iter().zip(regions).map(spread).collect()
}

/// Pixels of each contact: those above a quarter of the image's largest value (thesis section 3.5.1) that hang together with
/// the pixel under it; of two contacts on the same ones, the nearer one's.
fn regions(skin: &PlacedSkin, contacts: &[Contact], image: &[f64]) -> Vec<Vec<u16>> {
    let level = image.iter().copied().fold(0.0, f64::max) / 4.0;
    let at = |contact: &Contact| contact.position.map(f64::from);
    let mut regions = vec![Vec::new(); contacts.len()];
    let mut is_taken = vec![level <= 0.0; image.len()];
    for contact in contacts {
        let Some(start) = skin.nearest(at(contact)) else { continue };
        let mut open = vec![start];
        while let Some(pixel) = open.pop() {
            if is_taken[pixel] || image[pixel] <= level {
                continue;
            }
            is_taken[pixel] = true;
            let distance = |other: &Contact| square_distance(at(other), skin.centres[pixel]);
            let nearest = contacts.iter().map(distance).enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
            if let Some((owner, _)) = nearest {
                regions[owner].push(pixel as u16);
            }
            open.extend(skin.neighbours(pixel));
        }
    }
    regions.iter_mut().for_each(|pixels| pixels.sort_unstable());
    regions
}

/// The contact with its force spread over these pixels.
fn spread_over(skin: &PlacedSkin, contact: Contact, pixels: Vec<u16>, image: &[f64]) -> SkinContact {
    let position = contact.position.map(f64::from);
    let shares: Vec<(usize, f64)> = pixels
        .iter()
        .map(|&pixel| usize::from(pixel))
        .map(|pixel| (pixel, image[pixel] * skin.areas[pixel]))
        .collect();
    let total: f64 = shares.iter().map(|(_, share)| share).sum();
    let area: f64 = shares.iter().map(|&(pixel, _)| skin.areas[pixel]).sum();
    let geometric_centre = if area > 0.0 {
        shares
            .iter()
            .fold([0.0; 3], |sum, &(pixel, _)| add(sum, scale(skin.centres[pixel], skin.areas[pixel] / area)))
    } else {
        position
    };
    // Whatever presses pushes against the outward normal.
    let pushed = |force: f32| {
        let force = f64::from(force);
        if total <= 0.0 {
            let force = scale(contact.normal.map(f64::from), -force);
            return Wrench { force, moment: [0.0; 3] };
        }
        shares.iter().fold(Wrench::default(), |sum, &(pixel, share)| {
            let force = scale(skin.normals[pixel], -force * share / total);
            let arm = add(skin.centres[pixel], scale(position, -1.0));
            sum.and(Wrench { force, moment: cross(arm, force) })
        })
    };
    SkinContact { wrench: contact.force().map(pushed), geometric_centre, pixels, contact }
}

fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|axis| a[axis] + b[axis])
}

fn scale(a: [f64; 3], by: f64) -> [f64; 3] {
    a.map(|value| value * by)
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::placed::PlacedSkin;
    use dermatome_link::{pose::Pose, tables::SurfaceTables};
    use dermatome_shared::surface::{Pixel, SurfaceScale};
    use proptest::prelude::*;

    const SIDE: usize = 7;

    /// A sheet of 7 x 7 pixels of 1 mm, round a cylinder about y of this radius where there is one.
    fn sheet(radius: Option<f64>, pose: &Pose) -> PlacedSkin {
        let step = 1e-6;
        let mut neighbours = Vec::new();
        let pixels: Vec<Pixel> = (0..SIDE * SIDE)
            .map(|pixel| {
                let (row, column) = (pixel / SIDE, pixel % SIDE);
                let near = |a: usize, b: usize| a.abs_diff(b);
                let touch = |&other: &usize| near(other / SIDE, row) + near(other % SIDE, column) == 1;
                neighbours.extend((0..SIDE * SIDE).filter(touch).map(|pixel| pixel as u16));
                let (along, y) = ((column as f64 - 3.0) * 1e-3, (row as f64 - 3.0) * 1e-3);
                let (centre, normal) = radius.map_or(([along, y, 0.0], [0.0, 0.0, 1.0]), |radius| {
                    let (sin, cos) = (along / radius).sin_cos();
                    ([radius * sin, y, radius * (cos - 1.0)], [sin, 0.0, cos])
                });
                Pixel {
                    centre: centre.map(|value| (value / step).round() as i16),
                    neighbours_end: neighbours.len() as u16,
                    normal: normal.map(|part: f64| (part * 127.0).round() as i8),
                    area: 1,
                }
            })
            .collect();
        let scale = SurfaceScale { origin: [0.0; 3], step: step as f32, area: 1e-6 };
        PlacedSkin::new(&SurfaceTables::of(scale, None, pixels, neighbours), pose)
    }

    fn on_palm() -> Pose {
        Pose { link: "palm".to_owned(), position: [0.0; 3], orientation: [0.0, 0.0, 0.0, 1.0] }
    }

    fn contact(position: [f32; 3], force: Option<f32>) -> Contact {
        Contact {
            position,
            normal: [0.0, 0.0, 1.0],
            area: 9e-6,
            strength: 0.5,
            peak: 1.0,
            pressure: force.map(|force| force / 9e-6),
            load_area: force.map(|_| 9e-6),
            evidence: None,
            identity: None,
        }
    }

    fn image(value: impl Fn(usize, usize) -> i16) -> PackedImage {
        PackedImage {
            exponent: 10,
            mantissas: (0..SIDE * SIDE).map(|pixel| value(pixel / SIDE, pixel % SIDE)).collect(),
        }
    }

    /// The middle nine pixels.
    fn middle(row: usize, column: usize) -> i16 {
        if row.abs_diff(3) <= 1 && column.abs_diff(3) <= 1 { 800 } else { 20 }
    }

    fn contacts(list: &[Contact]) -> Contacts {
        list.iter().copied().collect()
    }

    fn length(v: [f64; 3]) -> f64 {
        v.iter().map(|part| part * part).sum::<f64>().sqrt()
    }

    #[test]
    fn a_press_on_a_flat_skin_pushes_against_its_normal_without_a_moment() {
        let found = on_link(
            &sheet(None, &on_palm()),
            &contacts(&[contact([0.0; 3], Some(2.0))]),
            Some(&image(middle)),
        );
        let [found] = found.as_slice() else { panic!("{found:?}") };
        assert_eq!(found.pixels, [16, 17, 18, 23, 24, 25, 30, 31, 32]);
        let wrench = found.wrench.unwrap();
        assert!(
            length(add(wrench.force, [0.0, 0.0, 2.0])) < 1e-6 && length(wrench.moment) < 1e-9,
            "{wrench:?}"
        );
        assert!(length(found.geometric_centre) < 1e-9, "{found:?}");
    }

    #[test]
    fn a_press_round_a_cylinder_loses_what_its_sides_push_against_each_other() {
        let found = on_link(
            &sheet(Some(2e-3), &on_palm()),
            &contacts(&[contact([0.0; 3], Some(2.0))]),
            Some(&image(middle)),
        );
        let force = found[0].wrench.unwrap().force;
        // A third each at -0.5, 0 and 0.5 rad.
        let expected = 2.0 * (1.0 + 2.0 * 0.5_f64.cos()) / 3.0;
        assert!(force[0].abs() < 0.01 && (force[2] + expected).abs() < 0.01, "{force:?}");
    }

    #[test]
    fn a_press_beside_its_centre_of_pressure_turns_the_link() {
        let beside = contact([1e-3, 0.0, 0.0], Some(2.0));
        let found = on_link(&sheet(None, &on_palm()), &contacts(&[beside]), Some(&image(middle)));
        let wrench = found[0].wrench.unwrap();
        // 2 N down, 1 mm towards -x of the centre: r x F = (-1e-3, 0, 0) x (0, 0, -2) = (0, -2e-3, 0).
        assert!(length(add(wrench.moment, [0.0, 2e-3, 0.0])) < 1e-8, "{wrench:?}");
        assert!(length(found[0].on_link().unwrap().moment) < 1e-8, "it acts at the origin");
    }

    #[test]
    fn contacts_on_the_same_pixels_share_them_by_distance_and_others_stay_out() {
        let ridge = |row: usize, column: usize| match (row, column) {
            (3, 0..=2) => 900,
            (3, 3) => 400,
            (3, 4..=6) => 800,
            // An island that no contact is of.
            (0, 0) => 700,
            _ => 0,
        };
        let both = [contact([-2e-3, 0.0, 0.0], None), contact([2e-3, 0.0, 0.0], None)];
        let found = on_link(&sheet(None, &on_palm()), &contacts(&both), Some(&image(ridge)));
        let row = 3 * SIDE as u16;
        assert_eq!(found[0].pixels[..3], [row, row + 1, row + 2]);
        assert_eq!(found[1].pixels[found[1].pixels.len() - 3..], [row + 4, row + 5, row + 6]);
        assert_eq!(found[0].pixels.len() + found[1].pixels.len(), 7);
        assert!(found.iter().all(|contact| contact.wrench.is_none()));
    }

    #[test]
    fn without_an_image_the_board_s_own_numbers_remain() {
        let skin = sheet(None, &on_palm());
        for image in [None, Some(PackedImage { exponent: 10, mantissas: [1, 2, 3].into_iter().collect() })] {
            let found = on_link(&skin, &contacts(&[contact([1e-3, 0.0, 0.0], Some(2.0))]), image.as_ref());
            assert!(found[0].pixels.is_empty());
            assert!(length(add(found[0].geometric_centre, [-1e-3, 0.0, 0.0])) < 1e-9);
            assert_eq!(found[0].wrench.unwrap().force, [0.0, 0.0, -2.0]);
        }
    }

    proptest! {
        /// Wherever the skin lies and whatever its image, the resultant is that of the pixels' forces.
        #[test]
        fn the_wrench_on_the_link_is_the_sum_over_the_pixels(
            values in prop::collection::vec(-100_i16..1000, SIDE * SIDE),
            x in -3e-3_f32..3e-3,
            y in -3e-3_f32..3e-3,
            radius in 3e-3..0.1,
            turn in -3.0..3.0,
            position in prop::array::uniform3(-0.5..0.5),
        ) {
            let (sin, cos) = (f64::sin(turn / 2.0), f64::cos(turn / 2.0));
            let pose = Pose { position, orientation: [0.6 * sin, 0.0, 0.8 * sin, cos], ..on_palm() };
            let skin = sheet(Some(radius), &pose);
            let image = PackedImage { exponent: 10, mantissas: values.as_slice().try_into().unwrap() };
            let found = on_link(&skin, &contacts(&[contact([x, y, 0.0], Some(2.0))]), Some(&image));
            let wrench = found[0].on_link().unwrap();
            prop_assert!(length(wrench.force) <= 2.0 + 1e-6);
            if !found[0].pixels.is_empty() {
                let weight = |pixel: usize| f64::from(values[pixel]);
                let all: f64 = found[0].pixels.iter().map(|&pixel| weight(usize::from(pixel))).sum();
                let moment = found[0].pixels.iter().map(|&pixel| usize::from(pixel)).fold([0.0; 3], |sum, pixel| {
                    let force = scale(skin.normals[pixel], -2.0 * weight(pixel) / all);
                    add(sum, cross(skin.centres[pixel], force))
                });
                // The skin's places are whole micrometres, the contact's single precision.
                prop_assert!(length(add(moment, scale(wrench.moment, -1.0))) < 1e-6, "{moment:?} {wrench:?}");
            }
        }
    }
}
