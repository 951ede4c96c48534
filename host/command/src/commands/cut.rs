//! `dermatome cut`: a skin for a robot's link, cut out of the link's mesh.

use super::{
    JsonReport, cut_picture,
    flags::in_flags,
    outputs::{Folder, Kind, Output},
    skin_of_cutout::{Names, skin_file},
};
use anyhow::{Context, bail};
use dermatome_frames::recorded::statistics::median;
use dermatome_geometry::{
    cut::{self, Cutout, Cutter, Region, Request, Slab},
    mesh::{
        export,
        import::{self, Imported},
        quality::{Quality, quality},
        triangle,
    },
};
use dermatome_model::skin::{
    Skin, UNITS, is_frame_name, is_name,
    quantity::{LENGTH, Quantity},
};
use dermatome_patch::output::{check_folder, write_whole};
use nalgebra::{Point3, Vector3};
use serde::Serialize;
use std::{
    path::{Path, PathBuf},
    time::Instant,
};

/// File names in the folder that is written.
const SKIN: &str = "skin.toml";
const MESH: &str = "skin.msh";

/// Cut a skin out of the mesh of a robot's link.
///
/// Writes a folder with skin.toml, which holds the patch's pose on the link, and its mesh. The patch is
/// remeshed to even triangles, its boundary is smoothed, and electrodes lie along it at equal distances, the first
/// one at the top, clockwise as seen from outside. Numbers without a unit are in the unit of the link's mesh.
#[derive(clap::Args)]
#[command(group(clap::ArgGroup::new("region").required(true).args(["radius", "between_planes", "polygon"])))]
#[command(after_help = "Examples:
  dermatome cut forearm.stl --unit mm --around 0,-42,110 --radius 60 --out forearm-skin
  dermatome cut palm.obj --unit m --around 0,0,0.02 --polygon \"-30mm,-20mm,20mm 30mm,-20mm,20mm 0mm,40mm,20mm\" \\
      --electrodes 12 --width 4mm --out palm-skin --png palm.png
  dermatome cut forearm.stl --unit mm --around 0,-42,110 --between-planes 0,0,1,60,160 \\
      --between-planes 1,0,0,-30,30 --out strip
  dermatome evaluate forearm-skin/skin.toml")]
pub(super) struct Args {
    /// Mesh of the link: STL, OBJ, PLY, COLLADA .dae or Gmsh .msh, in the link's frame.
    #[arg(value_name = "LINK")]
    link: PathBuf,
    /// Unit of the link's mesh: m, cm, mm, um or inch; a .dae tells it itself.
    #[arg(long)]
    unit: Option<String>,
    /// A point of the patch, on the link or near it; there the patch's frame has its origin.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    around: String,
    /// Cut a disc: all that is no further from the point than this, over the surface.
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    radius: Option<String>,
    /// Cut what lies between two planes with this normal, at these distances from the link's origin along it;
    /// may be given several times.
    #[arg(long, value_name = "NX,NY,NZ,FROM,TO", allow_hyphen_values = true)]
    between_planes: Vec<String>,
    /// Cut what a cutter of this shape cuts that is pressed down along the polygon's normal; corners as one
    /// text, with spaces between.
    #[arg(long, value_name = "\"X,Y,Z X,Y,Z ...\"", allow_hyphen_values = true)]
    polygon: Option<String>,
    /// Direction on the link that is up as one looks onto the patch [default: z, or y where z points out].
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    up: Option<String>,
    /// Electrodes along the boundary, 4 to 250; boards take 16.
    #[arg(long, value_name = "COUNT", default_value_t = 16)]
    electrodes: usize,
    /// Rim that an electrode covers [default: a quarter of the distance between centres].
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    width: Option<String>,
    /// Edge length of the mesh [default: a third of the electrodes' width].
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    edge_length: Option<String>,
    /// Join vertices of the link closer than this share of its size [default: 1e-6 for STL, else none].
    #[arg(long, value_name = "SHARE", allow_hyphen_values = true)]
    weld: Option<f64>,
    /// Name of the skin [default: name of the folder].
    #[arg(long)]
    name: Option<String>,
    /// Name of the link's frame in the robot's description [default: name of the mesh file].
    #[arg(long, value_name = "NAME")]
    frame: Option<String>,
    /// Folder to write to; it is made if it is not there.
    #[arg(long, value_name = "DIR", value_parser = Folder::parser(|name| [SKIN, MESH].contains(&name), None))]
    out: Folder,
    /// Draw where on the link the skin lies, with its electrodes.
    #[arg(long, value_name = "FILE", value_parser = Kind::Png.parser())]
    png: Option<Output>,
    #[command(flatten)]
    json: JsonReport,
}

