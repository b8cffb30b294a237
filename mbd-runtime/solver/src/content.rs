//! What the rows of a history hold.

/// What a row holds besides the time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Content {
    /// All coordinates of the state; what the quaternions, and in a scene with joints Φ and Φ̇, are off by: the largest row, rows without unit
    /// counted as metres.
    pub state: bool,
    /// Positions of nodes that are not part of the state, velocities of `rate` nodes.
    pub nodes: bool,
    /// Tension [N] and stretch [m] of every line.
    pub lines: bool,
    /// Force [N] and torque [N m] of every joint on its child at the origin of its frame there, world axes. Where rows repeat others they are
    /// not unique, and the column says so: the rows that were left out carry nothing.
    pub reactions: bool,
    /// The declared outputs.
    pub outputs: bool,
    /// Kinetic, gravitational and elastic energy and their sum [J], power of loads, dampers and prescribed
    /// motions [W], and their work [J] when the run integrates it; in a scene whose events change something also the work of these actions [J].
    pub energy: bool,
}

impl Content {
    /// Everything.
    pub const ALL: Content = Content {
        state: true,
        nodes: true,
        lines: true,
        reactions: true,
        outputs: true,
        energy: true,
    };
    /// Line tensions and declared outputs only.
    pub const RESULTS: Content = Content {
        state: false,
        nodes: false,
        lines: true,
        reactions: false,
        outputs: true,
        energy: false,
    };
    /// Nothing else.
    pub const TIME: Content = Content {
        state: false,
        nodes: false,
        lines: false,
        reactions: false,
        outputs: false,
        energy: false,
    };

    /// Each of its groups of columns alone, in the order of the columns.
    pub fn groups(self) -> impl Iterator<Item = Content> {
        let of = Content::TIME;
        let all = [
            (self.state, Content { state: true, ..of }),
            (self.nodes, Content { nodes: true, ..of }),
            (self.lines, Content { lines: true, ..of }),
            (
                self.reactions,
                Content {
                    reactions: true,
                    ..of
                },
            ),
            (
                self.outputs,
                Content {
                    outputs: true,
                    ..of
                },
            ),
            (self.energy, Content { energy: true, ..of }),
        ];
        all.into_iter()
            .filter_map(|(has, group)| has.then_some(group))
    }

    /// What either holds.
    #[must_use]
    pub fn and(self, other: Content) -> Content {
        Content {
            state: self.state || other.state,
            nodes: self.nodes || other.nodes,
            lines: self.lines || other.lines,
            reactions: self.reactions || other.reactions,
            outputs: self.outputs || other.outputs,
            energy: self.energy || other.energy,
        }
    }
}
