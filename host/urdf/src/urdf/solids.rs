//! Solids that a link shows without a mesh file: boxes, cylinders and spheres, each turned from a profile.

use super::robot::{number, triple};
use crate::edit::{children, is};
use nalgebra::{Point3, Vector3};
use roxmltree::Node;
use std::f64::consts::{FRAC_PI_4, PI, TAU};

/// Sides of what is round.
const ROUND: usize = 32;

/// Triangles of a `geometry`, in its own frame, m; none where it is no solid, or not well-formed.
pub(super) fn triangles(geometry: Node<'_, '_>) -> Option<Vec<[Point3<f64>; 3]>> {
    let solid = geometry.children().find(Node::is_element)?;
    let length = |name: &str| number(solid, name);
    if is(solid, "box") && solid.has_attribute("size") {
        // A prism of four sides whose corners are at 1/2.
        let corner = 0.5_f64.sqrt();
        return Some(turned(
            &prism(corner, 1.0),
            4,
            FRAC_PI_4,
            Vector3::from(triple(solid, "size", 0.0).ok()?),
        ));
    }
    let profile = match solid.tag_name().name() {
        "cylinder" => prism(length("radius")?, length("length")?),
        "sphere" => ball(length("radius")?),
        _ => return None,
    };
    Some(turned(&profile, ROUND, 0.0, Vector3::repeat(1.0)))
}

/// The `geometry` of a part.
pub(super) fn geometry<'a, 'input: 'a>(part: Node<'a, 'input>) -> Option<Node<'a, 'input>> {
    children(part, "geometry").next()
}

/// Radius and height of each ring.
type Profile = Vec<[f64; 2]>;

fn prism(radius: f64, length: f64) -> Profile {
    [[0.0, -0.5], [1.0, -0.5], [1.0, 0.5], [0.0, 0.5]].map(|[r, z]| [r * radius, z * length]).to_vec()
}

fn ball(radius: f64) -> Profile {
    let steps = ROUND / 2;
    let angle = |step: usize| PI * step as f64 / steps as f64;
    (0..=steps).map(angle).map(|angle| [radius * angle.sin(), -radius * angle.cos()]).collect()
}

/// Turned about z, in so many sides of which the first corner is at an angle, then stretched.
fn turned(profile: &[[f64; 2]], sides: usize, first: f64, stretch: Vector3<f64>) -> Vec<[Point3<f64>; 3]> {
    let corner = |[radius, height]: [f64; 2], side: usize| {
        let angle = first + TAU * side as f64 / sides as f64;
        let place = Vector3::new(radius * angle.cos(), radius * angle.sin(), height);
        Point3::from(place.component_mul(&stretch))
    };
    let between = |pair: &[[f64; 2]]| {
        let [below, above] = [pair[0], pair[1]];
        let quad = move |side| {
            let [a, b] = [corner(below, side), corner(below, side + 1)];
            let [c, d] = [corner(above, side + 1), corner(above, side)];
            let lower = (below[0] > f64::EPSILON).then_some([a, b, c]);
            let upper = (above[0] > f64::EPSILON).then_some([a, c, d]);
            lower.into_iter().chain(upper)
        };
        (0..sides).flat_map(quad).collect::<Vec<_>>()
    };
    profile.windows(2).flat_map(between).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::edit::parse;

    fn of(solid: &str) -> Option<Vec<[Point3<f64>; 3]>> {
        let text = format!("<geometry>{solid}</geometry>");
        triangles(parse(&text).unwrap().root_element())
    }

    /// By the divergence theorem: right only where all triangles face outward.
    fn volume(triangles: &[[Point3<f64>; 3]]) -> f64 {
        triangles.iter().map(|[a, b, c]| a.coords.dot(&b.coords.cross(&c.coords)) / 6.0).sum()
    }

    #[test]
    fn solids_face_outward_and_have_their_volume() {
        let cuboid = of("<box size='0.1 0.2 0.4'/>").unwrap();
        assert!((volume(&cuboid) - 0.008).abs() < 1e-12, "{cuboid:?}");
        assert!(
            cuboid.iter().flatten().all(|corner| (corner.x.abs() - 0.05).abs() < 1e-12 || corner.x == 0.0)
        );
        let cylinder = volume(&of("<cylinder radius='0.1' length='0.5'/>").unwrap());
        assert!((cylinder / (PI * 0.01 * 0.5) - 1.0).abs() < 0.01, "{cylinder}");
        let sphere = volume(&of("<sphere radius='0.1'/>").unwrap());
        assert!((sphere / (4.0 / 3.0 * PI * 1e-3) - 1.0).abs() < 0.03, "{sphere}");
    }

    #[test]
    fn what_is_no_solid_or_not_well_formed_is_none() {
        for solid in [
            "",
            "<mesh filename='a.stl'/>",
            "<box/>",
            "<box size='1 2'/>",
            "<sphere radius='nan'/>",
            "<cylinder radius='1'/>",
        ] {
            assert_eq!(of(solid), None, "{solid}");
        }
    }
}
