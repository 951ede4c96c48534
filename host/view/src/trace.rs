//! Trace: the samples of one slot on the terminal or as PNG, with settling part, limits and fit.

use super::picture::{INK, LARGE, Picture, SMALL};
use dermatome_link::scope::{Fit, Trace};
use dermatome_shared::demodulate::{CLIPPED, MIDDLE};
use embedded_graphics::{
    geometry::Point,
    pixelcolor::Rgb888,
    text::{Alignment, Baseline},
};

/// Lines of the terminal's plot.
const ROWS: usize = 21;
/// Columns of the terminal's plot.
const COLUMNS: usize = 90;
/// Largest code.
const TOP: f64 = 4095.0;
const SETTLING: Rgb888 = Rgb888::new(225, 225, 225);
const LIMIT: Rgb888 = Rgb888::new(192, 48, 40);
const FITTED: Rgb888 = Rgb888::new(0, 110, 60);
const SAMPLES: Rgb888 = Rgb888::new(31, 111, 180);

/// What a trace shows, in words.
#[must_use]
pub fn summary(trace: &Trace) -> Vec<String> {
    let fit = trace.fit().map_or("no whole carrier period to fit".to_owned(), |fit| {
        format!(
            "amplitude {:.1} steps of the converter, offset {:.1}, phase {:.1} deg, residual {:.2}",
            fit.amplitude, fit.offset, fit.phase, fit.residual
        )
    });
    vec![
        format!("gain      {}", trace.gain),
        format!(
            "samples   {} of which {} settle, {} per carrier period, {} a second",
            trace.samples.len(),
            trace.settling,
            trace.period,
            trace.sample_rate
        ),
        format!("clipped   {} samples (limits {} and {})", trace.clipped(), limits()[0], limits()[1]),
        format!("lock-in   {fit}"),
    ]
}

/// The trace as lines of text: `*` samples, `o` those that settle, `.` the fit, `-` the limits.
#[must_use]
pub fn text(trace: &Trace) -> String {
    let columns = trace.samples.len().clamp(1, COLUMNS);
    let mut cells = vec![[' '; ROWS]; columns];
    let row = |code: f64| ((1.0 - code.clamp(0.0, TOP) / TOP) * (ROWS - 1) as f64).round() as usize;
    let fit = trace.fit();
    for (column, cells) in cells.iter_mut().enumerate() {
        for limit in limits() {
            cells[row(limit.into())] = '-';
        }
        let sample = column as f64 * trace.samples.len() as f64 / columns as f64;
        if let Some(fit) = fit.filter(|_| sample >= trace.settling as f64) {
            cells[row(fit.at(trace, sample))] = '.';
        }
    }
    for (sample, &code) in trace.samples.iter().enumerate() {
        let mark = if sample < trace.settling { 'o' } else { '*' };
        cells[sample * columns / trace.samples.len()][row(code.into())] = mark;
    }
    let line = |row: usize| cells.iter().map(|column| column[row]).collect::<String>();
    let label = |row: usize| match row {
        0 => "4095",
        r if r == ROWS / 2 => "2048",
        r if r == ROWS - 1 => "0",
        _ => "",
    };
    (0..ROWS).map(|row| format!("{:>4} |{}\n", label(row), line(row).trim_end())).collect()
}

