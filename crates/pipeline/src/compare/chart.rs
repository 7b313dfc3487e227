//! Charts as self-contained SVG that follows the reader's light or dark setting.
//!
//! Crate `plotters` is not used: its SVG backend writes fixed colours at each element and has no classes, titles or tab
//! stops, so its charts have no dark setting, no text on hover and no keyboard focus.

use std::fmt::Write;

use super::entry::BEST_LOBE;
use super::labels::{Labels, stack, width};
use super::units::amount;
use super::{Axis, Comparison, Entry, Kind};
use crate::text::xml_escaped;

/// Width of a chart in pixels.
pub const WIDTH: f64 = 760.0;
/// Height of a chart in pixels.
pub const HEIGHT: f64 = 446.0;
const LEFT: f64 = 56.0;
const RIGHT: f64 = 150.0;
const TOP: f64 = 50.0;
const BOTTOM: f64 = 48.0;
/// Left end of the titles of a chart and of its vertical axis, which stand above the numbers of that axis.
const TITLES: f64 = 8.0;
/// Space for labels to the left of the first point.
const BEFORE: f64 = 150.0;

/// Style of a chart. Colours are from a palette that colour-blind readers can distinguish (M. Okabe, K. Ito, "Color
/// universal design", 2008).
pub const STYLE: &str = "svg{--ink:#1c2430;--soft:#6b7480;--grid:#e3e6ea;--paper:#ffffff;--ours:#0060a8;--peer:#b34700}\
    @media(prefers-color-scheme:dark){svg{--ink:#e8ebef;--soft:#9aa3ae;--grid:#333a44;--paper:#14181d;--ours:#6cbcf2;\
    --peer:#f0a35e}}\
    svg text{font:11px system-ui,sans-serif;fill:var(--ink)}svg .title{font-weight:600;font-size:13px}\
    svg .soft{fill:var(--soft)}svg .paper{fill:var(--paper)}svg .grid{stroke:var(--grid);fill:none}\
    svg .lead{stroke:var(--soft);stroke-width:.6}svg .ours{fill:var(--ours);stroke:var(--ours)}\
    svg .peer{fill:var(--peer);stroke:var(--peer)}svg .oracle{stroke:var(--ink);fill:none;stroke-dasharray:5 4}\
    svg .ring{fill:none;stroke:var(--ours);stroke-width:2}svg path.line{fill:none;stroke-width:1.6}\
    svg path.peer.line{stroke-width:1;opacity:.55}svg text.ours{fill:var(--ours);stroke:none}\
    svg text.peer{fill:var(--peer);stroke:none}svg .chosen{font-weight:700}\
    svg .entry{outline:none}svg .detail{visibility:hidden}svg .hit{fill:none;stroke:transparent;stroke-width:9}\
    svg .entry:is(:hover,:focus-visible) .detail{visibility:visible}\
    .chart:has(>.entry:is(:hover,:focus-visible))>.entry:not(:hover,:focus-visible){opacity:.2}";

/// What the vertical axis of a chart against cost shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// The mean lobe error.
    Lobe,
    /// The error of pictures.
    Picture,
}

impl Measure {
    /// Returns the measures of which `comparison` has values.
    pub fn of(comparison: &Comparison) -> &'static [Self] {
        let has_pictures = comparison.entries.iter().any(|entry| entry.picture_error.is_some());
        if has_pictures { &[Self::Lobe, Self::Picture] } else { &[Self::Lobe] }
    }

    fn value(self, entry: &Entry) -> Option<f64> {
        match self {
            Self::Lobe => Some(entry.error),
            Self::Picture => entry.picture_error,
        }
    }

    fn title(self) -> &'static str {
        match self {
            Self::Lobe => "mean lobe error",
            Self::Picture => "picture error",
        }
    }

    /// Returns the title of the vertical axis.
    fn axis_title(self) -> &'static str {
        match self {
            Self::Lobe => "Mean lobe error: share of misplaced half-vectors (lower is better)",
            Self::Picture => "Picture error: relative L1 of radiance (lower is better)",
        }
    }
}

