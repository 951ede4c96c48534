//! A case: a command with something wrong in it, and what it must say.

use super::program::{Desk, Running, TINY, row, tiny_voltages};
use std::{
    collections::BTreeMap,
    fmt,
    path::Path,
    time::{Duration, Instant},
};

/// Longest that a refusal may take, on a busy machine.
pub(crate) const LIMIT: Duration = Duration::from_secs(30);

/// A command and how it must end.
#[derive(Clone, Debug)]
pub(crate) struct Case {
    pub(crate) arguments: Vec<String>,
    /// Files beside those that are always there.
    pub(crate) files: Vec<(String, Vec<u8>)>,
    pub(crate) end: End,
}

#[derive(Clone, Debug)]
pub(crate) enum End {
    /// Refused, and each of these words is in the message; `a|b` is one or the other.
    Refused(Vec<String>),
    /// Done, with this on standard output if it is known.
    Done(Option<String>),
}

/// How long a case took, and what was wrong with its end.
pub(crate) struct Outcome {
    pub(crate) time: Duration,
    pub(crate) fault: Option<String>,
}

impl Case {
    pub(crate) fn refused(arguments: &[&str], words: &[&str]) -> Self {
        let owned = |texts: &[&str]| texts.iter().map(|&text| text.to_owned()).collect();
        Self { arguments: owned(arguments), files: Vec::new(), end: End::Refused(owned(words)) }
    }

    pub(crate) fn done(arguments: &[&str], out: Option<String>) -> Self {
        Self { end: End::Done(out), ..Self::refused(arguments, &[]) }
    }

    /// With a file beside those that are always there.
    pub(crate) fn with(mut self, name: &str, content: impl Into<Vec<u8>>) -> Self {
        self.files.push((name.to_owned(), content.into()));
        self
    }
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "dermatome {}", self.arguments.join(" "))?;
        for (name, content) in &self.files {
            let text = String::from_utf8_lossy(content);
            let shown: String = text.chars().take(60).flat_map(char::escape_default).collect();
            write!(f, " [{name}, {} bytes: {shown}]", content.len())?;
        }
        Ok(())
    }
}

/// Folders with a file of each kind that commands read.
pub(crate) struct Desks {
    files: BTreeMap<String, Vec<u8>>,
    /// What `forward` prints of the tiny skin.
    pub(crate) forward: String,
}

impl Desks {
    pub(crate) fn new() -> Self {
        let desk = Desk::with_patch();
        let voltages = tiny_voltages();
        let one = row(&voltages);
        desk.write("reference.csv", &one);
        desk.write("frames.csv", one.repeat(24));
        desk.write("readings.csv", READINGS);
        desk.write("loads.csv", LOADS);
        desk.write("recording.txt", recording());
        desk.write("path.csv", PATH);
        desk.write("material.toml", MATERIAL);
        desk.write("times.csv", (0..24).map(|i| format!("{}\n", f64::from(i) * 0.02)).collect::<String>());
        desk.write("notes.txt", "mine\n");
        let pressed = |press: u32| {
            let share = |step: usize| 1.0 + 0.05 * f64::from((7 * press + 3 * step as u32) % 11) / 11.0;
            row(&voltages.iter().enumerate().map(|(step, v)| v * share(step)).collect::<Vec<_>>())
        };
        let presses = (0..16).map(|i| format!("{},{},{}", 0.002 * f64::from(i), -0.01, pressed(i)));
        desk.write("presses.csv", presses.collect::<String>());
        desk.run(&["export", "skin.toml", "--out", "model"]).success();
        for name in ["skin.stl", "skin.ply", "skin.msh", "stimulation.csv", "conductivity.npy"] {
            std::fs::copy(desk.path(&format!("model/{name}")), desk.path(name)).unwrap();
        }
        std::fs::remove_dir_all(desk.path("model")).unwrap();
        desk.write("skin.dae", DAE);
        desk.write("posed.toml", format!("{TINY}{POSE}"));
        desk.write("robot.urdf", "<robot name=\"r\">\n  <link name=\"palm\"/>\n</robot>\n");
        desk.write(
            "robot.xml",
            "<mujoco>\n  <worldbody>\n    <body name=\"palm\"/>\n  </worldbody>\n</mujoco>\n",
        );
        // Of a board that is none.
        desk.write(
            "robot.toml",
            "name = \"arm\"\n[[patches]]\nskin = \"posed.toml\"\nport = \"replay:notes.txt\"\n",
        );
        let forward = desk.run(&["forward", "skin.toml"]).success().out;
        Self { files: contents(&desk.path("")), forward }
    }

    /// A file that is always there.
    pub(crate) fn file(&self, name: &str) -> &[u8] {
        &self.files[name]
    }

