use super::*;

/// Codes 0, 10, 110 and a code of 12 bits, 1110 0000 0000.
fn table() -> Table {
    let mut counts = [0; 16];
    (counts[0], counts[1], counts[2], counts[11]) = (1, 1, 1, 1);
    Table::new(&counts, &[5, 6, 7, 8]).unwrap()
}

#[test]
fn codes_of_every_length_are_found() {
    // 0 10 110 1110_0000_0000, then 0 and seven ones.
    let bytes = [0b0101_1011, 0b1000_0000, 0b0001_1111, 0b1100_0000];
    let mut bits = Bits::new(&bytes, 0);
    let table = table();
    assert_eq!([5, 6, 7, 8, 5].map(Ok), std::array::from_fn(|_| bits.symbol(&table)));
    assert_eq!(bits.symbol(&table), Err(Fault::Ended));
    assert_eq!(Bits::new(&[0xfe; 4], 0).symbol(&table), Err(Fault::NoCode));
}

#[test]
fn stuffing_is_left_out_and_markers_end_the_bits() {
    let bytes = [0xab, 0xff, 0x00, 0xcd, 0xff, 0xd9, 0x12];
    let mut bits = Bits::new(&bytes, 0);
    assert_eq!(bits.number(16), Ok(0xabff));
    assert_eq!(bits.number(8), Ok(0xcd));
    assert_eq!(bits.number(1), Err(Fault::Ended));
    let mut bits = Bits::new(&bytes, 0);
    assert_eq!(bits.skip(24), Ok(()));
    assert_eq!(bits.skip(1), Err(Fault::Ended));
    assert_eq!(bits.end(), (4, 0));
}

#[test]
fn what_is_left_is_counted_unless_it_is_filling() {
    for (bytes, left) in [
        (&[0x7f, 0xff, 0xd9][..], 0),
        (&[0x7f, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xd9], 0),
        (&[0x7f, 0xff, 0, 0xff, 0, 0xff, 0xd9], 0),
        (&[0x7f, 0x12, 0x34, 0xff, 0xd9], 2),
        (&[0x7f, 0xff, 0, 0, 0xff, 0xd9], 2),
    ] {
        let mut bits = Bits::new(bytes, 0);
        bits.skip(3).unwrap();
        assert_eq!(bits.end(), (bytes.len() - 2, left), "{bytes:02x?}");
    }
}

#[test]
fn more_codes_than_their_lengths_allow_are_refused() {
    let mut counts = [0; 16];
    counts[0] = 3;
    assert!(Table::new(&counts, &[1, 2, 3]).is_none());
    counts = [255; 16];
    assert!(Table::new(&counts, &[0; 255 * 16]).is_none());
    counts = [0; 16];
    counts[3] = 2;
    assert!(Table::new(&counts, &[1]).is_none());
}
