//! Every column of every table with cells that it does not take.

use super::case::{Case, Desks, LOADS, PATH, READINGS, tiny};

const CELLS: &[&str] = &["", "x", "nan", "inf", "1e999", "\"", "1 2", "0y10", "\u{ff11}"];

/// A table with a heading: a command that reads `bad.csv`, a sound one, columns that may be empty or words.
struct Table {
    command: &'static [&'static str],
    sound: String,
    /// May be empty or have any text: cells that are right.
    right: &'static [(&'static str, &'static [&'static str])],
    /// May be left out with its heading.
    optional: &'static [&'static str],
}

pub(crate) fn cases(desks: &Desks) -> Vec<Case> {
    let tables = [
        Table {
            command: &["calibrate", "skin.dermatome", "--readings", "bad.csv", "--out", "new.dermatome"],
            sound: READINGS.to_owned(),
            right: &[("deviation", &[""]), ("area_mm2", &[""]), ("z_mm", &[""])],
            optional: &["deviation", "area_mm2", "z_mm"],
        },
        Table {
            command: &[
                "calibrate",
                "skin.dermatome",
                "--recording",
                "recording.txt",
                "--loads",
                "bad.csv",
                "--out",
                "new.dermatome",
            ],
            sound: LOADS.to_owned(),
            right: &[],
            optional: &[],
        },
        Table {
            command: &["simulate", "skin.toml", "--listen", "tcp:127.0.0.1:0", "--path", "bad.csv"],
            sound: PATH.to_owned(),
            right: &[
                ("shape", &[""]),
                ("inner_m", &[""]),
                ("angle_deg", &[""]),
                ("corners_m", &[""]),
                ("pressure_kpa", &[""]),
                // A quote that the file ends in holds nothing.
                ("force_n", &["", "\""]),
            ],
            optional: &["shape", "inner_m", "angle_deg", "corners_m", "pressure_kpa", "force_n"],
        },
    ];
    let mut cases: Vec<Case> = tables.iter().flat_map(Table::cases).collect();
    cases.extend(in_skins(desks));
    cases.extend(of_numbers(desks));
    cases.extend(recordings(desks));
    cases.extend(of_instruments());
    cases
}

/// Files of other instruments that hold no frames.
fn of_instruments() -> Vec<Case> {
    let files: [(&str, &str, &str); 9] = [
        ("bad.mat", "", "MATLAB"),
        ("bad.mat", "MATLAB 7.3 MAT-file", "-v7"),
        ("bad.mat", "MATLAB 5.0 MAT-file", "MATLAB"),
        ("bad.eit", "", "line 1"),
        ("bad.eit", "99\n1\n", "frequencies"),
        ("bad.eit", "9\na\nb\n1\n1\n0\n1\n1\n1\n1 1\n", "line 10"),
        ("bad.get", "", "1024"),
        ("bad.get", "---Draeger EIT-Software---\n", "header"),
        ("bad.txt", "Vr Vi I\n1 2 0\n", "current"),
    ];
    let case = |(name, text, words): &(&'static str, &str, &'static str)| {
        Case::refused(&["check-data", "skin.toml", name], &[name, words]).with(name, (*text).to_owned())
    };
    files.iter().map(case).collect()
}

