//! The page: one file that needs no other.

use super::report::{Block, Comparison, Report, Table, Wanted, number};
use base64::{Engine, engine::general_purpose::STANDARD};

/// A window of 1,200 pixels shows all of it: words in tables break, numbers do not.
const STYLE: &str = "body{font:15px/1.5 system-ui,sans-serif;color:#222;max-width:1060px;margin:2em auto;\
padding:0 1em}h1{font-size:1.7em}h2{margin-top:2.2em;border-bottom:1px solid #ccc}p,figcaption{max-width:75em}\
table{border-collapse:collapse;margin:1em 0;max-width:100%;font-variant-numeric:tabular-nums}\
caption{text-align:left;font-weight:600;padding-bottom:.3em}\
th,td{padding:.2em .7em;border-bottom:1px solid #ddd;text-align:right}td{white-space:nowrap}th{background:#f4f4f4}\
.words,th:first-child,td:first-child{text-align:left;white-space:normal}td a{white-space:nowrap}\
.yes{color:#06703c}.no{color:#b2182b;font-weight:600}.plots{display:flex;flex-wrap:wrap;gap:10px}\
.plots svg,img{max-width:100%;height:auto}figure{margin:1em 0}figcaption{color:#555}\
.note{background:#fff7e0;border-left:4px solid #e69f00;padding:.6em 1em}";

/// What every page says first.
const NOTE: &str = "All of this is simulation with stated models; nothing here was measured on a real skin. The \
true skin is solved on a mesh of its own, finer than the model's and turned against it; the material is a model fitted \
to the thesis' figures; noise and artefacts are stated with each experiment. The images were computed by the board's \
own fixed-point code from simulated converter codes. Positions in per cent refer to the larger side of the skin, as in \
the thesis. Red is a rise of conductivity, blue a fall. Only where the thesis' own simulation is repeated (surface) one \
mesh and floating point stand for both.";

/// The page of some reports.
#[must_use]
pub fn page(reports: &[Report]) -> String {
    let title = match reports {
        [only] => only.title,
        _ => "The experiments of the thesis, simulated",
    };
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{0}</title>\n\
         <style>{STYLE}</style>\n</head>\n<body>\n<h1>{0}</h1>\n<p class=\"note\">{NOTE}</p>\n",
        escape(title)
    );
    page += "<h2 id=\"summary\">Summary</h2>\n";
    page += &summary(reports);
    page += &assessment(reports);
    for report in reports {
        page += &section(report);
    }
    page += "</body>\n</html>\n";
    page
}

fn summary(reports: &[Report]) -> String {
    let all = || reports.iter().flat_map(|report| report.comparisons.iter().map(move |c| (report, c)));
    let rows: String = all()
        .map(|(report, c)| format!("<tr><td><a href=\"#{0}\">{0}</a></td>{1}</tr>\n", report.name, cells(c)))
        .collect();
    let count = |met| all().filter(|(_, comparison)| comparison.met() == Some(met)).count();
    format!(
        "<p>Of {} figures that have a limit, {} are met and {} are not met.</p>\n<table>\n<tr><th>experiment</th>{HEAD}</tr>\n\
         {rows}</table>\n",
        count(true) + count(false),
        count(true),
        count(false)
    )
}

/// The thesis' Table 6.1, of the samples that were loaded.
fn assessment(reports: &[Report]) -> String {
    let assessed = reports.iter().filter_map(|report| Some((report.name, report.assessment.as_ref()?)));
    let row = |name: &str, sample: &str, comparison: &Comparison| {
        format!("<tr><td><a href=\"#{name}\">{}</a></td>{}</tr>\n", escape(sample), cells(comparison))
    };
    let rows: String = assessed
        .flat_map(|(name, sample)| sample.figures.iter().map(move |figure| row(name, sample.sample, figure)))
        .collect();
    if rows.is_empty() {
        return rows;
    }
    format!(
        "<h2 id=\"table-6-1\">Table 6.1: static assessment</h2>\n<p>{}</p>\n<table>\n<tr><th>sample</th>{HEAD}</tr>\n{rows}</table>\n",
        escape(
            "What the thesis concludes of each sample, and the same from the static loading below: the mean of three trials through \
             the board's images, with electrodes that slip. The material is fitted to the thesis' range and hysteresis, so that what is \
             not met is lost between sheet and image."
        )
    )
}

/// Heads of [`cells`].
const HEAD: &str =
    "<th class=\"words\">figure</th><th>thesis</th><th>here, simulated</th><th>limit</th><th></th>";

