//! What is dropped by code of this crate, wherever its owner is dropped.

use std::fmt::{self, Debug, Formatter};
use std::mem::ManuallyDrop;
use std::ops::{Deref, DerefMut};

/// A value whose drop is compiled here alone.
///
/// What drops a value is compiled in every crate that does so, field by field: for a simulation three quarters of all functions of a crate that
/// runs a model of one hinge. Through the function that is kept here nothing of it is.
pub struct DroppedHere<P> {
    /// There until it is dropped.
    value: ManuallyDrop<Option<Box<P>>>,
    drop: fn(Box<P>),
}

impl<P: Clone> Clone for DroppedHere<P> {
    fn clone(&self) -> Self {
        DroppedHere {
            value: self.value.clone(),
            drop: self.drop,
        }
    }
}

impl<P: PartialEq> PartialEq for DroppedHere<P> {
    fn eq(&self, other: &Self) -> bool {
        P::eq(self, other)
    }
}

impl<P: Debug> Debug for DroppedHere<P> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        P::fmt(self, f)
    }
}

impl<P> DroppedHere<P> {
    /// Keeps it; this is called here, and nowhere else.
    pub(crate) fn new(value: P) -> Self {
        DroppedHere {
            value: ManuallyDrop::new(Some(Box::new(value))),
            drop,
        }
    }
}

impl<P> Drop for DroppedHere<P> {
    fn drop(&mut self) {
        if let Some(value) = self.value.take() {
            (self.drop)(value);
        }
    }
}

impl<P> Deref for DroppedHere<P> {
    type Target = P;

    fn deref(&self) -> &P {
        self.value.as_ref().expect("only its drop takes it away")
    }
}

impl<P> DerefMut for DroppedHere<P> {
    fn deref_mut(&mut self) -> &mut P {
        self.value.as_mut().expect("only its drop takes it away")
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::DroppedHere;

    #[test]
    fn what_is_kept_is_dropped_with_its_owner_and_copied_with_it() {
        let counted = Arc::new(2.0);
        let kept = DroppedHere::new(Arc::clone(&counted));
        let copy = kept.clone();
        assert_eq!((Arc::strong_count(&counted), **copy), (3, 2.0));
        assert_eq!(kept, copy);
        drop(kept);
        drop(copy);
        assert_eq!(Arc::strong_count(&counted), 1);
    }
}
