//! All pictures of a folder on one HTML page, which refers to the picture files beside it. Radio buttons and CSS alone
//! switch the enlarged picture, so that the arrow keys of the keyboard do, too.

use std::fmt::Write;
use std::path::Path;

use super::columns::title_of;
use super::report::{ColumnReport, RowReport, SheetReport};
use crate::gltf::uri::encode_path;
use crate::text::xml_escaped;

const STYLE: &str = include_str!("gallery.css");

/// The most columns of a row: plain, two bakes and the supersampled picture.
const COLUMNS: usize = 4;

/// Formats `sheets` as a page that names `version` of this tool.
pub fn page(sheets: &[SheetReport], version: &str) -> String {
    let mut html = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/>\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\
         <title>Pictures of materials</title><style>{STYLE}"
    );
    for i in 0..COLUMNS {
        let _ = write!(html, ".row:has(.k{i}:checked) .stage img:not(.c{i}){{display:none}}");
    }
    html += "</style></head><body><h1>Pictures of materials</h1>\
        <p>Each material with plain mips, baked, and supersampled, which is the truth. The error is the relative L1 of \
        linear radiance: lower is better, and the noise of the truth is the least error that can be told from 0. SSIM \
        is the structural similarity of what is displayed: higher is better. Choose a picture to see it enlarged; the \
        arrow keys change between the pictures in place.</p>";
    html += &overview(sheets);
    let mut rows = 0;
    for (index, sheet) in sheets.iter().enumerate() {
        let (title, file) = (xml_escaped(&sheet.title), source(&sheet.path));
        let _ = write!(html, "<section id=\"s{index}\"><h2>{title}</h2>");
        if sheet.rows.is_empty() {
            let _ = write!(html, "<img src=\"{file}\" alt=\"{title}\"/>");
        } else {
            let _ = write!(html, "<p><a href=\"{file}\">All of these pictures as one file</a></p>");
        }
        for row in &sheet.rows {
            html += &enlarged(row, &sheet.title, rows);
            rows += 1;
        }
        html += "</section>";
    }
    let _ = writeln!(html, "<p class=\"soft\">roughcast {}</p></body></html>", xml_escaped(version));
    html
}

/// Returns a table of all errors.
fn overview(sheets: &[SheetReport]) -> String {
    let names = |sheet: &SheetReport| sheet.rows.iter().flat_map(|row| row.columns.iter().map(|c| c.name)).collect();
    let mut columns: Vec<&str> = sheets.iter().flat_map(names as fn(&SheetReport) -> Vec<&str>).collect();
    columns.sort_by_key(|name| ["plain", "portable", "pyramid"].iter().position(|n| n == name));
    columns.dedup();
    if columns.is_empty() {
        return String::new();
    }
    let mut html =
        "<div class=\"scroll\" tabindex=\"0\"><table><caption class=\"soft\">Error of each picture, lower is \
        better; the least of a row is bold</caption><thead><tr><th>material and scene</th><th>distance</th>"
            .to_owned();
    for name in &columns {
        let _ = write!(html, "<th>{}</th>", title_of(name));
    }
    html += "<th>noise of the truth</th></tr></thead><tbody>";
    for (index, sheet) in sheets.iter().enumerate() {
        for RowReport { distance, columns: shown, noise, .. } in &sheet.rows {
            let title = xml_escaped(&sheet.title);
            let _ = write!(html, "<tr><td><a href=\"#s{index}\">{title}</a></td><td>{distance}</td>");
            let errors = || shown.iter().map(|column| format!("{:.3}", column.difference.relative_l1));
            let least = errors().min().unwrap_or_default();
            for name in &columns {
                let error = shown.iter().zip(errors()).find(|(column, _)| column.name == *name).map(|(_, error)| error);
                let class = if error.as_ref() == Some(&least) { " class=\"best\"" } else { "" };
                let _ = write!(html, "<td{class}>{}</td>", error.unwrap_or_default());
            }
            let _ = write!(html, "<td class=\"soft\">{noise:.3}</td></tr>");
        }
    }
    html + "</tbody></table></div>"
}

