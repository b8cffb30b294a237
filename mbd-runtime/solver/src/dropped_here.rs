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
