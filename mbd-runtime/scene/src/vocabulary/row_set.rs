//! Sets of rows of one joint.

use serde::{Deserialize, Serialize};

/// A choice of a joint's rows: bit k stands for row k.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RowSet(
    /// The bits.
    pub u8,
);

impl RowSet {
    /// The first `count` rows.
    #[must_use]
    pub fn all(count: usize) -> Self {
        RowSet(u8::MAX.checked_shr(8 - count.min(8) as u32).unwrap_or(0))
    }

    /// Those of the first `count` rows.
    #[must_use]
    pub fn within(self, count: usize) -> Self {
        RowSet(self.0 & Self::all(count).0)
    }

    /// How many.
    #[must_use]
    pub fn len(self) -> usize {
        self.0.count_ones() as usize
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Whether row `row` is one of them.
    #[must_use]
    pub fn contains(self, row: usize) -> bool {
        row < 8 && self.0 & (1 << row) != 0
    }

    /// The rows, in order.
    pub fn rows(self) -> impl Iterator<Item = usize> {
        (0..8).filter(move |&row| self.contains(row))
    }
}

#[cfg(test)]
mod tests {
    use super::RowSet;

    #[test]
    fn a_set_of_rows_counts_and_lists_them() {
        let set = RowSet(0b10_1101);
        assert_eq!((set.len(), set.contains(1)), (4, false));
        assert_eq!(set.rows().collect::<Vec<_>>(), [0, 2, 3, 5]);
        assert_eq!(set.within(3), RowSet(0b101));
        assert_eq!(
            [0, 1, 6].map(RowSet::all),
            [RowSet(0), RowSet(1), RowSet(63)]
        );
    }
}