/// What `cut` tells; keys are documented in docs/cli.md.
#[derive(Serialize)]
struct Report {
    skin: String,
    link: Link,
    pose: Pose,
    rim_mm: f64,
    electrodes: usize,
    width_mm: f64,
    edge_length_mm: f64,
    deviation_mm: f64,
    flat: bool,
    mesh: Quality,
    median_smallest_angle_degrees: f64,
    read_seconds: f64,
    cut_seconds: f64,
    total_seconds: f64,
    files: [PathBuf; 2],
}

#[derive(Serialize)]
struct Link {
    frame: String,
    triangles: usize,
    shells: usize,
    low_mm: [f64; 3],
    high_mm: [f64; 3],
}

#[derive(Serialize)]
struct Pose {
    position_m: [f64; 3],
    orientation_xyzw: [f64; 4],
    rpy: [f64; 3],
}

/// What sets the parameters that the library's errors name.
const FLAGS: [(&str, &str); 10] = [
    ("`around`", "`--around`"),
    ("`between_planes`", "`--between-planes`"),
    ("`polygon`", "`--polygon`"),
    ("`radius`", "`--radius`"),
    ("`width`", "`--width`"),
    ("`edge_length`", "`--edge-length`"),
    ("`electrodes`", "`--electrodes`"),
    ("`up`", "`--up`"),
    ("`unit`", "`--unit`"),
    ("`weld`", "`--weld`"),
];

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let start = Instant::now();
    let (unit, mut link) = match args.unit()? {
        Some(unit) => (unit, None),
        None => {
            let link = args.read()?;
            (link.unit.with_context(|| args.refuse_unit("missing"))?, Some(link))
        }
    };
    let request = args.request(unit)?;
    let frame = named(args.frame.as_deref(), &args.link);
    anyhow::ensure!(
        is_frame_name(&frame),
        "`--frame` is {frame:?}; allowed: 1 to 64 letters, digits, \"-\", \"_\", \".\" or \"/\" (by default it is the name of the link's file)"
    );
    let name = named(args.name.as_deref(), &args.out);
    anyhow::ensure!(
        is_name(&name),
        "`--name` is {name:?}; allowed: 1 to 32 letters, digits, \"-\" or \"_\" (by default it is that of `--out`)"
    );
    let [skin, mesh] = [SKIN, MESH].map(|name| args.out.join(name));
    let mut link = link.take().map_or_else(|| args.read(), Ok)?;
    if let Some(own) = link.unit.filter(|own| (own / unit - 1.0).abs() > 1e-6) {
        bail!(
            "`--unit` is {unit} m, but that of `{}` is {own} m; allowed: the same, or no `--unit`",
            args.link.display()
        );
    }
    link.scale(unit);
    let read_seconds = start.elapsed().as_secs_f64();
    let cutting = Instant::now();
    let patch = cut::cut(&link, &request)
        .map_err(|error| in_flags(error, &FLAGS))
        .with_context(|| format!("link `{}`", args.link.display()))?;
    let cut_seconds = cutting.elapsed().as_secs_f64();
    let text = skin_file(&patch, Names { skin: &name, link: &frame, mesh: MESH });
    write(&[&skin, &mesh], &text, &patch)?;
    let seconds = [read_seconds, cut_seconds, start.elapsed().as_secs_f64()];
    let report = Report::new(name, &link, frame, &patch, seconds, [skin, mesh]);
    print(&report);
    if let Some(path) = &args.png {
        write_whole(path, &cut_picture::png(&report.skin, &report.link.frame, &link, &patch)?)?;
        say!("picture       {}", path.display());
    }
    args.json.write(&report)
}

impl Args {
    fn read(&self) -> anyhow::Result<Imported> {
        import::read(&self.link, self.weld).map_err(|error| in_flags(error, &FLAGS))
    }

    /// Metres in the unit of the link's mesh; none if only the file tells it.
    fn unit(&self) -> anyhow::Result<Option<f64>> {
        let Some(unit) = &self.unit else { return Ok(None) };
        let found = UNITS.iter().find(|(name, _)| name == unit);
        let metres = found.map(|(_, metres)| *metres);
        metres.map(Some).with_context(|| self.refuse_unit(&format!("{unit:?}")))
    }