impl Table {
    fn cases(&self) -> Vec<Case> {
        let rows: Vec<Vec<&str>> = self.sound.lines().map(|line| line.split(',').collect()).collect();
        let mut cases = Vec::new();
        for (at, name) in rows[0].iter().enumerate() {
            let right =
                self.right.iter().find(|(column, _)| column == name).map_or(&[][..], |(_, cells)| cells);
            for cell in CELLS.iter().filter(|cell| !right.contains(cell)) {
                let text = changed(&rows, 2, at, cell);
                let line = if *cell == "\"" { "line|quote" } else { "line 3" };
                cases.push(Case::refused(self.command, &["bad.csv", line]).with("bad.csv", text));
            }
            let misspelled = changed(&rows, 0, at, &format!("{name}x"));
            cases.push(Case::refused(self.command, &["bad.csv", name]).with("bad.csv", misspelled));
            let twice = changed(&rows, 0, at, rows[0][(at + 1) % rows[0].len()]);
            cases.push(
                Case::refused(self.command, &["bad.csv", rows[0][(at + 1) % rows[0].len()]])
                    .with("bad.csv", twice),
            );
            if !self.optional.contains(name) {
                let without: String =
                    rows.iter().map(|row| [&row[..at], &row[at + 1..]].concat().join(",") + "\n").collect();
                cases.push(Case::refused(self.command, &["bad.csv", name]).with("bad.csv", without));
            }
        }
        for (row, line) in [
            ("1", "line 2|line 3"),
            ("1,2,3,4,5,6,7,8,9,10,11,12,13,14", "line 2|line 3"),
            ("x;y", "line 2|line 3"),
        ] {
            let text = self.sound.replacen('\n', &format!("\n{row}\n"), 1);
            cases.push(Case::refused(self.command, &["bad.csv", line]).with("bad.csv", text));
        }
        let heading = self.sound.lines().next().unwrap_or_default();
        for text in [
            String::new(),
            format!("{heading}\n"),
            heading.to_owned(),
            "\n\n\n".to_owned(),
            "\u{feff}".to_owned(),
        ] {
            cases.push(Case::refused(self.command, &["bad.csv"]).with("bad.csv", text));
        }
        cases
    }
}

/// The table with one cell changed.
fn changed(rows: &[Vec<&str>], row: usize, column: usize, cell: &str) -> String {
    let mut rows = rows.to_vec();
    rows[row][column] = cell;
    rows.iter().map(|row| row.join(",") + "\n").collect()
}

/// Tables that a skin file names.
fn in_skins(desks: &Desks) -> Vec<Case> {
    let steps = String::from_utf8_lossy(desks.file("stimulation.csv")).into_owned();
    let map = "x_m,y_m,relative\n0,0,1\n0.01,0,1.2\n0,0.01,0.9\n".to_owned();
    let weights = format!("weight\n{}", "1\n".repeat(20));
    let tables: [(&str, &str, &str, String); 3] = [
        ("table", "pattern = \"adjacent\"", "pattern = \"table\"\ntable = \"bad.csv\"", steps),
        ("conductivity_map", "[material]", "[material]\nconductivity_map = \"bad.csv\"", map),
        ("weights", "[inverse]", "[inverse]\nweights = \"bad.csv\"", weights),
    ];
    let mut cases = Vec::new();
    for (field, from, to, sound) in tables {
        let skin = tiny(from, to);
        let rows: Vec<Vec<&str>> = sound.lines().map(|line| line.split(',').collect()).collect();
        let mut texts = vec![
            (String::new(), ""),
            ("mine\n".to_owned(), "column"),
            (format!("{}\n", rows[0].join(",")), ""),
        ];
        for (at, name) in rows[0].iter().enumerate() {
            texts.extend(CELLS.iter().map(|cell| {
                (changed(&rows, 2, at, cell), if *cell == "\"" { "" } else { "line 3|19 entries" })
            }));
            texts.push((changed(&rows, 0, at, &format!("{name}x")), name));
            let negative = if field == "conductivity_map" && at < 2 { "-99999" } else { "-1" };
            texts.push((changed(&rows, 2, at, negative), "line 3|-1|-99999"));
            if field != "weights" {
                texts.push((changed(&rows, 2, at, "99999"), "line 3|99999"));
            }
        }
        // The skin file and the table that it names.
        for (text, word) in texts {
            let case = Case::refused(&["build", "named.toml"], &["named.toml", field, word]);
            cases.push(case.with("bad.csv", text).with("named.toml", skin.as_str()));
        }
    }
    cases
}

