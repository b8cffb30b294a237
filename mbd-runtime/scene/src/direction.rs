//! Characters that make a reader see another text than there is.

/// Whether a character turns the direction of writing (Unicode standard annex 9: marks, embeddings, overrides, isolates): no text that is shown or
/// generated has one.
#[must_use]
pub const fn turns_direction(character: char) -> bool {
    matches!(character, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overrides_and_isolates_turn_and_letters_of_any_script_do_not() {
        assert!("\u{202e}\u{2066}\u{200f}".chars().all(turns_direction));
        assert!(!"aé中אب–\u{fffd}".chars().any(turns_direction));
    }
}
