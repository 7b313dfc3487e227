//! Data URIs (RFC 2397).

use std::borrow::Cow;

use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use percent_encoding::percent_decode_str;

use super::UriError;

/// Base64 whose padding and unused last bits are not checked. They carry no data, and exporters differ in them.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_allow_trailing_bits(true)
        .with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// A data URI, still encoded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DataUri<'a> {
    mime: &'a str,
    base64: bool,
    payload: &'a str,
}

impl<'a> DataUri<'a> {
    /// Parses the text after `data:`.
    pub(super) fn parse(text: &'a str) -> Result<DataUri<'a>, UriError> {
        let (head, payload) = text.split_once(',').ok_or(UriError::NoComma)?;
        let mut fields = head.split(';').map(str::trim);
        let mime = fields.next().unwrap_or_default();
        let base64 = fields.next_back().is_some_and(|field| field.eq_ignore_ascii_case("base64"));
        Ok(DataUri { mime, base64, payload })
    }

    /// Returns the media type without its parameters, such as `image/png`. The text is empty if there is none.
    pub fn mime(&self) -> &'a str {
        self.mime
    }

    /// Decodes the data, if it has at most `limit` bytes. A lower bound of its length is computed from the text before
    /// anything is allocated.
    ///
    /// # Errors
    /// [`UriError::DataTooLarge`] and [`UriError::Base64`].
    pub fn decode(&self, limit: usize) -> Result<Vec<u8>, UriError> {
        // An escape takes three bytes of text for one byte of data or of base64.
        let escapes = self.payload.bytes().filter(|&byte| byte == b'%').count();
        let text = self.payload.len() - (2 * escapes).min(self.payload.len());
        let least = if self.base64 { (text / 4).saturating_sub(1) * 3 } else { text };
        if least > limit {
            return Err(UriError::DataTooLarge { limit });
        }
        let bytes = Cow::from(percent_decode_str(self.payload));
        let data = if self.base64 {
            BASE64.decode(&bytes).map_err(|source| UriError::Base64 { source })?
        } else {
            bytes.into_owned()
        };
        if data.len() > limit {
            return Err(UriError::DataTooLarge { limit });
        }
        Ok(data)
    }
}
