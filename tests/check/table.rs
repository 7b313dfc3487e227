//! Tests that each finding is documented and has a failing fixture.

use std::collections::BTreeSet;
use std::fs;

use roughcast::check::Code;

use crate::{documents, textures};

#[test]
fn every_code_has_a_fixture() {
    let tested: BTreeSet<Code> = textures::FIXTURES.iter().map(|f| f.0).chain(documents::codes()).collect();
    let all: BTreeSet<Code> = Code::ALL.iter().copied().collect();
    assert_eq!(tested, all);
}

/// Each finding has a heading `### <code> <severity>: <title>`, in order, a cause and a remedy.
#[test]
fn documentation_agrees_with_the_table() {
    let text = fs::read_to_string("docs/findings.md").unwrap();
    let sections: Vec<&str> = text.split("\n### ").skip(1).collect();
    let headings: Vec<&str> = sections.iter().map(|s| s.lines().next().unwrap()).collect();
    let expected: Vec<String> =
        Code::ALL.iter().map(|c| format!("{c} {}: {}", c.severity().name(), c.title())).collect();
    assert_eq!(headings, expected);
    for (section, code) in sections.into_iter().zip(Code::ALL) {
        assert!(section.contains("\nCause: ") && section.contains("\nRemedy: "), "{section}");
        let is_of_texels = (1400..1500).contains(&(*code as u16));
        assert_eq!(section.contains("\nNeeds: `--deep`."), is_of_texels, "{section}");
    }
}

#[test]
fn numbers_are_unique_and_rising() {
    assert!(Code::ALL.is_sorted_by(|a, b| (*a as u16) < (*b as u16)));
    assert_eq!(Code::UnreadableTexture.to_string(), "RC1001");
}
