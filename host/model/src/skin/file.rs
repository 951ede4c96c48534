//! The skin file as a person writes it, in TOML; [`super::check`] turns it into a checked [`super::Description`].

use super::quantity::Quantity;
use serde::Deserialize;
use std::path::PathBuf;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    pub(super) name: String,
    /// For people; not used further.
    #[serde(default, rename = "description")]
    pub(super) _description: String,
    pub(super) shape: ShapeTable,
    pub(super) mesh: Option<MeshTable>,
    pub(super) material: MaterialTable,
    pub(super) electrodes: ElectrodeTable,
    pub(super) drive: DriveTable,
    pub(super) inverse: InverseTable,
    pub(super) image: ImageTable,
    pub(super) contact: ContactTable,
    #[serde(default)]
    pub(super) calibration: CalibrationTable,
    #[serde(default)]
    pub(super) reflexes: Vec<ReflexTable>,
    pub(super) pose: Option<PoseTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ShapeTable {
    pub(super) kind: String,
    pub(super) diameter: Option<Quantity>,
    pub(super) radius: Option<Quantity>,
    pub(super) diameter_bottom: Option<Quantity>,
    pub(super) diameter_top: Option<Quantity>,
    pub(super) width: Option<Quantity>,
    pub(super) height: Option<Quantity>,
    pub(super) angle: Option<Quantity>,
    pub(super) points: Option<Corners>,
    pub(super) holes: Option<Vec<Corners>>,
    pub(super) file: Option<PathBuf>,
    pub(super) unit: Option<String>,
    pub(super) weld: Option<f64>,
    pub(super) allow_cracks: Option<bool>,
}

/// Corners of a polygon, one a row.
pub(super) type Corners = Vec<Exactly<Quantity, 2>>;

/// A list of exactly `N` values. Reading TOML into an array alone would leave out what is too many.
#[derive(Deserialize)]
#[serde(try_from = "Vec<T>")]
pub(super) struct Exactly<T, const N: usize>(pub(super) [T; N]);

impl<T, const N: usize> TryFrom<Vec<T>> for Exactly<T, N> {
    type Error = String;

