//! What commands write: none of it takes the place of a file that the command reads, of another output, or of a file
//! that is there and holds something else.
//!
//! An argument of the type [`Output`] or [`Folder`] is written, one of the type `PathBuf` or `OsString` is read.
//! That is all that [`check`] has to know of a command.

use anyhow::{bail, ensure};
use clap::{
    Arg, ArgMatches, Command,
    builder::{PathBufValueParser, TypedValueParser},
};
use dermatome_frames::{array::Source, calibrate::TAKEN_IN};
use dermatome_geometry::mesh::export::IN_METRES;
use dermatome_patch::{input, output::check_folder};
use dermatome_recording::read::file_and_patch;
use dermatome_shared::patch;
use dermatome_simulate::port::Port;
use std::{
    ffi::OsString,
    fs::File,
    io::Read,
    ops::Deref,
    path::{Path, PathBuf},
};

/// What an output holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Patch,
    Json,
    Png,
    Svg,
    /// As NumPy writes them, or in a column of CSV.
    Voltages,
    /// Of a calibration, as CSV.
    Readings,
    /// An archive of arrays.
    Presses,
    /// Of a board, which is not to be had again.
    Recording,
    /// Of a skin, on a robot.
    Mesh,
    /// Written by people, so that none that is there is ever replaced unasked.
    Skin,
    /// The same.
    Robot,
}

impl Kind {
    /// Reads an argument as the name of such a file.
    pub(super) fn parser(self) -> impl TypedValueParser<Value = Output> {
        PathBufValueParser::new().try_map(move |path| {
            if path == Path::new("-") {
                return Err("`-` is no file here; allowed: a file (/dev/stdout for standard output)");
            }
            Ok(Output { path, kind: self })
        })
    }

    fn name(self) -> &'static str {
        match self {
            Self::Patch => "a patch",
            Self::Json => "a report in JSON",
            Self::Png => "a PNG picture",
            Self::Svg => "an SVG drawing",
            Self::Voltages => "voltages",
            Self::Readings => "readings",
            Self::Presses => "an archive of presses",
            Self::Recording => "a recording",
            Self::Mesh => "a skin's mesh",
            Self::Skin => "a skin file",
            Self::Robot => "a robot's description",
        }
    }

    /// Whether a file that begins so may be one of this kind.
    fn begins(self, bytes: &[u8]) -> bool {
        let beginnings: &[&[u8]] = match self {
            Self::Patch => &[&patch::MAGIC],
            Self::Json => &[b"{"],
            Self::Png => &[b"\x89PNG"],
            Self::Svg => &[b"<svg", b"<?xml"],
            Self::Voltages => &[b"\x93NUMPY", b"voltage\n"],
            Self::Readings => &[b"pressure_kpa,strength", TAKEN_IN.as_bytes()],
            Self::Presses => &[b"PK\x03\x04"],
            Self::Mesh => &[IN_METRES.as_bytes()],
            Self::Recording | Self::Skin | Self::Robot => &[],
        };
        beginnings.iter().any(|beginning| bytes.starts_with(beginning))
    }

    /// Whether a file of this kind may be written to `path`: there is none, it is empty, of this kind, or no ordinary
    /// file.
    fn may_replace(self, path: &Path) -> bool {
        if !path.is_file() {
            return true;
        }
        let mut bytes = Vec::new();
        let read = File::open(path).and_then(|file| file.take(64).read_to_end(&mut bytes));
        // What cannot be read tells why when it is written.
        read.is_err() || bytes.is_empty() || self.begins(&bytes)
    }
}

/// A file to write.
#[derive(Clone, Debug)]
pub(super) struct Output {
    path: PathBuf,
    kind: Kind,
}

impl Deref for Output {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.path
    }
}

/// A folder to write to.
#[derive(Clone, Debug)]
pub(super) struct Folder {
    path: PathBuf,
    /// Whether a file of this name is written there.
    writes: fn(&str) -> bool,
    /// The file that shows that the others were written before by the same command, if there is one.
    mark: Option<&'static str>,
}

impl Folder {
    pub(super) fn parser(
        writes: fn(&str) -> bool,
        mark: Option<&'static str>,
    ) -> impl TypedValueParser<Value = Self> {
        PathBufValueParser::new().map(move |path| Self { path, writes, mark })
    }

