//! Look: what the page shows of a skin that its patch does not hold.

use super::Args;
use crate::commands::link_frame;
use anyhow::Context;
use dermatome_geometry::mesh::{Lattice, import};
use dermatome_link::pose::Pose;
use dermatome_messages::skin::{Look, Triangles};
use dermatome_model::{
    model::mesh,
    skin::{Description, Skin},
};
use dermatome_patch::tables::SurfaceTables;
use dermatome_recording::{read::Recording, session::Session};
use dermatome_shared::patch::PatchView;
use dermatome_simulate::port::Port;
use std::path::{Path, PathBuf};

/// Where it is known from.
pub(in crate::commands) struct Source {
    /// The skin file, with its name.
    skin: Option<(PathBuf, Skin)>,
    /// Whether somebody gave it, so that it must fit.
    is_given: bool,
    link: Option<Triangles>,
}

impl Source {
    /// By the arguments: the skin file that is given, or that of a board that is simulated or replayed.
    pub(super) fn of(args: &Args) -> anyhow::Result<Self> {
        let skin = match (&args.skin, &args.port) {
            (Some(path), _) | (None, Some(Port::Simulated(path))) => {
                Some((path.clone(), Skin::load(path)?.made()?))
            }
            (None, Some(Port::Recorded(path))) => of_recording(path),
            _ => None,
        };
        let link = args.link_mesh.as_deref().map(|path| link_mesh(path, args)).transpose()?;
        Ok(Self { skin, is_given: args.skin.is_some(), link })
    }

    /// For a skin file that is known.
    pub(in crate::commands) fn of_skin(path: &Path, skin: Skin) -> Self {
        Self { skin: Some((path.to_owned(), skin)), is_given: false, link: None }
    }

    /// Text of the skin file, for recordings.
    pub(super) fn text(&self) -> Option<String> {
        let (path, _) = self.skin.as_ref()?;
        std::fs::read_to_string(path).ok()
    }

    /// Of the skin of a session's patch: where it lies, and what it looks like.
    pub(in crate::commands) fn on(&self, session: &Session) -> anyhow::Result<(Option<Pose>, Look)> {
        let Some((path, skin)) = &self.skin else { return Ok((None, Look::default())) };
        let patch = PatchView::validate(&session.patch).context("the board's patch")?;
        let pixels = || Ok(SurfaceTables::read(&patch));
        match link_frame::check(path, skin, &patch.header.skin, pixels) {
            Err(error) if self.is_given => return Err(error),
            Err(_) => return Ok((None, Look::default())),
            Ok(()) => {}
        }
        Ok((skin.pose.clone(), Look { link: self.link.clone(), ..look_of(skin)? }))
    }
}

/// What a skin looks like, by its file.
pub(in crate::commands) fn look_of(skin: &Skin) -> anyhow::Result<Look> {
    let mesh = mesh(skin, 1.0, Lattice::default())?;
    let corner = |node: &usize| *node as u32;
    let surface = Triangles {
        vertices: mesh.nodes.iter().map(|node| [node.x, node.y, node.z]).collect(),
        triangles: mesh.elements.iter().map(|element| element.each_ref().map(corner)).collect(),
    };
    let electrodes = skin.shape.electrode_centres().iter().map(|at| [at.x, at.y, at.z]).collect();
    Ok(Look { surface: Some(surface), electrodes, link: None })
}

/// The skin file in a recording; none where it names files that are not there.
fn of_recording(path: &Path) -> Option<(PathBuf, Skin)> {
    let recording = Recording::open(path).ok()?;
    let text = recording.session().skin_file.clone()?;
    let name = PathBuf::from("skin.toml");
    let skin = Description::parse(&name, &text).ok()?.made().ok()?;
    Some((name, skin))
}

fn link_mesh(path: &Path, args: &Args) -> anyhow::Result<Triangles> {
    let mut mesh = import::read(path, None)?;
    let unit = args.unit.or(mesh.unit).with_context(|| {
        format!("`--unit` is missing: the unit of `{}`, which only a .dae tells itself", path.display())
    })?;
    mesh.scale(unit);
    let corner = |node: &usize| *node as u32;
    Ok(Triangles {
        vertices: mesh.nodes.iter().map(|node| [node.x, node.y, node.z]).collect(),
        triangles: mesh.triangles.iter().map(|triangle| triangle.each_ref().map(corner)).collect(),
    })
}
