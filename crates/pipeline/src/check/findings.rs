//! The table of all findings of `check`. `docs/findings.md` gives cause and remedy of each finding; a test compares the
//! two.

use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;

use serde::{Serialize, Serializer};

/// How bad a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// An engine shows the file wrongly or refuses it, or the file does not match its source.
    Error,
    /// Works in some engines only, or something was probably forgotten.
    Warning,
    /// Needs no action by itself.
    Note,
}

impl Severity {
    /// Returns the name used in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Warning => "warning",
            Self::Note => "note",
        }
    }
}

/// Declares the table: variant, number, severity, title.
macro_rules! codes {
    ($($variant:ident $number:literal $severity:ident $title:literal;)*) => {
        /// The kind of a finding. Numbers are grouped by hundreds, and a number is never reused for another kind.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Code {
            $(#[doc = $title] $variant = $number,)*
        }

        impl Code {
            /// All codes, in the order of their numbers.
            pub const ALL: &'static [Self] = &[$(Self::$variant,)*];

            /// Returns how bad the finding is.
            pub fn severity(self) -> Severity {
                match self { $(Self::$variant => Severity::$severity,)* }
            }

            /// Returns what is wrong, in a few words.
            pub fn title(self) -> &'static str {
                match self { $(Self::$variant => $title,)* }
            }
        }
    };
}

codes! {
    // 10xx: the KTX2 container (KTX File Format Specification 2.0).
    UnreadableTexture 1001 Error "the KTX2 file cannot be read";
    IncompleteChain 1002 Error "the mip chain is not complete";
    LevelOrder 1003 Error "levels are not stored smallest first, one after the other";
    LevelAlignment 1004 Error "a level is not aligned";
    LevelLength 1005 Error "the length of a level does not match its size and format";
    KeyOrder 1006 Error "keys are not sorted";
    KeyEntry 1007 Error "the key/value data is malformed";
    NoWriter 1008 Note "KTXwriter is missing";
    Orientation 1009 Error "KTXorientation is not rd";
    Swizzle 1010 Error "KTXswizzle is not rgba";
    Descriptor 1011 Error "the data format descriptor does not match the format";
    TypeSize 1012 Error "typeSize does not match the format";
    Transfer 1013 Error "the transfer function does not suit the texels";
    Primaries 1014 Error "the colour primaries do not suit the texels";
    // 11xx: KHR_texture_basisu, section "KTX v2 Images with Basis Universal Supercompression".
    NotBasis 1101 Warning "KHR_texture_basisu names a texture that is not Basis Universal";
    NotUastc 1102 Warning "the payload is ETC1S";
    Scheme 1103 Error "the supercompression scheme is not allowed for the payload";
    Channels 1104 Error "the payload's channels do not suit the texels";
    SizeMultiple 1105 Error "width or height is not a multiple of 4";
    NotPlain2d 1106 Error "the texture is not a plain 2D texture";
    AlphaPremultiplied 1107 Error "alpha is marked as premultiplied";
    // 12xx: glTF.
    UnreadableDocument 1201 Error "the glTF file cannot be read";
    MissingFile 1202 Error "a file that the document names cannot be read";
    BadReference 1203 Error "a reference in the document is invalid";
    NoImage 1204 Error "a texture has no image";
    DualSource 1205 Note "source and KHR_texture_basisu name the same KTX2";
    KtxMimeType 1206 Error "a core source is declared as image/ktx2";
    SourceFormat 1207 Warning "a core source is neither PNG nor JPEG";
    NotDeclared 1208 Error "an extension is used but not in extensionsUsed";
    NeedlesslyRequired 1209 Warning "KHR_texture_basisu is required though every texture has a fallback";
    NotRequired 1210 Error "a texture has no fallback but KHR_texture_basisu is not required";
    VendorRequired 1211 Error "the roughness pyramid extension is required";
    NoTangentSpace 1212 Error "anisotropy without a normal texture or tangents";
    LeftOver 1213 Warning "no document names this baked texture";
    // 13xx: ROUGHCAST_materials_roughness_pyramid.
    ExtensionSchema 1301 Error "the extension does not satisfy its schema";
    ExtensionTexture 1302 Error "a texture of the extension has no KTX2 image";
    ExtensionContent 1303 Error "a texture of the extension has the wrong content";
    // 14xx: texels.
    UndecodableLevel 1401 Error "a level cannot be decoded";
    NormalLength 1402 Error "normals are not of unit length";
    NotFinite 1403 Error "texels are NaN or infinite";
    PyramidLevel 1404 Error "the first level of a pyramid does not explain another level";
    // 15xx: provenance.
    NoProvenance 1501 Note "the texture has no provenance";
    BadProvenance 1502 Error "the provenance cannot be read";
    OtherVersion 1503 Note "the texture was baked by another version";
    MissingSource 1504 Error "a source cannot be read";
    Stale 1505 Error "a source has changed since the bake";
    Untraceable 1506 Warning "without provenance, the texture cannot be compared with its sources";
    OtherSettings 1507 Warning "the recorded settings differ from the current ones";
    OldVersion 1508 Error "the texture was baked by a version below --min-version";
    NewerVersion 1509 Warning "the texture was baked by a newer version";
    LobeError 1510 Note "the lobe error is above --max-error";
    NoOutput 1511 Warning "a source has no output";
    NothingBaked 1512 Note "nothing of the document is baked";
}

