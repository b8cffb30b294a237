//! A short list on the stack: the laws of a step ask for no memory.

use std::ops::{Deref, DerefMut};

/// At most `N` items.
#[derive(Clone, Copy, Debug)]
pub struct Few<T, const N: usize> {
    items: [T; N],
    len: usize,
}

impl<T: Copy, const N: usize> Few<T, N> {
    /// An empty list; `filler` stands where no item is.
    #[must_use]
    pub fn new(filler: T) -> Self {
        Few {
            items: [filler; N],
            len: 0,
        }
    }

    /// Adds an item. What no longer fits is left out: `N` is the most that rows and freedoms of a joint can be.
    pub fn push(&mut self, item: T) {
        if let Some(place) = self.items.get_mut(self.len) {
            *place = item;
            self.len += 1;
        }
    }

    /// Takes all items out.
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Keeps the items for which `keep` holds, in order.
    pub fn retain(&mut self, mut keep: impl FnMut(&T) -> bool) {
        let all = *self;
        self.len = 0;
        all.iter()
            .filter(|item| keep(item))
            .for_each(|item| self.push(*item));
    }
}

impl<T: Copy, const N: usize> Extend<T> for Few<T, N> {
    fn extend<I: IntoIterator<Item = T>>(&mut self, items: I) {
        items.into_iter().for_each(|item| self.push(item));
    }
}

impl<T: PartialEq, const N: usize> PartialEq for Few<T, N> {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl<T: Eq, const N: usize> Eq for Few<T, N> {}

impl<T, const N: usize> Deref for Few<T, N> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        self.items.get(..self.len).unwrap_or_default()
    }
}

impl<T, const N: usize> DerefMut for Few<T, N> {
    fn deref_mut(&mut self) -> &mut [T] {
        self.items.get_mut(..self.len).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::Few;

    #[test]
    fn items_keep_their_order_and_what_does_not_fit_is_left_out() {
        let mut few: Few<u8, 4> = Few::new(0);
        few.extend(1..=6);
        assert_eq!(*few, [1, 2, 3, 4]);
        few.retain(|item| item % 2 == 0);
        assert_eq!(*few, [2, 4]);
        few.push(9);
        few[0] = 7;
        assert_eq!(*few, [7, 4, 9]);
    }
}
