//! Time against the number of workers, on logarithmic axes, as SVG that follows the reader's light or dark setting.

use std::fmt::Write;

use super::farm::Farm;
use super::jobs::{Cache, actions};
use super::{COUNTS, FARM, WORKERS, number};

/// The frame of the plot, in pixels.
const LEFT: f64 = 64.0;
const TOP: f64 = 44.0;
const WIDTH: f64 = 560.0;
const HEIGHT: f64 = 340.0;

/// Seconds at the bottom and at the top, with ticks at familiar times.
const LEAST: f64 = 1.0;
const MOST: f64 = 3e6;
const TICKS: [(f64, &str); 6] =
    [(1.0, "1 s"), (10.0, "10 s"), (60.0, "1 min"), (3600.0, "1 h"), (86_400.0, "1 d"), (864_000.0, "10 d")];

/// Blue and orange of M. Okabe, K. Ito, "Color universal design", 2008, lighter in dark mode.
const STYLE: &str = "svg{--ink:#1c2430;--soft:#6b7480;--grid:#e3e6ea;--paper:#ffffff;--cold:#0060a8;--warm:#b34700}\
    @media(prefers-color-scheme:dark){svg{--ink:#e8ebef;--soft:#9aa3ae;--grid:#333a44;--paper:#14181d;--cold:#6cbcf2;\
    --warm:#f0a35e}}text{font:11px system-ui,sans-serif;fill:var(--ink)}.title{font-weight:600;font-size:13px}\
    .soft{fill:var(--soft)}.paper{fill:var(--paper)}path{fill:none}.grid{stroke:var(--grid)}\
    .cold{stroke:var(--cold);stroke-width:1.8}.warm{stroke:var(--warm);stroke-width:1.8}\
    .ideal{stroke:var(--cold);stroke-width:1;stroke-dasharray:3 3;opacity:.6}text.cold{fill:var(--cold);stroke:none}\
    text.warm{fill:var(--warm);stroke:none}";

/// Draws the chart.
pub fn chart() -> String {
    let (width, height) = (LEFT + WIDTH + 130.0, TOP + HEIGHT + 52.0);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
         width=\"{width}\" height=\"{height}\"><style>{STYLE}</style>\
         <rect class=\"paper\" width=\"100%\" height=\"100%\"/>\
         <text class=\"title\" x=\"{LEFT}\" y=\"18\">Time of a bake against workers, simulated</text>\
         <text class=\"soft\" x=\"{LEFT}\" y=\"34\">\
         store of 100 Gbit/s; dashed: cold, were workers the only limit</text>"
    );
    for (seconds, label) in TICKS {
        let y = y(seconds);
        let _ = write!(
            svg,
            "<path class=\"grid\" d=\"M{LEFT} {y:.1}h{WIDTH}\"/>\
             <text class=\"soft\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>",
            LEFT - 6.0,
            y + 4.0
        );
    }
    let bottom = TOP + HEIGHT;
    for workers in [10, 100, 1000, 10_000] {
        let x = x(workers);
        let _ = write!(
            svg,
            "<path class=\"grid\" d=\"M{x:.1} {TOP}V{bottom}\"/>\
             <text class=\"soft\" x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{workers}</text>",
            bottom + 16.0
        );
    }
    let _ = write!(
        svg,
        "<text class=\"soft\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">workers</text>",
        LEFT + WIDTH / 2.0,
        bottom + 36.0
    );
    for count in COUNTS {
        for (class, cache) in [("cold", Cache::Cold), ("warm", Cache::Warm)] {
            let points = WORKERS.map(|workers| (workers, Farm { workers, ..FARM }.run(actions(count, cache)).seconds));
            line(&mut svg, class, &points);
            // Both lines end at one point where the store limits both runs, so their labels are shifted apart.
            let (shift, (workers, seconds)) = (if class == "cold" { -2.0 } else { 11.0 }, points[points.len() - 1]);
            let _ = write!(
                svg,
                "<text class=\"{class}\" x=\"{:.1}\" y=\"{:.1}\">{} {class}</text>",
                x(workers) + 6.0,
                y(seconds) + shift,
                number(count)
            );
        }
        let work: f64 = actions(count, Cache::Cold).map(|action| action.work + FARM.overhead).sum();
        line(&mut svg, "ideal", &WORKERS.map(|workers| (workers, work / workers as f64)));
    }
    svg + "</svg>\n"
}

fn line(svg: &mut String, class: &str, points: &[(usize, f64)]) {
    let _ = write!(svg, "<path class=\"{class}\" d=\"");
    for (index, (workers, seconds)) in points.iter().enumerate() {
        let _ = write!(svg, "{}{:.1} {:.1}", if index == 0 { 'M' } else { 'L' }, x(*workers), y(*seconds));
    }
    svg.push_str("\"/>");
}

fn x(workers: usize) -> f64 {
    LEFT + WIDTH * (workers as f64 / 10.0).log10() / 3.0
}

fn y(seconds: f64) -> f64 {
    TOP + HEIGHT * (1.0 - (seconds.max(LEAST) / LEAST).ln() / (MOST / LEAST).ln())
}