    fn refuse_unit(&self, unit: &str) -> String {
        let names: Vec<_> = UNITS.iter().map(|(name, _)| *name).collect();
        format!(
            "`--unit` is {unit}; allowed: {}, the unit of `{}`, which only a .dae tells itself",
            names.join(", "),
            self.link.display()
        )
    }

    fn request(&self, unit: f64) -> anyhow::Result<Request> {
        let positive = |option: &str, text: &Option<String>| match text {
            Some(text) => positive_length(option, text, unit).map(Some),
            None => Ok(None),
        };
        Ok(Request {
            around: Point3::from(lengths("--around", &self.around, unit)?),
            region: self.region(positive("--radius", &self.radius)?, unit)?,
            up: self.up.as_deref().map(|text| numbers("--up", text)).transpose()?.map(Vector3::from),
            electrodes: self.electrodes,
            width: positive("--width", &self.width)?,
            edge_length: positive("--edge-length", &self.edge_length)?,
        })
    }

    fn region(&self, radius: Option<f64>, unit: f64) -> anyhow::Result<Region> {
        if let Some(radius) = radius {
            return Ok(Region::Disc { radius });
        }
        if let Some(text) = &self.polygon {
            let corners = text.split_whitespace().map(|it| Ok(Point3::from(lengths("--polygon", it, unit)?)));
            let corners = corners.collect::<anyhow::Result<Vec<_>>>()?;
            return Ok(Region::Polygon(Cutter::new(&corners).map_err(|error| in_flags(error, &FLAGS))?));
        }
        let slabs = self.between_planes.iter().map(|text| slab(text, unit));
        Ok(Region::Slabs(slabs.collect::<anyhow::Result<_>>()?))
    }
}

/// A name that was given, or that of a file or folder.
fn named(given: Option<&str>, path: &Path) -> String {
    let stem = || path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    given.map_or_else(stem, str::to_owned)
}

/// A length: without a unit it is in the link's.
fn length(option: &str, text: &str, unit: f64) -> anyhow::Result<f64> {
    let plain = text.trim().parse::<f64>().ok().map(|number| number * unit);
    let read = plain.or_else(|| LENGTH.read(&Quantity::Text(text.to_owned())));
    read.filter(|length| length.is_finite()).with_context(|| {
        format!(
            "`{option}` holds {text:?}; allowed: a number (in the unit of the link's mesh), or a number with {}",
            LENGTH.units()
        )
    })
}

fn positive_length(option: &str, text: &str, unit: f64) -> anyhow::Result<f64> {
    let length = length(option, text, unit)?;
    anyhow::ensure!(length > 0.0, "`{option}` is {text:?}; allowed: a length above zero");
    Ok(length)
}

/// Pieces between commas, as many as there have to be.
fn pieces<'a, const N: usize>(option: &str, text: &'a str) -> anyhow::Result<[&'a str; N]> {
    let pieces: Vec<_> = text.split(',').collect();
    let found = pieces.len();
    let sized = pieces.try_into().ok();
    sized
        .with_context(|| format!("`{option}` is {text:?}, {found} values; allowed: {N}, with commas between"))
}

fn lengths(option: &str, text: &str, unit: f64) -> anyhow::Result<[f64; 3]> {
    let [x, y, z] = pieces(option, text)?;
    Ok([length(option, x, unit)?, length(option, y, unit)?, length(option, z, unit)?])
}

fn numbers(option: &str, text: &str) -> anyhow::Result<[f64; 3]> {
    let [x, y, z] = pieces(option, text)?;
    // No unit: a direction.
    Ok([number(option, x)?, number(option, y)?, number(option, z)?])
}

fn number(option: &str, text: &str) -> anyhow::Result<f64> {
    let read = text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
    read.with_context(|| format!("`{option}` holds {text:?}; allowed: a number"))
}

fn slab(text: &str, unit: f64) -> anyhow::Result<Slab> {
    let option = "--between-planes";
    let [x, y, z, from, to] = pieces(option, text)?;
    let normal = Vector3::new(number(option, x)?, number(option, y)?, number(option, z)?);
    Slab::new(normal, length(option, from, unit)?, length(option, to, unit)?)
        .map_err(|error| in_flags(error, &FLAGS))
}