/// Returns the pictures of a row, and below them the chosen one, enlarged, with its region.
fn enlarged(row: &RowReport, title: &str, index: usize) -> String {
    let mut pictures: Vec<(&str, &str, String)> = Vec::new();
    for ColumnReport { name, path, difference } in &row.columns {
        let labels = format!(
            "<span>error {:.3}, lower is better</span><span class=\"soft\">SSIM {:.3}, higher is better</span>",
            difference.relative_l1, difference.ssim
        );
        pictures.push((title_of(name), path, labels));
    }
    let noise = format!("<span class=\"soft\">noise {:.3}</span>", row.noise);
    pictures.push((title_of("supersampled"), &row.supersampled, noise));
    let [width, height] = row.size;
    let mut html = format!(
        "<fieldset class=\"row\"><legend>distance {}</legend><div class=\"strip\" role=\"radiogroup\">",
        row.distance
    );
    for (i, (name, path, labels)) in pictures.iter().enumerate() {
        let checked = if i == 0 { " checked=\"\"" } else { "" };
        let alt = xml_escaped(&format!("{title}, {name}"));
        let _ = write!(
            html,
            "<label><img src=\"{}\" width=\"{width}\" height=\"{height}\" loading=\"lazy\" alt=\"{alt}\"/>\
             <input type=\"radio\" name=\"r{index}\" class=\"k{i}\"{checked}/><b>{name}</b>{labels}</label>",
            source(path)
        );
    }
    html += "</div><div class=\"stage\"><figure class=\"whole\">";
    let images = |html: &mut String, style: &str| {
        for (i, (name, path, _)) in pictures.iter().enumerate() {
            let file = source(path);
            let _ = write!(html, "<img class=\"c{i}\" src=\"{file}\" loading=\"lazy\" alt=\"{name}\"{style}/>");
        }
    };
    images(&mut html, "");
    let share = |part: u32, whole: u32| 100.0 * f64::from(part) / f64::from(whole);
    let crop = &row.crop;
    let _ = write!(
        html,
        "<i style=\"left:{:.3}%;top:{:.3}%;width:{:.3}%;height:{:.3}%\"></i></figure>\
         <figure class=\"crop\" style=\"aspect-ratio:{}/{}\">",
        share(crop.left, width),
        share(crop.top, height),
        share(crop.width, width),
        share(crop.height, height),
        crop.width,
        crop.height
    );
    let style = format!(
        " style=\"width:{:.3}%;left:-{:.3}%;top:-{:.3}%\"",
        share(width, crop.width),
        share(crop.left, crop.width),
        share(crop.top, crop.height)
    );
    images(&mut html, &style);
    html + "</figure></div></fieldset>"
}

/// Returns the file name of `path` as a relative URL.
fn source(path: &str) -> String {
    let name = Path::new(path).file_name().unwrap_or_default().to_string_lossy();
    xml_escaped(&encode_path(&name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::{Crop, Difference, SceneName};

    fn sheet(title: &str, errors: &[(&'static str, f64)]) -> SheetReport {
        let column = |(name, relative_l1): &(&'static str, f64)| ColumnReport {
            name,
            path: format!("out/100% \"{name}\".png"),
            difference: Difference { relative_l1: *relative_l1, ssim: 0.5 },
        };
        let row = RowReport {
            distance: 4.0,
            columns: errors.iter().map(column).collect(),
            supersampled: "out/truth.png".to_owned(),
            noise: 0.01,
            size: [64, 32],
            crop: Crop { left: 16, top: 8, width: 16, height: 8 },
        };
        SheetReport {
            path: "out/sheet.png".to_owned(),
            title: title.to_owned(),
            material: Some("m".to_owned()),
            scene: SceneName::Sphere,
            rows: vec![row],
        }
    }

    #[test]
    fn the_least_error_of_a_row_is_bold() {
        let html = page(&[sheet("a", &[("plain", 0.3), ("portable", 0.1)]), sheet("b", &[("pyramid", 0.2)])], "0");
        assert!(html.contains("<td>0.300</td><td class=\"best\">0.100</td><td></td>"), "{html}");
        assert!(html.contains("<td></td><td></td><td class=\"best\">0.200</td>"), "{html}");
    }

    #[test]
    fn names_are_escaped_and_files_are_relative() {
        let html = page(&[sheet("<script>&", &[("plain", 0.3)])], "0");
        assert!(html.contains("&lt;script&gt;&amp;") && !html.contains("<script"), "{html}");
        assert!(html.contains("src=\"100%25%20%22plain%22.png\"") && !html.contains("out/"), "{html}");
    }

    #[test]
    fn the_region_is_shown_at_its_place() {
        let html = page(&[sheet("a", &[("plain", 0.3)])], "0");
        assert!(html.contains("left:25.000%;top:25.000%;width:25.000%;height:25.000%"), "{html}");
        assert!(html.contains("width:400.000%;left:-100.000%;top:-100.000%"), "{html}");
    }
}