/// Draws all charts, one above the other, as an SVG file.
pub fn file(comparison: &Comparison) -> String {
    let against_cost = Measure::of(comparison);
    let height = (against_cost.len() + 1) as f64 * HEIGHT;
    let tops = (0..).map(|i| f64::from(i) * HEIGHT);
    let charts: String = against_cost.iter().zip(tops).map(|(m, y)| cost(comparison, Axis::GpuBytes, *m, y)).collect();
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\" width=\"{WIDTH}\" \
         height=\"{height}\"><style>{STYLE}</style>{charts}{}</svg>\n",
        levels(comparison, height - HEIGHT)
    )
}

/// Draws an error against cost. Entries without a cost stand at the left border.
pub fn cost(comparison: &Comparison, axis: Axis, measure: Measure, y: f64) -> String {
    let value = |entry: &Entry| axis.value(&entry.cost).filter(|v| *v > 0.0);
    let points: Vec<&Entry> =
        comparison.entries.iter().filter(|e| e.kind != Kind::Oracle && measure.value(e).is_some()).collect();
    let error = |entry: &Entry| measure.value(entry).unwrap_or(0.0);
    let costs = points.iter().filter_map(|e| value(e));
    let (least, most) = costs.fold((f64::INFINITY, 0.0_f64), |(a, b), v| (a.min(v), b.max(v)));
    let has_blanks = points.iter().any(|e| value(e).is_none());
    let start = LEFT + BEFORE;
    let span = if most > least { (most / least).ln() } else { 1.0 };
    let at = |v: f64| start + (v / least).ln() / span * (WIDTH - RIGHT - start);
    let scale = Scale::new(&comparison.entries, error);
    let against = axis.title().to_lowercase().replace("gpu", "GPU");
    let mut svg = open(comparison, &format!("{} against {against}", measure.title()), measure.axis_title(), y);
    let oracles: Vec<&Entry> =
        comparison.entries.iter().filter(|e| e.kind == Kind::Oracle && measure == Measure::Lobe).collect();
    scale.draw(&mut svg, &oracles, has_blanks.then_some("not measured"));
    for tick in ticks(least, most) {
        let x = at(tick);
        let _ = write!(
            svg,
            "<path class=\"grid\" d=\"M{x:.1} {TOP}V{:.1}\"/><text class=\"soft\" x=\"{x:.1}\" y=\"{:.1}\" \
             text-anchor=\"middle\">{}</text>",
            HEIGHT - BOTTOM,
            HEIGHT - BOTTOM + 15.0,
            amount(axis, tick)
        );
    }
    axis_below(&mut svg, &format!("{}, on a logarithmic scale", axis.title()));
    let mut placed: Vec<(f64, f64, &Entry)> =
        points.iter().map(|e| (value(e).map_or(LEFT + 10.0, at), scale.y(error(e)), *e)).collect();
    placed.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut labels = Labels::new([LEFT, TOP, WIDTH, HEIGHT - BOTTOM], placed.iter().map(|p| [p.0, p.1]));
    for oracle in oracles {
        let y = scale.y(oracle.error);
        labels.avoid([LEFT, y - 1.0, WIDTH - RIGHT, y + 1.0]);
        labels.avoid([LEFT, y, LEFT + 4.0 + width(BEST_LOBE), y + 18.0]);
    }
    for (x, y, entry) in placed {
        let cost = value(entry).map_or("not measured".to_owned(), |n| amount(axis, n));
        begin(&mut svg, entry, &format!("error {:.2}, {cost} {}", error(entry), axis.place()));
        let class = class(entry);
        if entry.chosen {
            let _ = write!(svg, "<circle class=\"ring\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"8\"/>");
        }
        let shape = match entry.kind {
            Kind::Ours => format!("<circle class=\"{class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\"/>"),
            _ => format!("<path class=\"{class}\" d=\"M{:.1} {:.1}h7v7h-7z\"/>", x - 3.5, y - 3.5),
        };
        svg += &shape;
        let name = if entry.chosen { format!("{} (chosen)", entry.name) } else { entry.name.clone() };
        let [lx, ly] = labels.place([x, y], &name);
        let (near, anchor) = if lx < x { (lx + width(&name), "end") } else { (lx, "start") };
        if (ly - y).abs() > 7.0 {
            let _ = write!(svg, "<path class=\"lead\" d=\"M{x:.1} {y:.1}L{near:.1} {ly:.1}\"/>");
        }
        label(&mut svg, entry, &name, [near, ly], anchor);
        svg += "</g>";
    }
    svg + "</svg>"
}

