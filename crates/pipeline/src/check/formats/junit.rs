//! Reports as JUnit XML, which CI servers list as tests: a suite for each file, a case for each finding.

use std::io;

use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesText, Event};

use super::Report;
use crate::check::findings::{Finding, Severity};
use crate::text::xml_text;

/// Formats a report as JUnit XML, for CI servers. A file without errors and warnings is one case that passes. Notes are
/// written to the output of their suite.
///
/// # Errors
/// Strings cause none.
pub fn junit(report: &Report) -> io::Result<String> {
    let mut writer = Writer::new_with_indent(Vec::new(), b' ', 2);
    writer.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    writer.create_element("testsuites").with_attribute(("name", "roughcast check")).write_inner_content(|writer| {
        let left_out = |file: &&str| !report.files.iter().any(|known| known == file);
        let mut files: Vec<&str> = report.files.iter().map(String::as_str).collect();
        files.extend(report.findings.chunk_by(|a, b| a.file == b.file).map(|group| &*group[0].file).filter(left_out));
        files.into_iter().try_for_each(|file| suite(writer, file, report))
    })?;
    String::from_utf8(writer.into_inner()).map(|text| text + "\n").map_err(io::Error::other)
}

fn suite(writer: &mut Writer<Vec<u8>>, file: &str, report: &Report) -> io::Result<()> {
    let of_file = || report.findings.iter().filter(move |finding| finding.file == file);
    let (notes, failures): (Vec<&Finding>, Vec<&Finding>) = of_file().partition(|f| f.severity == Severity::Note);
    let (tests, failed) = (failures.len().max(1).to_string(), failures.len().to_string());
    let suite = writer.create_element("testsuite").with_attribute(("name", &*xml_text(file)));
    let suite = suite.with_attribute(("tests", &*tests)).with_attribute(("failures", &*failed));
    suite.with_attribute(("errors", "0")).write_inner_content(|writer| {
        if failures.is_empty() {
            let case = writer.create_element("testcase").with_attribute(("name", "check"));
            case.with_attribute(("classname", &*xml_text(file))).write_empty()?;
        }
        for finding in &failures {
            let name = format!("{} {}", finding.code, finding.place);
            let case = writer.create_element("testcase").with_attribute(("name", xml_text(name.trim_end()).as_str()));
            case.with_attribute(("classname", &*xml_text(file))).write_inner_content(|writer| {
                let failure = writer.create_element("failure").with_attribute(("message", finding.code.title()));
                let failure = failure.with_attribute(("type", finding.code.to_string().as_str()));
                failure.write_text_content(BytesText::new(&xml_text(&finding.message))).map(|_| ())
            })?;
        }
        if !notes.is_empty() {
            let line = |note: &&Finding| format!("{} {}: {}\n", note.code, note.place, note.message);
            let lines: String = notes.iter().map(line).collect();
            writer.create_element("system-out").write_text_content(BytesText::new(&xml_text(&lines)))?;
        }
        Ok(())
    })?;
    Ok(())
}
