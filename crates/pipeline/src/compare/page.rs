//! All charts and numbers as one HTML file. Radio buttons and CSS alone switch the cost axis.

use std::fmt::Write;

use super::chart::{self, Measure};
use super::units::amount;
use super::{Axis, Comparison};
use crate::text::xml_escaped;

const STYLE: &str = ":root{color-scheme:light dark}body{margin:0 auto;max-width:820px;padding:12px;\
    font:15px/1.45 system-ui,sans-serif;background:#fff;color:#1c2430}\
    @media(prefers-color-scheme:dark){body{background:#14181d;color:#e8ebef}}\
    .scroll{overflow-x:auto}.scroll>svg{display:block;width:100%;min-width:620px;height:auto}\
    table{border-collapse:collapse;font-size:13px;font-variant-numeric:tabular-nums}\
    th,td{padding:2px 8px;text-align:right;border-bottom:1px solid #8884;white-space:nowrap}\
    th:first-child,td:first-child{text-align:left}tr.chosen{font-weight:700}\
    label{display:inline-block;margin:0 12px 6px 0}h2,li{overflow-wrap:anywhere}\
    .verdicts{padding-left:1.2em;font-size:17px}.verdicts li{margin-bottom:6px}";

/// Formats `comparisons` as a page that names `version` of this tool.
pub fn page(comparisons: &[Comparison], version: &str) -> String {
    let mut html = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/>\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\
         <title>Error against cost</title><style>{STYLE}{}",
        chart::STYLE
    );
    for i in 0..Axis::ALL.len() {
        let _ = write!(html, "body:has(#axis{i}:checked) .axis:not(.axis{i}){{display:none}}");
    }
    html += "</style></head><body><h1>Error against cost</h1><ul class=\"verdicts\">";
    for Comparison { material, verdict, .. } in comparisons {
        let verdict = verdict.as_deref().unwrap_or("not known.");
        let _ = write!(html, "<li><b>{}</b>: {}</li>", xml_escaped(material), xml_escaped(verdict));
    }
    html += "</ul><p>Of both errors, lower is better. Lobe error: the share of reflected half-vectors in the wrong \
        place, 0 to 1. Circles are bakes of Roughcast, decoded as engines decode them. Squares are other tools' \
        formulas on exact moments, with our encoded normals. \
        The dashed line is the best single lobe. Picture error: the relative L1 of the radiance of a sphere at two \
        distances against a supersampled picture, 0 being equal; it has no best lobe, since none is searched for each \
        pixel. The ring marks the choice of <code>--model auto</code>. Bake times \
        vary from run to run.</p>\
        <fieldset><legend>Cost</legend>";
    for (i, axis) in Axis::ALL.iter().enumerate() {
        let checked = if i == 0 { " checked=\"\"" } else { "" };
        let _ = write!(
            html,
            "<label><input type=\"radio\" name=\"axis\" id=\"axis{i}\"{checked}/> {}</label>",
            axis.title()
        );
    }
    html += "</fieldset>";
    for comparison in comparisons {
        let _ = write!(html, "<h2>{}</h2>", xml_escaped(&comparison.material));
        for (i, axis) in Axis::ALL.into_iter().enumerate() {
            let svgs: String = Measure::of(comparison).iter().map(|m| chart::cost(comparison, axis, *m, 0.0)).collect();
            let _ = write!(html, "<div class=\"scroll axis axis{i}\" tabindex=\"0\">{svgs}</div>");
        }
        let _ = write!(html, "<div class=\"scroll\" tabindex=\"0\">{}</div>", chart::levels(comparison, 0.0));
        if let Some(noise) = comparison.picture_noise {
            let _ = write!(
                html,
                "<p>Pictures without any error would have a picture error of {noise:.3}, which is the noise of the \
                 truth.</p>"
            );
        }
        html += &table(comparison);
    }
    let _ = writeln!(html, "<p>roughcast {}</p></body></html>", xml_escaped(version));
    html
}

fn table(comparison: &Comparison) -> String {
    let mut html = "<div class=\"scroll\" tabindex=\"0\"><table><thead><tr><th>model</th><th>kind</th><th>chosen</th>\
        <th>lobe error</th><th>picture error</th>"
        .to_owned();
    Axis::ALL.iter().for_each(|axis| {
        let _ = write!(html, "<th>{}</th>", axis.title());
    });
    let levels = comparison.entries.iter().map(|e| e.level_errors.len()).max().unwrap_or(0);
    (0..levels).for_each(|level| {
        let _ = write!(html, "<th>level {level}</th>");
    });
    html += "</tr></thead><tbody>";
    for entry in &comparison.entries {
        html += if entry.chosen { "<tr class=\"chosen\">" } else { "<tr>" };
        let kind = format!("{:?}", entry.kind).to_lowercase();
        let chosen = if entry.chosen { "chosen" } else { "" };
        let picture_error = entry.picture_error.map_or(String::new(), |error| format!("{error:.3}"));
        let facts =
            [entry.shown_name().to_owned(), kind, chosen.to_owned(), format!("{:.3}", entry.error), picture_error];
        let costs = Axis::ALL.map(|axis| axis.value(&entry.cost).map_or(String::new(), |n| amount(axis, n)));
        let errors = entry.level_errors.iter().map(|e| format!("{e:.3}"));
        for cell in facts.into_iter().chain(costs).chain(errors) {
            let _ = write!(html, "<td>{}</td>", xml_escaped(&cell));
        }
        html += "</tr>";
    }
    html + "</tbody></table></div>"
}