/// Draws error by level.
pub fn levels(comparison: &Comparison, y: f64) -> String {
    let entries = &comparison.entries;
    let count = entries.iter().map(|e| e.level_errors.len()).max().unwrap_or(0);
    let end = WIDTH - RIGHT - 20.0;
    let at = |level: usize| LEFT + 10.0 + level as f64 * (end - LEFT - 10.0) / count.saturating_sub(1).max(1) as f64;
    let scale = Scale::new(entries, |e| e.level_errors.iter().copied().fold(0.0, f64::max));
    let vertical = "Lobe error: share of misplaced half-vectors (lower is better)";
    let mut svg = open(comparison, "lobe error by mip level", vertical, y);
    scale.draw(&mut svg, &[], None);
    for level in 0..count {
        let _ = write!(
            svg,
            "<text class=\"soft\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{level}</text>",
            at(level),
            HEIGHT - BOTTOM + 15.0
        );
    }
    axis_below(&mut svg, "Mip level (0 is the finest)");
    let last = |entry: &Entry| entry.level_errors.last().map_or(HEIGHT - BOTTOM, |e| scale.y(*e));
    let mut ends: Vec<&Entry> = entries.iter().collect();
    ends.sort_by(|a, b| last(a).total_cmp(&last(b)));
    let heights: Vec<f64> = ends.iter().map(|entry| last(entry)).collect();
    let labels: Vec<f64> = stack(&heights, [TOP, HEIGHT - BOTTOM]);
    let mut lines: Vec<(&Entry, f64)> = ends.into_iter().zip(labels).collect();
    // Our lines are drawn last, so that they lie on top.
    lines.sort_by_key(|(entry, _)| [Kind::Peer, Kind::Oracle, Kind::Ours].iter().position(|kind| *kind == entry.kind));
    for (entry, height) in lines {
        begin(&mut svg, entry, &format!("mean error {:.2}", entry.error));
        let points = entry.level_errors.iter().enumerate();
        let path: Vec<String> = points.map(|(l, e)| format!("{:.1} {:.1}", at(l), scale.y(*e))).collect();
        let path = path.join("L");
        let (x, y) = (at(count.saturating_sub(1)), last(entry));
        let _ = write!(
            svg,
            "<path class=\"hit\" d=\"M{path}\"/><path class=\"{} line\" d=\"M{path}\"/>\
             <path class=\"lead\" d=\"M{x:.1} {y:.1}L{:.1} {height:.1}\"/>",
            class(entry),
            x + 22.0
        );
        label(&mut svg, entry, entry.shown_name(), [x + 25.0, height], "start");
        svg += "</g>";
    }
    svg + "</svg>"
}

/// Opens the group of an entry, which stands out while a pointer is over it or it has the focus, and shows `detail`.
fn begin(svg: &mut String, entry: &Entry, detail: &str) {
    let text = xml_escaped(&format!("{}: {detail}", entry.shown_name()));
    let (x, y) = (WIDTH - 8.0, HEIGHT - 12.0);
    let _ = write!(
        svg,
        "<g class=\"entry\" tabindex=\"0\" role=\"img\" aria-label=\"{text}\">\
         <text class=\"detail\" x=\"{x}\" y=\"{y}\" text-anchor=\"end\">{text}</text>"
    );
}

/// Writes the title of the horizontal axis, at the left, since the detail of an entry appears at the right.
fn axis_below(svg: &mut String, title: &str) {
    let _ = write!(svg, "<text x=\"{LEFT}\" y=\"{}\">{title}</text>", HEIGHT - 12.0);
}