/// Tables of numbers without a heading.
fn of_numbers(desks: &Desks) -> Vec<Case> {
    let readers: [(&[&str], &str); 8] = [
        (&["reconstruct", "skin.toml", "--reference", "reference.csv", "--frames", "bad.csv"], "frames.csv"),
        (&["reconstruct", "skin.toml", "--reference", "bad.csv", "--frames", "frames.csv"], "reference.csv"),
        (&["replay", "bad.csv", "--patch", "skin.dermatome"], "frames.csv"),
        (&["replay", "frames.csv", "--patch", "skin.dermatome", "--times", "bad.csv"], "times.csv"),
        (&["check-data", "skin.toml", "bad.csv"], "frames.csv"),
        (&["check-data", "skin.toml", "frames.csv", "--good", "bad.csv"], "frames.csv"),
        (&["learn", "skin.toml", "--presses", "bad.csv", "--reference", "reference.csv"], "presses.csv"),
        (&["forward", "skin.toml", "--conductivity", "bad.csv"], "ones.csv"),
    ];
    let mut cases = Vec::new();
    for (command, sound) in readers {
        let sound = if sound == "ones.csv" {
            "1\n".repeat(492)
        } else {
            String::from_utf8_lossy(desks.file(sound)).into_owned()
        };
        let rows: Vec<Vec<&str>> = sound.lines().map(|line| line.split(',').collect()).collect();
        let (row, column) = (rows.len().min(3) - 1, rows[0].len() / 2);
        for cell in CELLS.iter().filter(|cell| !(cell.is_empty() && rows[0].len() == 1)) {
            let text = changed(&rows, row, column, cell);
            cases.push(Case::refused(command, &["bad.csv"]).with("bad.csv", text));
        }
        let short = rows.iter().enumerate().map(|(at, cells)| {
            let kept = if at == row { &cells[..cells.len() - 1] } else { &cells[..] };
            kept.join(",") + "\n"
        });
        if rows[0].len() > 1 && rows.len() > 1 {
            cases.push(
                Case::refused(command, &["bad.csv", "line|row"]).with("bad.csv", short.collect::<String>()),
            );
        }
        let narrow: String =
            rows.iter().map(|cells| cells[..cells.len().div_ceil(2)].join(",") + "\n").collect();
        for text in [String::new(), "\n".to_owned(), "a,b,c\n".to_owned(), "1,2,3\n1,2\n".to_owned(), narrow]
        {
            if !(rows[0].len() == 1 && text == sound) {
                cases.push(Case::refused(command, &["bad.csv"]).with("bad.csv", text));
            }
        }
    }
    cases
}

/// Lines of a stream.
fn recordings(desks: &Desks) -> Vec<Case> {
    let sound = String::from_utf8_lossy(desks.file("recording.txt")).into_owned();
    let command = &[
        "calibrate",
        "skin.dermatome",
        "--recording",
        "bad.txt",
        "--loads",
        "loads.csv",
        "--out",
        "new.dermatome",
    ];
    let rows: Vec<Vec<&str>> = sound.lines().map(|line| line.split('\t').collect()).collect();
    let mut cases = Vec::new();
    for column in [0, 1, 2, 5, 6] {
        for cell in CELLS.iter().filter(|cell| **cell != "\"") {
            let mut rows = rows.clone();
            rows[2][column] = cell;
            let text: String = rows.iter().map(|row| row.join("\t") + "\n").collect();
            cases.push(Case::refused(command, &["bad.txt", "line 3"]).with("bad.txt", text));
        }
    }
    let backwards: String = sound.lines().rev().map(|line| format!("{line}\n")).collect();
    for text in [String::new(), "x\n".to_owned(), backwards, sound.replace('\t', " ")] {
        cases.push(Case::refused(command, &["bad.txt"]).with("bad.txt", text));
    }
    cases
}