    /// Runs a case in a folder of its own.
    pub(crate) fn try_case(&self, case: &Case) -> Outcome {
        let desk = self.desk(case);
        let before = contents(&desk.path(""));
        let start = Instant::now();
        let arguments: Vec<_> = case.arguments.iter().map(String::as_str).collect();
        let mut child = desk.start(&arguments);
        child.read_output();
        let end = wait(&mut child);
        let time = start.elapsed();
        let fault = match end {
            false => Some(format!("still running after {} s", LIMIT.as_secs())),
            true => {
                let done = child.finish();
                let fault = case.end.fault(done.status.code(), &done.out, &done.err);
                fault.map(|fault| format!("{fault}\nstatus {}, said: {}", done.status, done.err.trim_end()))
            }
        };
        let after = contents(&desk.path(""));
        let changed = (after != before).then(|| format!("files were changed: {:?}", after.keys()));
        Outcome { time, fault: fault.or(changed.filter(|_| matches!(case.end, End::Refused(_)))) }
    }

    fn desk(&self, case: &Case) -> Desk {
        let desk = Desk::empty();
        for (name, content) in &self.files {
            desk.write(name, content);
        }
        std::fs::create_dir(desk.path("folder")).unwrap();
        for (name, content) in &case.files {
            desk.write(name, content);
        }
        desk
    }
}

/// Whether a process ends within the limit.
fn wait(child: &mut Running) -> bool {
    let start = Instant::now();
    while child.is_running() {
        if start.elapsed() > LIMIT {
            return false;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    true
}

impl End {
    fn fault(&self, code: Option<i32>, out: &str, err: &str) -> Option<String> {
        let said = err.to_lowercase();
        if said.contains("panicked") || said.contains("backtrace") {
            return Some("a panic".to_owned());
        }
        match self {
            Self::Refused(_) if !matches!(code, Some(1 | 2)) => Some("not refused".to_owned()),
            Self::Refused(_) if !(err.starts_with("error: ") || err.contains("\nerror: ")) => {
                Some("no error is told".to_owned())
            }
            Self::Refused(words) => {
                let is_there = |words: &&String| words.split('|').any(|word| err.contains(word));
                let missing: Vec<_> = words.iter().filter(|words| !is_there(words)).collect();
                (!missing.is_empty()).then(|| format!("does not say {missing:?}"))
            }
            Self::Done(_) if code != Some(0) => Some("refused".to_owned()),
            Self::Done(expected) => {
                expected.as_ref().filter(|text| *text != out).map(|_| format!("another result: {out}"))
            }
        }
    }
}

/// All files of a folder and of those in it, by their names.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    let read = entries.flat_map(|entry| {
        let name = entry.file_name().to_string_lossy().into_owned();
        if entry.path().is_dir() {
            let inside = contents(&entry.path());
            let named = inside.into_iter().map(|(file, bytes)| (format!("{name}/{file}"), bytes));
            return named.collect::<Vec<_>>();
        }
        vec![(name, std::fs::read(entry.path()).unwrap_or_default())]
    });
    read.collect()
}

/// The tiny skin with a text in it replaced.
pub(crate) fn tiny(from: &str, to: &str) -> String {
    assert!(TINY.contains(from), "{from}");
    TINY.replacen(from, to, 1)
}

pub(crate) const READINGS: &str = "pressure_kpa,strength,deviation,area_mm2,x_mm,y_mm,z_mm\n\
0,0,0.01,100,0,0,0\n2,0.1,0.01,100,0,0,0\n4,0.2,0.01,100,0,0,0\n6,0.3,0.01,100,0,0,0\n";
pub(crate) const LOADS: &str = "time_s,pressure_kpa\n0,0\n1,3\n2,6\n3,10\n4,5\n5,0\n";
pub(crate) const PATH: &str = "time_s,finger,x_m,y_m,shape,radius_m,inner_m,angle_deg,corners_m,depth,pressure_kpa,force_n\n\
0,1,0,0,finger,0.01,,,,0.5,,\n1,1,0.01,0,finger,0.01,,,,0.5,,\n";
/// A square of 100 mm.
pub(crate) const DAE: &str = r##"<COLLADA version="1.4.1"><asset><unit meter="1"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="s"><float_array id="a" count="12">-5 -5 0 5 -5 0 5 5 0 -5 5 0</float_array>
<technique_common><accessor source="#a" count="4" stride="3"/></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<polylist count="1"><input semantic="VERTEX" source="#v" offset="0"/><vcount>4</vcount><p>0 1 2 3</p></polylist>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="w"><node><scale>0.01 0.01 0.01</scale><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#w"/></scene></COLLADA>
"##;
const POSE: &str = "[pose]\nlink = \"palm\"\nposition = [0, 0, 0]\norientation = [0, 0, 0, 1]\n";
const MATERIAL: &str = include_str!("../../../models/materials/sample-1.toml");

/// What `stream` prints: a contact in each of 300 frames of 20 ms, that grows and shrinks again.
fn recording() -> String {
    let strength = |frame: i32| 0.1 + 0.4 * (1.0 - (f64::from(frame) / 150.0 - 1.0).abs());
    let line = |frame: i32| {
        let time = f64::from(frame) * 0.02;
        format!("{frame}\t{time:.6}\t0.000\t0.000\t0.000\t100.00\t{:.6}\t\t\t\n", strength(frame))
    };
    (0..300).map(line).collect()
}