/// Checks the text as a skin file beside its mesh, then writes both, the mesh first: only the skin file
/// makes it a skin.
fn write([skin, mesh]: &[&PathBuf; 2], text: &str, patch: &Cutout) -> anyhow::Result<()> {
    let folder = skin.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder)
        .with_context(|| format!("cannot make the folder `{}`", folder.display()))?;
    check_folder(skin)?;
    let bytes = export::msh(&patch.mesh);
    let trial = tempfile::tempdir().context("cannot make a temporary folder")?;
    write_whole(&trial.path().join(MESH), &bytes)?;
    // Errors name fields; the path is that of the trial, and stands for the file that is not written.
    Skin::parse(&trial.path().join(SKIN), text).and_then(Skin::made).context("the patch makes no skin")?;
    write_whole(mesh, &bytes)?;
    Ok(write_whole(skin, text.as_bytes())?)
}

impl Report {
    fn new(
        skin: String,
        link: &Imported,
        frame: String,
        patch: &Cutout,
        [read_seconds, cut_seconds, total_seconds]: [f64; 3],
        files: [PathBuf; 2],
    ) -> Self {
        let [low, high] = cut::bounds(&link.nodes).map(|corner| (corner * 1e3).into());
        let place = patch.link_from_skin.translation.vector;
        let turn = patch.link_from_skin.rotation;
        let (roll, pitch, yaw) = turn.euler_angles();
        Self {
            skin,
            link: Link {
                frame,
                triangles: link.triangles.len(),
                shells: patch.shells,
                low_mm: low,
                high_mm: high,
            },
            pose: Pose {
                position_m: place.into(),
                orientation_xyzw: turn.coords.into(),
                rpy: [roll, pitch, yaw],
            },
            rim_mm: patch.boundary * 1e3,
            electrodes: patch.mesh.electrodes.len(),
            width_mm: patch.width * 1e3,
            edge_length_mm: patch.edge_length * 1e3,
            deviation_mm: patch.deviation * 1e3,
            flat: patch.flat,
            mesh: quality(&patch.mesh),
            median_smallest_angle_degrees: median_smallest_angle(patch),
            read_seconds,
            cut_seconds,
            total_seconds,
            files,
        }
    }
}

fn median_smallest_angle(patch: &Cutout) -> f64 {
    let corners = (0..patch.mesh.elements.len()).map(|element| patch.mesh.corners(element));
    median(corners.map(triangle::smallest_angle)).to_degrees()
}

fn print(report: &Report) {
    let Report { link, pose, mesh, .. } = report;
    let triple = |[x, y, z]: [f64; 3]| format!("({x:.1}, {y:.1}, {z:.1})");
    say!(
        "link          {}: {} triangles in {} shell{}, from {} to {} mm",
        link.frame,
        link.triangles,
        link.shells,
        if link.shells == 1 { "" } else { "s" },
        triple(link.low_mm),
        triple(link.high_mm)
    );
    say!(
        "patch         {}: {:.2} cm2, boundary {:.2} mm, {}",
        report.skin,
        mesh.area * 1e4,
        report.rim_mm,
        if report.flat { "flat" } else { "curved" }
    );
    let [x, y, z] = pose.position_m;
    let [roll, pitch, yaw] = pose.rpy;
    say!(
        "pose          xyz {x:.6} {y:.6} {z:.6} m, rpy {roll:.6} {pitch:.6} {yaw:.6} rad, in {}",
        link.frame
    );
    say!("electrodes    {} of {:.2} mm", report.electrodes, report.width_mm);
    say!(
        "mesh          {} elements, {} nodes, edges of {:.3} mm wanted, {:.3} to {:.3} mm found",
        mesh.elements,
        mesh.nodes,
        report.edge_length_mm,
        mesh.shortest_edge * 1e3,
        mesh.longest_edge * 1e3
    );
    say!(
        "angles        smallest {:.1} degrees, median of the triangles' smallest {:.1} degrees",
        mesh.smallest_angle_degrees,
        report.median_smallest_angle_degrees
    );
    say!("off the link  {:.4} mm at most", report.deviation_mm);
    say!(
        "time          {:.1} ms to read, {:.1} ms to cut, {:.1} ms in all",
        report.read_seconds * 1e3,
        report.cut_seconds * 1e3,
        report.total_seconds * 1e3
    );
    say!("written       {}, {}", report.files[0].display(), report.files[1].display());
}

/// Metres in a unit.
pub(super) fn metres(unit: &str) -> Result<f64, String> {
    let found = UNITS.iter().find(|(name, _)| *name == unit);
    let names = || UNITS.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
    found.map(|(_, metres)| *metres).ok_or_else(|| format!("allowed: {}", names()))
}
