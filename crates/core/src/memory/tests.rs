use super::*;

#[test]
fn refuses_more_than_the_address_space() {
    assert_eq!(check(u64::MAX), Err(OutOfMemory { bytes: u64::MAX }));
    assert!(filled(usize::MAX / 2, 0u64).is_err());
    assert!(with_capacity::<u8>(usize::MAX).is_err());
}

#[test]
fn allocates_what_fits() {
    assert_eq!(filled(3, 7u8), Ok(vec![7; 3]));
    assert_eq!(filled(2 << 20, 7u8).map(|v| v.len()), Ok(2 << 20));
    assert!(with_capacity::<u32>(1 << 20).is_ok_and(|v| v.is_empty() && v.capacity() >= 1 << 20));
}

#[test]
fn the_message_names_mebibytes() {
    assert!(OutOfMemory { bytes: (3 << 20) + 1 }.to_string().starts_with("expected 4 MiB of free memory, found less;"));
}
