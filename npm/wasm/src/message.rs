//! Messages: a header as JSON, and files as bytes.
//!
//! | bytes | content |
//! |---|---|
//! | 4 | length of the header, little endian |
//! | length of the header | the header, whose member `files` has an object with `path` and `length` for each file |
//! | sum of the lengths | the files, one after the other |

use serde::{Deserialize, Serialize};

/// A message that cannot be read.
#[derive(Debug)]
pub struct MessageError(String);

impl std::fmt::Display for MessageError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "expected a request, found {}; use the JavaScript of the same version", self.0)
    }
}

/// A file of a request.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct File<'m> {
    /// Its path, relative to the document.
    pub path: &'m str,
    /// Its content.
    pub bytes: &'m [u8],
}

/// The place of a file in a header.
#[derive(Deserialize, Serialize)]
struct Entry<'m> {
    path: &'m str,
    length: usize,
}

/// The part of a header that is the same in all messages.
#[derive(Deserialize)]
struct Header<'m> {
    #[serde(borrow)]
    files: Vec<Entry<'m>>,
}

/// Reads a message. Returns the text of its header, and its files.
pub fn read(message: &[u8]) -> Result<(&str, Vec<File<'_>>), MessageError> {
    let truncated = || MessageError("fewer bytes than it declares".to_owned());
    let (length, rest) = message.split_first_chunk::<4>().ok_or_else(truncated)?;
    let (text, mut rest) = rest.split_at_checked(u32::from_le_bytes(*length) as usize).ok_or_else(truncated)?;
    let text = str::from_utf8(text).map_err(|error| MessageError(error.to_string()))?;
    let header: Header<'_> = serde_json::from_str(text).map_err(|error| MessageError(error.to_string()))?;
    let mut files = Vec::with_capacity(header.files.len());
    for Entry { path, length } in header.files {
        let (bytes, after) = rest.split_at_checked(length).ok_or_else(truncated)?;
        files.push(File { path, bytes });
        rest = after;
    }
    Ok((text, files))
}

/// The header of a message with the places of its files.
#[derive(Serialize)]
struct WithFiles<'m, H> {
    #[serde(flatten)]
    header: &'m H,
    files: Vec<Entry<'m>>,
}

/// Writes a message with its own length before it, in four bytes, little endian. `header` is an object as JSON.
pub fn write(header: &impl Serialize, files: &[(String, Vec<u8>)]) -> serde_json::Result<Vec<u8>> {
    let entries = files.iter().map(|(path, bytes)| Entry { path, length: bytes.len() }).collect();
    // Without a `Value` in between, which would widen the numbers of single precision.
    let header = serde_json::to_string(&WithFiles { header, files: entries })?;
    let length = 4 + header.len() + files.iter().map(|(_, bytes)| bytes.len()).sum::<usize>();
    let mut message = Vec::with_capacity(4 + length);
    for length in [length, header.len()] {
        message.extend_from_slice(&(length as u32).to_le_bytes());
    }
    message.extend_from_slice(header.as_bytes());
    files.iter().for_each(|(_, bytes)| message.extend_from_slice(bytes));
    Ok(message)
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;

    fn request(header: &str, files: &[u8]) -> Vec<u8> {
        [&(header.len() as u32).to_le_bytes(), header.as_bytes(), files].concat()
    }

    #[test]
    fn reads_what_it_writes() {
        let files = [("a.png".to_owned(), vec![1, 2]), ("b/ü.bin".to_owned(), vec![]), ("c".to_owned(), vec![3])];
        let message = write(&json!({ "share": 0.1_f32 }), &files).expect("a message");
        assert_eq!(u32::from_le_bytes(message[..4].try_into().unwrap()) as usize, message.len() - 4);
        let (text, read) = read(&message[4..]).expect("a message");
        assert_eq!(serde_json::from_str::<Value>(text).unwrap()["files"].as_array().unwrap().len(), 3);
        assert_eq!(read.iter().map(|f| (f.path.to_owned(), f.bytes.to_vec())).collect::<Vec<_>>(), files);
    }

    #[test]
    fn every_truncation_is_refused() {
        let message = request(r#"{"files":[{"path":"a","length":3}]}"#, &[1, 2, 3]);
        assert!(read(&message).is_ok());
        for length in 0..message.len() {
            assert!(read(&message[..length]).is_err(), "{length}");
        }
    }

    #[test]
    fn lengths_beyond_the_message_are_refused() {
        assert!(read(&request(r#"{"files":[{"path":"a","length":18446744073709551615}]}"#, &[0])).is_err());
        assert!(read(&[255; 8]).is_err());
    }
}
