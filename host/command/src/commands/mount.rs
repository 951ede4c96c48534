//! A skin that is put on a robot: what `urdf add` and `mjcf add` have in common.

use super::{
    flags::in_flags,
    link_frame::on_link,
    outputs::{Kind, Output, by_default},
};
use anyhow::{Context, ensure};
use dermatome_geometry::mesh::{Lattice, Mesh, export::stl_in_metres};
use dermatome_model::{
    model::mesh,
    skin::{
        Pose, Skin,
        quantity::{LENGTH, Quantity},
    },
};
use dermatome_patch::{
    input,
    output::{check_folder, write_together},
};
use dermatome_urdf::{
    DescriptionError, Mount, Placed,
    slab::Surface,
    urdf::check::{Places, packages_of_ros},
};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// What sets the parameters that the library's errors name.
const FLAGS: [(&str, &str); 4] =
    [("`replace`", "`--replace`"), ("`name`", "`--name`"), ("`link`", "`--link`"), ("`body`", "`--body`")];

#[derive(clap::Args)]
pub(super) struct Options {
    /// Name of the skin on the robot, which no other has, and of its own frame [default: the name in the skin file, which is
    /// its frame in recordings too].
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// Thickness of the mesh, which lies on the link with its underside.
    #[arg(long, value_name = "LENGTH", default_value = "1 mm", allow_hyphen_values = true)]
    thickness: String,
    /// File of the skin's mesh, STL in metres [default: the skin's name on the robot, where that looks for it,
    /// or the file of the skin that is replaced].
    #[arg(long, value_name = "FILE", value_parser = Kind::Mesh.parser())]
    mesh: Option<Output>,
    /// How the robot names that file, such as package://arm_description/meshes/skin.stl [default: its relative path].
    #[arg(long, value_name = "URI")]
    mesh_uri: Option<String>,
    /// Write the robot with its skin there; without it the skin is added to ROBOT itself.
    #[arg(short, long, value_name = "FILE", value_parser = Kind::Robot.parser())]
    output: Option<Output>,
    /// Replace the skin of this name on the robot, and its mesh file where it lies.
    #[arg(long)]
    replace: bool,
}

/// A skin that is about to be put on a robot.
pub(super) struct Mounting {
    pub(super) skin: Skin,
    pub(super) pose: Pose,
    pub(super) frame: String,
    pub(super) on: String,
    pub(super) surface: Surface,
    pub(super) slab: Mesh,
    /// The slab as its file holds it.
    stl: Vec<u8>,
    pub(super) replace: bool,
    thickness: f64,
    /// The robot's own text.
    pub(super) text: String,
    out: PathBuf,
    mesh: PathBuf,
    uri: String,
}

/// What a format says of skins and mesh files.
pub(super) struct Format {
    /// In which folder, relative to its own, a robot's text looks for them.
    pub(super) folder: fn(&str) -> Result<Option<String>, DescriptionError>,
    /// How a skin lies on the robot.
    pub(super) placed: fn(&str, &str) -> Result<Option<Placed>, DescriptionError>,
}

/// What was put where; keys are documented in docs/cli.md.
#[derive(Serialize)]
pub(super) struct Report<'a> {
    skin: &'a str,
    frame: &'a str,
    link: &'a str,
    /// The link that the skin file names.
    link_of_file: &'a str,
    position_m: [f64; 3],
    orientation_xyzw: [f64; 4],
    thickness_mm: f64,
    triangles: usize,
    mesh_uri: &'a str,
    /// What a simulator that collides hulls adds to the skin; none where nobody asks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) bulge_mm: Option<f64>,
    files: [&'a Path; 2],
}

/// The text of a robot's file.
pub(super) fn read_robot(path: &Path) -> anyhow::Result<String> {
    input::read_text(path).with_context(|| format!("cannot read the robot `{}`", path.display()))
}

/// An error of a robot's file, in the words of the command.
pub(super) fn in_file(path: &Path, error: DescriptionError) -> anyhow::Error {
    in_flags(error, &FLAGS).context(format!("robot `{}`", path.display()))
}

impl Options {
    /// Reads robot and skin, and says where everything goes.
    pub(super) fn mounting(
        &self,
        robot: &Path,
        skin: &Path,
        on: Option<&str>,
        format: &Format,
    ) -> anyhow::Result<Mounting> {
        let thickness = self.thickness()?;
        let text = read_robot(robot)?;
        let folder = (format.folder)(&text).map_err(|error| in_file(robot, error))?;
        let out = self.output.as_deref().unwrap_or(robot).to_owned();
        ensure!(
            self.output.is_some() || is_ordinary(robot),
            "`{}` is no ordinary file, so the skin cannot be added to it; allowed: to write elsewhere, by `--output`",
            robot.display()
        );
        check_folder(&out)?;
        let (of_file, pose) = on_link(skin)?;
        let frame = self.name.as_deref().unwrap_or(&of_file.name).to_owned();
        ensure!(!frame.is_empty(), "`--name` is \"\"; allowed: a name");
        let replaced = if self.replace { (format.placed)(&text, &frame) } else { Ok(None) };
        let replaced = replaced.map_err(|error| in_file(robot, error))?;
        let (old_mesh, old_on) = replaced.map_or((None, None), |placed| (placed.mesh, placed.on));
        // Under other names than its file's a skin may be on several links, of which the file names one.
        let old_on = old_on.filter(|_| frame != of_file.name);
        let (mesh_path, uri) = self.mesh_of(&out, folder.as_deref().unwrap_or(""), &frame, old_mesh)?;
        let mesh = mesh(&of_file, 1.0, Lattice::default())
            .with_context(|| format!("skin file `{}`", skin.display()))?;
        let surface = Surface::of(&mesh);
        let slab = surface.slab(thickness);
        let stl = stl_in_metres(&slab);
        ensure!(
            self.replace || self.mesh.is_some() || !is_other(&mesh_path, &stl),
            "`--mesh` writes a skin's mesh, by default to `{0}`, but that is there, and is of another skin; allowed: `--mesh \
             FILE`, `--replace`, or to remove `{0}`",
            mesh_path.display()
        );
        Ok(Mounting {
            slab,
            stl,
            surface,
            on: on.map(str::to_owned).or(old_on).unwrap_or_else(|| pose.link.clone()),
            pose,
            frame,
            skin: of_file,
            replace: self.replace,
            thickness,
            text,
            out,
            mesh: mesh_path,
            uri,
        })
    }