/// Begins a chart with its title and the title of its vertical axis.
fn open(comparison: &Comparison, title: &str, vertical: &str, y: f64) -> String {
    let name = xml_escaped(&comparison.material.chars().take(60).collect::<String>());
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" y=\"{y}\" width=\"{WIDTH}\" height=\"{HEIGHT}\" \
         viewBox=\"0 0 {WIDTH} {HEIGHT}\" class=\"chart\" role=\"group\"><title>{name}: {title}</title>\
         <rect class=\"paper\" width=\"{WIDTH}\" height=\"{HEIGHT}\"/>\
         <text class=\"title\" x=\"{TITLES}\" y=\"18\">{name}: {title}</text>\
         <text x=\"{TITLES}\" y=\"36\">{vertical}</text>"
    )
}

fn class(entry: &Entry) -> &'static str {
    match entry.kind {
        Kind::Ours => "ours",
        Kind::Peer => "peer",
        Kind::Oracle => "oracle",
    }
}

fn label(svg: &mut String, entry: &Entry, name: &str, [x, y]: [f64; 2], anchor: &str) {
    let class = match (entry.kind, entry.chosen) {
        (Kind::Oracle, _) => "soft",
        (Kind::Ours, true) => "ours chosen",
        (Kind::Ours, false) => "ours",
        (Kind::Peer, _) => "peer",
    };
    let (y, name) = (y + 4.0, xml_escaped(name));
    let _ = write!(svg, "<text class=\"{class}\" x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{name}</text>");
}

/// The vertical axis, which begins at 0.
struct Scale {
    top: f64,
}

impl Scale {
    fn new(entries: &[Entry], value: impl Fn(&Entry) -> f64) -> Self {
        let largest = entries.iter().map(value).filter(|v| v.is_finite()).fold(0.05, f64::max);
        Self { top: (largest * 20.0).ceil() / 20.0 }
    }

    fn y(&self, error: f64) -> f64 {
        HEIGHT - BOTTOM - error / self.top * (HEIGHT - BOTTOM - TOP)
    }

    fn draw(&self, svg: &mut String, oracles: &[&Entry], blanks: Option<&str>) {
        let step = if self.top > 0.4 { 0.1 } else { 0.05 };
        for i in 0..=(self.top / step + 1e-9) as u32 {
            let error = f64::from(i) * step;
            let y = self.y(error);
            let _ = write!(
                svg,
                "<path class=\"grid\" d=\"M{LEFT} {y:.1}H{:.1}\"/><text class=\"soft\" x=\"{:.1}\" y=\"{:.1}\" \
                 text-anchor=\"end\">{error:.2}</text>",
                WIDTH - RIGHT,
                LEFT - 6.0,
                y + 4.0
            );
        }
        if let Some(text) = blanks {
            let y = HEIGHT - BOTTOM + 15.0;
            let _ = write!(svg, "<text class=\"soft\" x=\"{LEFT}\" y=\"{y:.1}\">{text}</text>");
        }
        for oracle in oracles {
            let y = self.y(oracle.error);
            let _ = write!(
                svg,
                "<path class=\"oracle\" d=\"M{LEFT} {y:.1}H{:.1}\"/><text class=\"soft\" x=\"{LEFT}\" y=\"{:.1}\" \
                 dx=\"4\">{BEST_LOBE}</text>",
                WIDTH - RIGHT,
                y + 13.0
            );
        }
    }
}

/// Returns 1, 2 and 5 times powers of ten between `least` and `most`, or both ends if fewer than two of these lie
/// between.
fn ticks(least: f64, most: f64) -> Vec<f64> {
    let powers = (-6..15).flat_map(|power| [1.0, 2.0, 5.0].map(|m| m * 10f64.powi(power)));
    let inside: Vec<f64> = powers.filter(|t| (least * 0.999..=most * 1.001).contains(t)).collect();
    match (inside.len(), least < most) {
        (0 | 1, true) => vec![least, most],
        (0 | 1, false) if least.is_finite() => vec![least],
        _ => inside,
    }
}