/// The trace as a PNG file.
pub fn png(trace: &Trace, title: &str) -> Result<Vec<u8>, png::EncodingError> {
    const SIZE: (u32, u32) = (960, 560);
    const LEFT: f64 = 60.0;
    const WIDTH: f64 = 880.0;
    const BASE: f64 = 420.0;
    const HEIGHT: f64 = 370.0;
    let mut picture = Picture::new(SIZE.0, SIZE.1);
    let last = trace.samples.len().max(2) - 1;
    let place = |sample: f64, code: f64| {
        let (x, y) = (LEFT + WIDTH * sample / last as f64, BASE - HEIGHT * code.clamp(0.0, TOP) / TOP);
        Point::new(x.round() as i32, y.round() as i32)
    };
    let settled = trace.settling.min(last) as f64;
    picture.rectangle(place(0.0, TOP), place(settled, 0.0), SETTLING);
    for limit in limits().map(f64::from) {
        picture.polyline(&[place(0.0, limit), place(last as f64, limit)], LIMIT, 1);
    }
    let corners = [(0.0, 0.0), (0.0, TOP), (last as f64, TOP), (last as f64, 0.0), (0.0, 0.0)];
    picture.polyline(&corners.map(|(sample, code)| place(sample, code)), INK, 1);
    if let Some(fit) = trace.fit() {
        picture.polyline(&fitted(trace, &fit, last, place), FITTED, 2);
    }
    for (sample, &code) in trace.samples.iter().enumerate() {
        let at = place(sample as f64, code.into());
        picture.rectangle(at - Point::new(2, 2), at + Point::new(2, 2), SAMPLES);
    }
    let mut label = |at: Point, words: &str, alignment| {
        picture.text(at, words, SMALL, alignment, Baseline::Middle);
    };
    for code in [0, MIDDLE, TOP as u16] {
        label(place(0.0, code.into()) - Point::new(8, 0), &code.to_string(), Alignment::Right);
    }
    for (line, words) in (0..).zip(summary(trace)) {
        label(Point::new(LEFT as i32, BASE as i32 + 40 + 22 * line), &words, Alignment::Left);
    }
    let key = "blue: samples   green: the lock-in's fit   grey: settling   red: limits of the converter";
    label(Point::new(LEFT as i32, BASE as i32 + 16), key, Alignment::Left);
    picture.text(Point::new(LEFT as i32, 14), title, LARGE, Alignment::Left, Baseline::Top);
    picture.encode()
}

fn fitted(trace: &Trace, fit: &Fit, last: usize, place: impl Fn(f64, f64) -> Point) -> Vec<Point> {
    const FINENESS: usize = 8;
    let points = FINENESS * trace.settling..=FINENESS * last;
    points.map(|n| n as f64 / FINENESS as f64).map(|at| place(at, fit.at(trace, at))).collect()
}

/// Codes at which samples count as clipped.
fn limits() -> [u16; 2] {
    [MIDDLE - CLIPPED, MIDDLE + CLIPPED]
}

#[cfg(test)]
mod tests {
    use super::*;
    use embedded_graphics::pixelcolor::RgbColor;
    use std::f64::consts::TAU;

    fn trace() -> Trace {
        let samples = (0..50).map(|n| (2048.0 + 900.0 * (f64::from(n - 10) / 40.0 * TAU).cos()) as u16);
        Trace {
            slot: 3,
            gain: 2,
            settling: 10,
            period: 40,
            sample_rate: 2_000_000,
            samples: samples.collect(),
        }
    }

    #[test]
    fn the_plot_marks_settling_samples_limits_and_samples() {
        let plot = text(&trace());
        let lines: Vec<&str> = plot.lines().collect();
        assert_eq!(lines.len(), ROWS);
        assert_eq!(lines[0], "4095 |");
        assert_eq!(lines[1], format!("     |{}", "-".repeat(50)));
        assert_eq!(plot.matches('o').count(), 10);
        assert!(plot.matches('*').count() >= 30, "{plot}");
    }

    #[test]
    fn a_trace_without_samples_is_drawn_all_the_same() {
        let empty = Trace { samples: Vec::new(), ..trace() };
        assert_eq!(text(&empty).lines().count(), ROWS);
        assert!(png(&empty, "empty").is_ok());
        assert!(summary(&empty)[3].contains("no whole carrier period"));
    }

    #[test]
    fn the_picture_has_the_colours_of_samples_fit_and_limits() {
        let bytes = png(&trace(), "slot 3").unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut rgb = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut rgb).unwrap();
        for colour in [SAMPLES, FITTED, LIMIT, SETTLING] {
            let wanted = [colour.r(), colour.g(), colour.b()];
            assert!(rgb.chunks(3).any(|pixel| pixel == wanted), "{colour:?}");
        }
    }
}