    fn thickness(&self) -> anyhow::Result<f64> {
        let text = &self.thickness;
        let read = LENGTH.read(&Quantity::Text(text.clone()));
        read.filter(|length| *length > 0.0 && *length <= 0.1).with_context(|| {
            format!(
                "`--thickness` is {text:?}; allowed: a length above zero, at most 100 mm, with {}",
                LENGTH.units()
            )
        })
    }

    /// The mesh's file, and its name in the robot: those of the mesh that it replaces, if that is there.
    fn mesh_of(
        &self,
        robot: &Path,
        folder: &str,
        frame: &str,
        replaced: Option<String>,
    ) -> anyhow::Result<(PathBuf, String)> {
        ensure!(
            is_ordinary(robot) || self.mesh.is_some(),
            "`{}` is no ordinary file, beside which the mesh could lie; allowed: to say where, by `--mesh`",
            robot.display()
        );
        let base = robot.parent().unwrap_or(Path::new("")).join(folder);
        let name: String =
            frame.chars().map(|c| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '_' }).collect();
        let packages = packages_of_ros();
        let places = Places { folder: &base, packages: &packages };
        let replaced = replaced.filter(|_| self.mesh.is_none());
        let replaced = replaced.and_then(|uri| Some((places.find(&uri)?, uri)));
        let (default, old_uri) = replaced
            .map_or_else(|| (base.join(format!("{name}.stl")), None), |(path, uri)| (path, Some(uri)));
        let path = by_default("--mesh", self.mesh.as_ref(), default, Kind::Mesh)?;
        check_folder(&path)?;
        let uri = match (&self.mesh_uri, old_uri) {
            (Some(uri), _) => {
                ensure!(!uri.is_empty(), "`--mesh-uri` is \"\"; allowed: a path or a URI");
                uri.clone()
            }
            (None, Some(uri)) => uri,
            (None, None) => relative(&path, &base)?,
        };
        Ok((path, uri))
    }
}

/// Whether a path is that of an ordinary file, or of none yet. What /dev/stdin leads to may be one: another name for it.
fn is_ordinary(path: &Path) -> bool {
    let is_stream = ["/dev", "/proc"].iter().any(|folder| path.starts_with(folder));
    !is_stream && (path.is_file() || !path.exists())
}

/// Whether a file is there that holds something else.
fn is_other(path: &Path, content: &[u8]) -> bool {
    path.exists() && std::fs::read(path).ok().as_deref() != Some(content)
}

/// The path of a file from a folder on, or its whole path if it is not in there.
fn relative(path: &Path, base: &Path) -> anyhow::Result<String> {
    let absolute = |path: &Path| {
        std::path::absolute(path).with_context(|| format!("no such path: `{}`", path.display()))
    };
    let whole = absolute(path)?;
    let base = if base == Path::new("") { absolute(Path::new("."))? } else { absolute(base)? };
    Ok(whole.strip_prefix(&base).unwrap_or(&whole).to_string_lossy().into_owned())
}

impl Mounting {
    pub(super) fn mount(&self) -> Mount<'_> {
        Mount {
            skin: &self.skin.name,
            frame: &self.frame,
            on: &self.on,
            pose: &self.pose,
            mesh: &self.uri,
            frame_rate: self.skin.drive.frame_rate,
        }
    }

    /// Writes mesh and robot, both or none.
    pub(super) fn write(&self, robot: &str) -> anyhow::Result<()> {
        Ok(write_together(&[(&self.mesh, &self.stl), (&self.out, robot.as_bytes())])?)
    }

    pub(super) fn report(&self) -> Report<'_> {
        Report {
            skin: &self.skin.name,
            frame: &self.frame,
            link: &self.on,
            link_of_file: &self.pose.link,
            position_m: self.pose.position,
            orientation_xyzw: self.pose.orientation,
            thickness_mm: self.thickness * 1e3,
            triangles: self.slab.elements.len(),
            mesh_uri: &self.uri,
            bulge_mm: None,
            files: [&self.out, &self.mesh],
        }
    }
}

impl Report<'_> {
    pub(super) fn print(&self, kind: &str) {
        if self.link != self.link_of_file {
            eprintln!(
                "warning: the skin file says link = {:?}, so that is the frame of the contacts that commands give; to make it {:?}, write that there",
                self.link_of_file, self.link
            );
        }
        let [x, y, z] = self.position_m;
        say!("skin          {} lies on {kind} {}, its own frame is {}", self.skin, self.link, self.frame);
        say!("pose          xyz {x:.6} {y:.6} {z:.6} m in {}", self.link);
        say!(
            "mesh          {} triangles, {:.3} mm thick, {}",
            self.triangles,
            self.thickness_mm,
            self.mesh_uri
        );
        say!("written       {}, {}", self.files[0].display(), self.files[1].display());
    }
}
