//! A short number for a long text.

/// FNV-1a of 64 bits: the same on every machine and in every version. Tells texts apart; keeps nothing secret.
#[must_use]
pub fn fingerprint(bytes: impl IntoIterator<Item = u8>) -> u64 {
    let mixed = |hash: u64, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    bytes.into_iter().fold(0xcbf2_9ce4_8422_2325, mixed)
}

#[cfg(test)]
mod tests {
    use super::fingerprint;

    #[test]
    fn published_values_are_met() {
        // Fowler, Noll, Vo: test vectors of FNV-1a.
        assert_eq!(fingerprint([]), 0xcbf2_9ce4_8422_2325);
        assert_eq!(fingerprint(*b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(fingerprint(*b"foobar"), 0x85944171_f73967e8);
    }
}