/// A figure beside the thesis', its limit, and whether that is met.
fn cells(comparison: &Comparison) -> String {
    let with_unit = |value: f64| format!("{} {}", number(value), comparison.unit).trim_end().to_owned();
    let wanted = match comparison.wanted {
        Some(Wanted::AtMost(limit)) => format!("at most {}", with_unit(limit)),
        Some(Wanted::AtLeast(limit)) => format!("at least {}", with_unit(limit)),
        None => String::new(),
    };
    let verdict = match comparison.met() {
        Some(true) => "<span class=\"yes\">met</span>",
        Some(false) => "<span class=\"no\">not met</span>",
        None => "",
    };
    format!(
        "<td class=\"words\">{}</td><td>{}</td><td>{}</td><td>{}</td><td>{verdict}</td>",
        escape(&comparison.what),
        comparison.thesis.map_or("-".to_owned(), with_unit),
        with_unit(comparison.found),
        wanted
    )
}

fn section(report: &Report) -> String {
    let rows: String = report.comparisons.iter().map(|c| format!("<tr>{}</tr>\n", cells(c))).collect();
    let figures = if rows.is_empty() { rows } else { format!("<table>\n<tr>{HEAD}</tr>\n{rows}</table>\n") };
    let blocks: String = report.blocks.iter().map(block).collect();
    format!("<h2 id=\"{}\">{}</h2>\n{figures}{blocks}", report.name, escape(report.title))
}

fn block(block: &Block) -> String {
    match block {
        Block::Words(words) => format!("<p>{}</p>\n", escape(words)),
        Block::Table(content) => table(content),
        Block::Plots(plots) => format!("<div class=\"plots\">\n{}</div>\n", plots.concat()),
        Block::Picture(png, words) => format!(
            "<figure><img alt=\"{0}\" src=\"data:image/png;base64,{1}\"><figcaption>{0}</figcaption></figure>\n",
            escape(words),
            STANDARD.encode(png)
        ),
    }
}

fn table(table: &Table) -> String {
    let row = |cells: &[String], tag: &str| {
        let cells: String = cells.iter().map(|cell| format!("<{tag}>{}</{tag}>", escape(cell))).collect();
        format!("<tr>{cells}</tr>\n")
    };
    let rows: String = table.rows.iter().map(|cells| row(cells, "td")).collect();
    let head = row(&table.columns, "th");
    format!("<table>\n<caption>{}</caption>\n{head}{rows}</table>\n", escape(&table.caption))
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::report::Assessment;

    #[test]
    fn a_page_holds_everything_and_refers_to_nothing_outside() {
        let mut report = Report::new("x", "An experiment & more");
        report.words("a < b");
        report.table("figures", &["place", "error"], vec![vec!["centre".into(), "1.5".into()]]);
        report.picture(vec![1, 2, 3], "a picture");
        report.compare("error", "%", Some(4.0), 1.5, Some(Wanted::AtMost(1.0)));
        let page = page(&[report]);
        for part in [
            "An experiment &amp; more",
            "a &lt; b",
            "<td>1.5</td>",
            "base64,AQID",
            "not met",
            "at most 1.00 %",
            "Of 1 figures that have a limit, 0 are met and 1 are not met.",
        ] {
            assert!(page.contains(part), "{part}: {page}");
        }
        // In the summary and in the experiment's section, beside the figure.
        let row = "<td>1.50 %</td><td>at most 1.00 %</td><td><span class=\"no\">not met</span></td>";
        assert_eq!(page.matches(row).count(), 2, "{page}");
        assert!(!page.contains("table-6-1"), "nothing was loaded");
        assert!(!page.contains("http") && !page.contains("<script") && !page.contains("<link"));
    }

    #[test]
    fn table_6_1_stands_on_the_page_with_the_samples_that_were_loaded() {
        let figure = |what: &str, thesis: f64, found: f64, wanted| Comparison {
            what: what.into(),
            unit: "",
            thesis: Some(thesis),
            found,
            wanted: Some(wanted),
        };
        let mut report = Report::new("loading-9", "Loading");
        let figures = [
            figure("range", 35.0, 35.0, Wanted::AtLeast(35.0)),
            figure("hysteresis", 20.0, 26.5, Wanted::AtMost(20.0)),
            figure("position error", 0.046, 0.012, Wanted::AtMost(0.046)),
        ];
        report.assessment = Some(Assessment { sample: "Sample 9", figures });
        let page = page(&[Report::new("other", "Other"), report]);
        let from = page.find("id=\"table-6-1\"").unwrap();
        let table = &page[from..page[from..].find("</table>").unwrap() + from];
        assert_eq!(table.matches("<a href=\"#loading-9\">Sample 9</a>").count(), 3, "{table}");
        for part in
            ["<td>20.0</td><td>26.5</td><td>at most 20.0</td><td><span class=\"no\">not met", "0.0460"]
        {
            assert!(table.contains(part), "{part}: {table}");
        }
    }
}
