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
use serde::Serialize;

/// Force and moment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Wrench {
    /// N
    pub force: [f64; 3],
    /// About a point that goes with it, N m.
    pub moment: [f64; 3],
}

/// A contact on a robot's link.
#[derive(Clone, Debug, PartialEq)]
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
