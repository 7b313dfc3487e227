//! The frame of a JPEG: its components, their blocks, and the coefficients that scans have sent (ITU-T T.81, A.1 and
//! B.2.2).

use crate::image::jpeg::damage::Damage;
use crate::memory;

/// A frame of 8 x 8 blocks in up to four components.
pub(super) struct Frame {
    /// Whether coefficients come in several scans.
    pub is_progressive: bool,
    /// Blocks of all components.
    pub blocks: u64,
    /// Its components, in the order of the frame header.
    pub components: Vec<Component>,
    /// Columns and rows of MCUs in a scan of several components.
    pub mcus: (usize, usize),
}

/// A component of a frame.
pub(super) struct Component {
    /// Identifier of the component in scan headers.
    pub id: u8,
    /// Blocks of an MCU, across and down, in a scan of several components.
    pub sampling: (usize, usize),
    /// Columns and rows of blocks in a scan of this component alone.
    pub own: (usize, usize),
    /// Columns of blocks, including those that fill up the last MCU.
    pub stride: usize,
    /// The lowest bit that has been sent of each coefficient, in the order of transmission.
    sent: [Option<u8>; 64],
    /// The coefficients of each block that are not 0, as bits; empty unless the frame is progressive.
    pub nonzero: Vec<u64>,
}

impl Frame {
    /// Reads the body of a frame header.
    pub(super) fn read(body: &[u8], is_progressive: bool) -> Result<Self, Damage> {
        let header = body.first_chunk::<6>().ok_or(Damage::Malformed("frame header"))?;
        let side = |at: usize| usize::from(u16::from_be_bytes([header[at], header[at + 1]]));
        let (height, width) = (side(1), side(3));
        let (listed, _) = body[6..].as_chunks::<3>();
        let listed = listed.get(..usize::from(header[5])).ok_or(Damage::Malformed("frame header"))?;
        let sampling = |[_, factors, _]: &[u8; 3]| (usize::from(factors >> 4), usize::from(factors & 15));
        let factors = || listed.iter().map(sampling);
        let (h_max, v_max) = factors().fold((1, 1), |most, (h, v)| (most.0.max(h), most.1.max(v)));
        if listed.len() > 4 || factors().any(|(h, v)| !(1..=4).contains(&h) || !(1..=4).contains(&v)) {
            return Err(Damage::Malformed("sampling factors"));
        }
        let mcus = (width.div_ceil(8 * h_max), height.div_ceil(8 * v_max));
        let mut blocks = 0;
        let components = listed.iter().map(|listed| {
            let (h, v) = sampling(listed);
            let (stride, rows) = (mcus.0 * h, mcus.1 * v);
            blocks += (stride * rows) as u64;
            Ok(Component {
                id: listed[0],
                sampling: (h, v),
                own: ((width * h).div_ceil(8 * h_max), (height * v).div_ceil(8 * v_max)),
                stride,
                sent: [None; 64],
                nonzero: if is_progressive { memory::filled(stride * rows, 0)? } else { Vec::new() },
            })
        });
        let components = components.collect::<Result<Vec<_>, Damage>>()?;
        Ok(Self { is_progressive, blocks, components, mcus })
    }

    /// Returns whether every coefficient has been sent down to its last bit.
    pub(super) fn is_complete(&self) -> bool {
        self.components.iter().all(|component| component.sent.iter().all(|lowest| *lowest == Some(0)))
    }
}

impl Component {
    /// Records that a scan sends coefficients `first` to `last` down to bit `lowest`.
    pub(super) fn send(&mut self, first: u8, last: u8, lowest: u8) {
        let band = self.sent.get_mut(usize::from(first)..=usize::from(last));
        band.unwrap_or_default().fill(Some(lowest));
    }
}