    fn try_from(list: Vec<T>) -> Result<Self, String> {
        let count = list.len();
        list.try_into().map(Self).map_err(|_| format!("{count} values; allowed: {N}"))
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MeshTable {
    pub(super) edge_length: Quantity,
    pub(super) electrode_edge_length: Option<Quantity>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MaterialTable {
    pub(super) sheet_conductivity: Quantity,
    pub(super) sheet_conductivity_across: Option<Quantity>,
    pub(super) grain: Option<Quantity>,
    pub(super) conductivity_map: Option<MapTable>,
    pub(super) sheet_capacitance: Option<Quantity>,
}

/// Points in the skin file, coordinates and a number in each row, or the name of a CSV file.
#[derive(Deserialize)]
#[serde(untagged, expecting = "expected rows of coordinates and a number, or the name of a CSV file")]
pub(super) enum MapTable {
    Inline(Vec<Vec<Quantity>>),
    File(PathBuf),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ElectrodeTable {
    pub(super) count: i64,
    pub(super) placement: String,
    pub(super) pitch: Option<Quantity>,
    pub(super) positions: Option<Vec<Vec<Quantity>>>,
    pub(super) first: Option<Quantity>,
    pub(super) direction: Option<String>,
    pub(super) model: String,
    pub(super) width: Option<OneOrEach>,
    pub(super) contact_impedance: Option<OneOrEach>,
    #[serde(default = "one")]
    pub(super) ground: i64,
}

fn one() -> i64 {
    1
}

#[derive(Clone, Deserialize)]
#[serde(untagged, expecting = "expected a number, text with a unit such as \"11 mm\", or a list of them")]
pub(super) enum OneOrEach {
    One(Quantity),
    Each(Vec<Quantity>),
}

impl OneOrEach {
    /// What is written for one electrode.
    pub(super) fn of(&self, electrode: usize) -> Option<&Quantity> {
        match self {
            Self::One(quantity) => Some(quantity),
            Self::Each(each) => each.get(electrode),
        }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DriveTable {
    pub(super) pattern: String,
    #[serde(default)]
    pub(super) driven: Option<String>,
    pub(super) table: Option<StepTable>,
    pub(super) reciprocal: String,
    pub(super) frequency: Quantity,
    pub(super) amplitude: Quantity,
    pub(super) frame_rate: Quantity,
    pub(super) phase: Option<Quantity>,
    pub(super) settling: Option<f64>,
    pub(super) integration: Option<i64>,
    pub(super) gain: Option<NumberOrWord>,
    pub(super) component: Option<String>,
}

/// Steps in the skin file (electrodes from 1), or the name of a CSV file (electrodes from 0).
#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "expected rows of four whole numbers, drive plus, drive minus, sense plus and sense minus, or the \
                 name of a CSV file"
)]
pub(super) enum StepTable {
    Inline(Vec<Exactly<i64, 4>>),
    File(PathBuf),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct InverseTable {
    pub(super) method: Option<String>,
    pub(super) prior: Option<String>,
    pub(super) noser_exponent: Option<f64>,
    pub(super) gaussian_diameter: Option<f64>,
    pub(super) greit_radius: Option<f64>,
    pub(super) hyperparameter: NumberOrWord,
    pub(super) noise_figure: Option<f64>,
    pub(super) noise_db: Option<f64>,
    pub(super) normalised: bool,
    pub(super) weights: Option<WeightList>,
    pub(super) electrode_movement: Option<f64>,
}

/// A number, or the name of a criterion.
#[derive(Deserialize)]
#[serde(untagged, expecting = "expected a number or a word in quotes")]
pub(super) enum NumberOrWord {
    Number(f64),
    Word(String),
}

/// Weights in the skin file, or a rule, or the name of a CSV file.
#[derive(Deserialize)]
#[serde(untagged, expecting = "expected a list of numbers, a word in quotes, or the name of a CSV file")]
pub(super) enum WeightList {
    Each(Vec<f64>),
    Word(String),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ImageTable {
    pub(super) columns: Option<i64>,
    pub(super) pixels: Option<PixelCount>,
}

/// `"elements"`, or a number of patches.
#[derive(Deserialize)]
#[serde(untagged, expecting = "expected a whole number, or \"elements\"")]
pub(super) enum PixelCount {
    Count(i64),
    Word(String),
}

/// What contacts are found in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FoundIn {
    /// The image, from the threshold on.
    Image,
    /// The voltages, where they stand out from the noise that the board measures.
    #[default]
    Voltages,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ContactTable {
    pub(super) threshold: f64,
    #[serde(default)]
    pub(super) found_in: FoundIn,
    pub(super) false_alarms: Option<f64>,
    pub(super) averaging: Option<Quantity>,
    pub(super) drift_time: Option<Quantity>,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CalibrationTable {
    pub(super) strength: Vec<f64>,
    pub(super) pressure: Vec<Quantity>,
    pub(super) load_share: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ReflexTable {
    pub(super) name: String,
    pub(super) pin: i64,
    pub(super) force: Option<Quantity>,
    pub(super) strength: Option<f64>,
    pub(super) area: Option<Quantity>,
    pub(super) pressed_above: Option<f64>,
    pub(super) centre: Option<Vec<Quantity>>,
    pub(super) radius: Option<Quantity>,
    pub(super) release: Option<f64>,
    pub(super) frames: Option<i64>,
    pub(super) hold: Option<Quantity>,
    pub(super) when_blind: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PoseTable {
    pub(super) link: String,
    pub(super) position: Exactly<Quantity, 3>,
    pub(super) orientation: Exactly<f64, 4>,
}