impl Code {
    /// Returns whether baking the asset again removes the finding.
    pub fn is_fixed_by_bake(self) -> bool {
        !matches!(
            self,
            Self::NotBasis
                | Self::DualSource
                | Self::SourceFormat
                | Self::NoTangentSpace
                | Self::LeftOver
                | Self::MissingSource
                | Self::NewerVersion
                | Self::LobeError
        )
    }
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "RC{:04}", *self as u16)
    }
}

impl FromStr for Code {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let code = Self::ALL.iter().find(|code| code.to_string().eq_ignore_ascii_case(text));
        code.copied().ok_or_else(|| format!("expected the number of a finding, such as RC1207, found {text:?}"))
    }
}

impl Serialize for Code {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// One problem or note about one file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// The kind of the finding.
    pub code: Code,
    /// How bad the finding is.
    pub severity: Severity,
    /// The file.
    pub file: String,
    /// Where in the file: a JSON pointer, `level <n>`, `key <name>` and the like; empty for the whole file.
    pub place: String,
    /// What was expected, what was found, what to do.
    pub message: String,
}

/// How many findings of one kind are listed for one file. One further finding gives the number of the rest.
pub const MAX_LISTED: usize = 20;

/// Length limit of a place or message, in characters. Names inside a file may be as long as the file.
const MAX_CHARACTERS: usize = 1000;

/// Collects findings during a check.
pub struct Findings {
    file: String,
    /// Place of an image inside the file; empty when the findings are about the file itself.
    within: String,
    list: Vec<Finding>,
    /// Number of findings of each file and kind, listed or not.
    counts: BTreeMap<(String, Code), usize>,
}

impl Findings {
    /// Collects findings about `file`.
    pub fn new(file: impl Into<String>) -> Self {
        Self { file: file.into(), within: String::new(), list: Vec::new(), counts: BTreeMap::new() }
    }

    /// Makes later findings refer to `file`, or to the image at `within` inside `file`.
    pub fn set_file(&mut self, file: impl Into<String>, within: impl Into<String>) {
        (self.file, self.within) = (file.into(), within.into());
    }

    /// Adds a finding. If the findings are about an image inside a document, `place` is relative to that image.
    pub fn add(&mut self, code: Code, place: impl AsRef<str>, message: impl Into<String>) {
        let count = self.counts.entry((self.file.clone(), code)).or_default();
        *count += 1;
        if *count > MAX_LISTED {
            return;
        }
        let parts = [self.within.as_str(), place.as_ref()];
        let place = parts.into_iter().filter(|p| !p.is_empty()).collect::<Vec<_>>().join(", ");
        let (severity, file) = (code.severity(), self.file.clone());
        self.list.push(Finding { code, severity, file, place: shortened(place), message: shortened(message.into()) });
    }

    /// Returns the findings in the order in which they were added. After the findings of each file, one further finding
    /// for each kind gives the number of those that are not listed.
    pub fn into_list(self) -> Vec<Finding> {
        let mut more: BTreeMap<String, Vec<(Code, usize)>> = BTreeMap::new();
        for ((file, code), count) in self.counts.into_iter().filter(|(_, count)| *count > MAX_LISTED) {
            more.entry(file).or_default().push((code, count - MAX_LISTED));
        }
        let mut list = Vec::with_capacity(self.list.len());
        let mut rest = self.list.into_iter().peekable();
        while let Some(finding) = rest.next() {
            let ended = rest.peek().is_none_or(|next| next.file != finding.file).then(|| finding.file.clone());
            list.push(finding);
            let Some(file) = ended else { continue };
            for (code, count) in more.remove(&file).into_iter().flatten() {
                let message = format!("expected to list every place, found {count} more than the {MAX_LISTED} above");
                let (severity, place) = (code.severity(), String::new());
                list.push(Finding { code, severity, file: file.clone(), place, message });
            }
        }
        list
    }
}

/// Cuts a text to [`MAX_CHARACTERS`].
fn shortened(mut text: String) -> String {
    if let Some((end, _)) = text.char_indices().nth(MAX_CHARACTERS) {
        text.truncate(end);
        text.push_str("...");
    }
    text
}