    /// The files there that would be replaced.
    fn replaced(&self) -> Vec<PathBuf> {
        let entries = std::fs::read_dir(&self.path).into_iter().flatten().flatten();
        let ours = entries.filter(|entry| entry.file_name().to_str().is_some_and(self.writes));
        ours.map(|entry| entry.path()).filter(|path| path.is_file()).collect()
    }

    fn is_marked(&self) -> bool {
        self.mark.is_some_and(|mark| self.path.join(mark).is_file())
    }
}

impl Deref for Folder {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.path
    }
}

/// Patches and robots that are read and may be replaced by what becomes of them: the argument that is read, the one that
/// is written.
const UPDATED: [[&str; 2]; 3] = [["patch", "out"], ["preserve_calibration", "output"], ["robot", "output"]];

/// Checks what a command is to write by its arguments alone, before it does anything.
pub(super) fn check(command: &Command, matches: &ArgMatches) -> anyhow::Result<()> {
    if let Some((name, matches)) = matches.subcommand() {
        let command = command.find_subcommand(name).expect("clap found it");
        return check(command, matches);
    }
    let force = matches.get_flag("force");
    let inputs = inputs(command, matches);
    // They may be made later, for what is written there.
    let folders: Vec<&Path> = values::<Folder>(command, matches).map(|(_, folder)| &**folder).collect();
    let mut written: Vec<(String, &Path)> = Vec::new();
    for (arg, output) in values::<Output>(command, matches) {
        let name = shown(arg);
        let apart =
            |input: &&Input<'_>| !UPDATED.contains(&[input.arg.get_id().as_str(), arg.get_id().as_str()]);
        refuse_input(&name, output, inputs.iter().filter(apart))?;
        if let Some((other, _)) = written.iter().find(|(_, path)| will_be_same(path, output)) {
            bail!(
                "`{name}` and `{other}` are the same file `{}`; allowed: a file for each",
                output.display()
            );
        }
        ensure!(
            force || output.kind.may_replace(output),
            not_of_kind(&name, output, output.kind, "`--force`")
        );
        if !folders.iter().any(|folder| output.parent() == Some(folder)) {
            // What cannot be written is told now, and not after the work and beside what else was written.
            check_folder(output)?;
        }
        written.push((name, output));
    }
    for (arg, folder) in values::<Folder>(command, matches) {
        let replaced = folder.replaced();
        replaced.iter().try_for_each(|path| refuse_input(&shown(arg), path, inputs.iter()))?;
        if let Some(there) = replaced.first().filter(|_| !force && !folder.is_marked()) {
            bail!(
                "`{}` is there already; allowed: another `{}`, or `--force`, which replaces it",
                there.display(),
                shown(arg)
            );
        }
    }
    Ok(())
}

/// Where to write a patch that is named after its skin unless `--output` says otherwise.
pub(super) fn patch_file(given: Option<&Output>, skin: &str) -> anyhow::Result<PathBuf> {
    by_default("--output", given, format!("{skin}.dermatome"), Kind::Patch)
}

/// The file that was given, which [`check`] has seen, or `default`, which must not take the place of one of another
/// kind.
pub(super) fn by_default(
    name: &str,
    given: Option<&Output>,
    default: impl Into<PathBuf>,
    kind: Kind,
) -> anyhow::Result<PathBuf> {
    let Some(output) = given else {
        let path = default.into();
        ensure!(kind.may_replace(&path), not_of_kind(name, &path, kind, "to remove that file"));
        return Ok(path);
    };
    Ok(output.path.clone())
}

fn not_of_kind(name: &str, path: &Path, kind: Kind, or: &str) -> String {
    let (file, what) = (path.display(), kind.name());
    let why = if matches!(kind, Kind::Skin | Kind::Robot | Kind::Recording) {
        "is there already"
    } else {
        "is there, and holds something else"
    };
    format!("`{name}` writes {what}, but `{file}` {why}; allowed: another `{name}`, or {or}")
}

/// A file that is read, and the argument that leads to it.
struct Input<'a> {
    arg: &'a Arg,
    path: PathBuf,
}

fn refuse_input<'a>(
    name: &str,
    output: &Path,
    mut inputs: impl Iterator<Item = &'a Input<'a>>,
) -> anyhow::Result<()> {
    let Some(input) = inputs.find(|input| is_same(&input.path, output)) else { return Ok(()) };
    bail!(
        "`{name}` would overwrite `{}`, which `{}` reads; allowed: a file that is no input",
        output.display(),
        shown(input.arg)
    )
}

