//! Why nothing can be cut, in the words of a [`super::Request`]. Lengths are in metres and shown in mm.

use crate::outline::PolygonError;
use nalgebra::Point3;

/// Why no cutout can be cut out of a link.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CutError {
    /// No triangle with an area.
    #[error("the link's mesh has no triangle with an area; allowed: at least one")]
    Empty,
    /// A node of the link that is not finite.
    #[error("node {node} of the link's mesh is not finite; allowed: numbers")]
    NotFinite {
        /// The first such node, from 0.
        node: usize,
    },
    /// A number that makes no sense.
    #[error("`{option}` is {value}; allowed: {allowed}")]
    Value {
        /// The option.
        option: &'static str,
        /// What it is.
        value: String,
        /// What it may be.
        allowed: String,
    },
    /// A point that is not on the link.
    #[error(
        "`around` is {}, {:.3} mm from the link's mesh, which spans {} to {}; allowed: at most {:.3} mm from it. \
         Is `unit` right?",
        Shown(*.point), distance * 1e3, Shown(*.low), Shown(*.high), allowed * 1e3
    )]
    Far {
        /// The point.
        point: Point3<f64>,
        /// How far it is from the mesh, m.
        distance: f64,
        /// How far it may be, m.
        allowed: f64,
        /// Lowest corner of the mesh's box.
        low: Point3<f64>,
        /// Highest corner.
        high: Point3<f64>,
    },
    /// The seed lies outside of what is to be cut.
    #[error("`around` lies on the link at {}, outside `{option}`; allowed: a point of the patch", Shown(*.at))]
    Outside {
        /// Which option says where to cut.
        option: &'static str,
        /// Where the point lies on the link.
        at: Point3<f64>,
    },
    /// Planes between which nothing of the link lies.
    #[error(
        "`between_planes` from {:.3} mm to {:.3} mm misses the link; allowed: planes that cut it, \
         which spans {:.3} mm to {:.3} mm along that normal", .asked[0] * 1e3, .asked[1] * 1e3,
        .spanned[0] * 1e3, .spanned[1] * 1e3
    )]
    PlanesMiss {
        /// Where the planes lie along their normal, m.
        asked: [f64; 2],
        /// Where the link lies, m.
        spanned: [f64; 2],
    },
    /// The polygon is none.
    #[error("`polygon`: {0}; allowed: sides that do not meet")]
    Polygon(PolygonError),
    /// The mesh ends inside the cutout.
    #[error(
        "the link's mesh has an opening inside the patch, {:.3} mm round, at {}; allowed: {allowed}. If it is no \
         opening of the link but a crack in the mesh, `weld` may close it",
        around * 1e3, Shown(*.at)
    )]
    Opening {
        /// A point of its edge.
        at: Point3<f64>,
        /// Length of its edge, m.
        around: f64,
        /// What would do.
        allowed: String,
    },
    /// The cutout is not a disc.
    #[error("the patch is no disc: {found}; allowed: a patch with one boundary{}", remedy(.found, *.largest))]
    NotADisc {
        /// What it is.
        found: Wrapped,
        /// The largest radius that would do, m.
        largest: Option<f64>,
    },
    /// The link's surface has only one side.
    #[error(
        "the link's mesh has only one side there, like a Moebius strip; allowed: a surface with two sides"
    )]
    OneSided,
}

/// What a cutout is that is no disc.
#[derive(Clone, Debug, PartialEq)]
pub enum Wrapped {
    /// It is all of a closed link.
    Closed,
    /// It has several boundaries: their lengths, m, the longest first.
    Boundaries(Vec<f64>),
    /// It has one boundary, which touches itself, or a handle.
    Handle,
}

impl std::fmt::Display for Wrapped {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Closed => write!(formatter, "it takes all of the link and has no boundary"),
            Self::Boundaries(lengths) => {
                let words: Vec<_> = lengths.iter().map(|length| format!("{:.1} mm", length * 1e3)).collect();
                write!(
                    formatter,
                    "it wraps round the link or has a hole, with boundaries of {}",
                    words.join(", ")
                )
            }
            Self::Handle => write!(formatter, "its boundary touches itself, or it has a handle"),
        }
    }
}

/// What to do about it.
fn remedy(found: &Wrapped, largest: Option<f64>) -> String {
    match (found, largest) {
        (_, Some(radius)) => format!(", here `radius` up to about {:.1} mm", radius * 1e3),
        (Wrapped::Boundaries(_), None) => {
            ". A ring round a limb becomes one if a second `between_planes` along the limb leaves \
             a gap in it, with planes beside the limb's axis, or if `polygon` is smaller"
                .to_owned()
        }
        (_, None) => String::new(),
    }
}

/// A point in mm.
struct Shown(Point3<f64>);

impl std::fmt::Display for Shown {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [x, y, z] = (self.0 * 1e3).coords.into();
        write!(formatter, "({x:.3}, {y:.3}, {z:.3}) mm")
    }
}
