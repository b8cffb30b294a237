//! Starts of joints that are decided without them: they may be said again, and say the same.

use super::about::Wish;
use super::{CLOSED, JointStart, Placement, PlacementError};
use crate::Quantity;

impl Placement<'_> {
    /// Whether joints that are decided by others, or by the bodies they join, are where their own starts say, too.
    ///
    /// # Errors
    /// The first that is not.
    pub(super) fn confirm(
        &mut self,
        decided: &[usize],
        given: &[JointStart],
        state: &mut [f64],
    ) -> Result<(), PlacementError> {
        for &joint in decided {
            for start in given.iter().filter(|start| start.joint == joint) {
                let coordinate = start.coordinate;
                let said = start.value.map(|value| Wish {
                    joint,
                    coordinate,
                    value,
                });
                let place = said.is_none_or(|said| self.grants(&[said], state));
                let rate = start.rate.is_none_or(|rate| {
                    let told = self.rows(Quantity::Coordinates, state);
                    let own = told.get(self.place_in_coordinates(joint, coordinate) + 1);
                    let negligible = CLOSED.sqrt() * self.scale(joint, coordinate);
                    own.is_some_and(|own| (own - rate).abs() <= negligible)
                });
                if !place {
                    return Err(PlacementError::Decided { joint });
                }
                if !rate {
                    return Err(PlacementError::Moving { joint });
                }
            }
        }
        Ok(())
    }
}