/// All files that a command reads, and those that they name.
fn inputs<'a>(command: &'a Command, matches: &'a ArgMatches) -> Vec<Input<'a>> {
    let paths = values::<PathBuf>(command, matches).map(|(arg, path)| (arg, path.clone()));
    let sources = values::<OsString>(command, matches).map(|(arg, text)| (arg, Source::new(text).path));
    let skins = values::<Port>(command, matches).filter_map(|(arg, port)| match port {
        Port::Simulated(file) | Port::Recorded(file) => Some((arg, file.clone())),
        Port::Board(_) => None,
    });
    // Of a recording of several skins, the one stands behind its name.
    let given = paths.chain(sources).chain(skins).map(|(arg, path)| (arg, file_and_patch(&path).0));
    let with_named = given.flat_map(|(arg, path)| {
        let named = named_in(&path);
        std::iter::once(path).chain(named).map(move |path| Input { arg, path })
    });
    with_named.collect()
}

/// Files that a TOML file names, relative to its own folder: a skin's mesh, tables, weights; a body's skins, and recordings
/// that it plays.
fn named_in(path: &Path) -> Vec<PathBuf> {
    let is_table = path.extension().is_some_and(|ending| ending == "toml");
    if !is_table || !path.is_file() {
        return Vec::new();
    }
    // What cannot be read tells why when the command reads it.
    let text = input::read_text(path).unwrap_or_default();
    let Ok(table) = text.parse::<toml_edit::DocumentMut>() else { return Vec::new() };
    let folder = path.parent().unwrap_or(Path::new(""));
    let file = |text: &str| match text.parse() {
        Ok(Port::Simulated(file) | Port::Recorded(file)) => folder.join(file_and_patch(&file).0),
        Ok(Port::Board(_)) | Err(_) => folder.join(text),
    };
    strings(table.as_item()).map(file).filter(|file| file.is_file()).collect()
}

/// The strings of a table and of the tables in it.
fn strings(item: &toml_edit::Item) -> Box<dyn Iterator<Item = &str> + '_> {
    if let Some(table) = item.as_table_like() {
        return Box::new(table.iter().flat_map(|(_, item)| strings(item)));
    }
    match item.as_array_of_tables() {
        Some(tables) => {
            Box::new(tables.iter().flat_map(|table| table.iter().flat_map(|(_, item)| strings(item))))
        }
        None => Box::new(item.as_str().into_iter()),
    }
}

/// The values of the arguments of one type.
fn values<'a, T: Clone + Send + Sync + 'static>(
    command: &'a Command,
    matches: &'a ArgMatches,
) -> impl Iterator<Item = (&'a Arg, &'a T)> {
    command.get_arguments().flat_map(move |arg| {
        // Of another type, or none.
        let values = matches.try_get_many::<T>(arg.get_id().as_str()).ok().flatten();
        values.into_iter().flatten().map(move |value| (arg, value))
    })
}

/// An argument as its command's help names it.
fn shown(arg: &Arg) -> String {
    let value = || arg.get_value_names().and_then(<[_]>::first).map_or("FILE", |name| name.as_str());
    arg.get_long().map_or_else(|| value().to_owned(), |long| format!("--{long}"))
}

/// Whether two paths lead to one ordinary file that is there.
fn is_same(a: &Path, b: &Path) -> bool {
    a.is_file() && same_file::is_same_file(a, b).unwrap_or(false)
}

/// Whether two outputs become one ordinary file.
fn will_be_same(a: &Path, b: &Path) -> bool {
    let is_ordinary = |path: &Path| !path.exists() || path.is_file();
    let place = |path: &Path| std::path::absolute(path).ok();
    is_ordinary(a) && is_ordinary(b) && (is_same(a, b) || in_one_folder(a, b).unwrap_or(place(a) == place(b)))
}

/// Whether both have one name in one folder; none where a folder is not there.
fn in_one_folder(a: &Path, b: &Path) -> Option<bool> {
    let folder = |path: &Path| std::path::absolute(path).ok()?.parent()?.canonicalize().ok();
    Some(folder(a)? == folder(b)? && a.file_name() == b.file_name())
}
