//! The skin file of a patch that was cut out of a link.

use dermatome_geometry::cut::Cutout;
use dermatome_geometry::mesh::quality::quality;
use std::f64::consts::PI;

/// What the skin file names.
#[derive(Clone, Copy, Debug)]
pub(super) struct Names<'a> {
    /// The skin.
    pub(super) skin: &'a str,
    /// The link: the frame that the pose is in.
    pub(super) link: &'a str,
    /// The mesh file beside the skin file.
    pub(super) mesh: &'a str,
}

/// A patch whose area is this share of a flat disc's with the same boundary is round: a square's is 0.79.
const ROUND: f64 = 0.9;

/// Text of the skin file. What the mesh does not say is as in the shipped skins.
pub(super) fn skin_file(patch: &Cutout, names: Names<'_>) -> String {
    let place = patch.link_from_skin.translation.vector;
    let turn = patch.link_from_skin.rotation.coords;
    let found = quality(&patch.mesh);
    let image = if patch.flat {
        "columns = 24                      # square pixels, for the patch is flat"
    } else {
        "pixels = 800                      # patches of elements of about equal area"
    };
    let is_round = 4.0 * PI * found.area / patch.boundary.powi(2) > ROUND;
    let inverse = if is_round {
        "hyperparameter = 0.03             # larger is smoother
normalised = true"
    } else {
        "hyperparameter = 0.003            # larger is smoother
normalised = false                # the patch is not round: some untouched voltages may be too small to divide by"
    };
    format!(
        r#"# Cut out of {link} by `dermatome cut`. Change material, drive, inverse and contact to suit the fabric.
name = "{skin}"
description = "{electrodes} electrodes of {width:.2} mm on a boundary of {boundary:.1} mm, {area:.1} cm2 of {link}"

[shape]
kind = "mesh"
file = "{mesh}"
unit = "m"

[pose]                            # of this file's frame on the link
link = "{link}"
position = [{x:?}, {y:?}, {z:?}] # m
orientation = [{qx:?}, {qy:?}, {qz:?}, {qw:?}] # quaternion x, y, z, w

[material]
sheet_conductivity = "5.88 mS"    # assumed: 0.17 kohm per square, as models/disc-210mm

[electrodes]
count = {electrodes}
placement = "groups"              # the mesh holds them, from the top on clockwise as seen from outside
model = "complete"
contact_impedance = "0.1 ohm m"   # assumed
ground = 1

[drive]
pattern = "adjacent"
reciprocal = "combined"
frequency = "50 kHz"
amplitude = "1 mA"
frame_rate = "50 Hz"

[inverse]
prior = "laplace"
{inverse}

[image]
{image}

[contact]
threshold = 0.05                  # relative conductivity change; `build` prints the noise
"#,
        link = names.link,
        skin = names.skin,
        mesh = names.mesh,
        electrodes = patch.mesh.electrodes.len(),
        width = patch.width * 1e3,
        boundary = patch.boundary * 1e3,
        area = found.area * 1e4,
        x = place.x,
        y = place.y,
        z = place.z,
        qx = turn.x,
        qy = turn.y,
        qz = turn.z,
        qw = turn.w,
    )
}
