//! The graph of parts and joints: its loops, and a spanning tree of what lies on them.

use crate::{Layout, Part, Tree};

/// A joint walked from the part that is placed to the one it places.
#[derive(Clone, Copy, Debug)]
pub struct WalkedJoint {
    /// The joint.
    pub joint: usize,
    /// The part that is placed already; `None` for the world.
    pub from: Option<Part>,
    /// The part it places.
    pub to: Part,
    /// Whether that is the joint's parent.
    pub to_parent: bool,
}

/// Parts on loops that are tied together by joints, the world apart.
#[derive(Clone, Debug, Default)]
pub struct LoopGroup {
    /// Parts that move freely: one of each piece that no joint of the tree ties to the world. Couplings alone tie pieces to each other.
    pub roots: Vec<Part>,
    /// The joints of the tree, in the order of the walk.
    pub links: Vec<WalkedJoint>,
    /// The joints that close loops, in order of declaration.
    pub closing: Vec<usize>,
}

/// The groups of a scene that have loops. The tree takes joints in the order of declaration, so that the last one closes the loop; those of a
/// given tree before the others.
pub fn groups(layout: &Layout, given: Option<&Tree>) -> Vec<LoopGroup> {
    let graph = JointGraph::new(layout, given);
    let mut groups: Vec<LoopGroup> = Vec::new();
    let mut seen = vec![false; graph.parts.len()];
    for start in 1..graph.parts.len() {
        if graph.core[start] && !seen[start] {
            groups.push(graph.walk(start, &mut seen));
        }
    }
    for edge in graph.edges.iter().filter(|edge| !edge.tree) {
        let part = edge.nodes.iter().find_map(|&node| graph.parts[node]);
        let own = |group: &&mut LoopGroup| part.is_some_and(|part| group.holds(part));
        if let Some(group) = groups.iter_mut().find(own) {
            group.closing.push(edge.joint);
        }
    }
    groups.retain(|group| !group.closing.is_empty());
    groups
}

impl LoopGroup {
    fn holds(&self, part: Part) -> bool {
        self.roots.contains(&part) || self.links.iter().any(|link| link.to == part)
    }
}

struct JointEdge {
    joint: usize,
    /// What it sits on: parent and child first, each once; 0 is the world.
    nodes: Vec<usize>,
    tree: bool,
    core: bool,
}

struct JointGraph {
    /// The world, then every part that joints hold.
    parts: Vec<Option<Part>>,
    edges: Vec<JointEdge>,
    /// Whether a part lies on a loop, or between two.
    core: Vec<bool>,
}

impl JointGraph {
    fn new(layout: &Layout, given: Option<&Tree>) -> Self {
        let mut parts: Vec<Option<Part>> = vec![None];
        let mut edges = Vec::new();
        let mut leader: Vec<usize> = vec![0];
        let mut joints: Vec<_> = layout
            .joints
            .iter()
            .enumerate()
            .filter(|(_, s)| s.len > 0)
            .collect();
        joints.sort_by_key(|&(joint, _)| given.is_some_and(|tree| tree.carried(joint).is_none()));
        for (joint, slots) in joints {
            let mut nodes: Vec<usize> = Vec::new();
            for &end in slots.ends.iter() {
                let known = parts.iter().position(|&part| part == end);
                let node = known.unwrap_or_else(|| {
                    parts.push(end);
                    leader.push(leader.len());
                    leader.len() - 1
                });
                if !nodes.contains(&node) {
                    nodes.push(node);
                }
            }
            // A coupling places nothing.
            let placing = slots.ends.len() == 2;
            let (a, b) = (leader[nodes[0]], leader[nodes[1]]);
            if placing {
                for other in &mut leader {
                    if *other == a.max(b) {
                        *other = a.min(b);
                    }
                }
            }
            edges.push(JointEdge {
                joint,
                nodes,
                tree: placing && a != b,
                core: true,
            });
        }
        let mut graph = JointGraph {
            core: vec![true; parts.len()],
            parts,
            edges,
        };
        graph.peel();
        graph
    }

    /// Takes away what hangs on one joint only, again and again.
    fn peel(&mut self) {
        loop {
            let mut degree = vec![0; self.parts.len()];
            for edge in self.edges.iter().filter(|edge| edge.core) {
                edge.nodes.iter().for_each(|&node| degree[node] += 1);
            }
            let before = self.core.clone();
            for (core, degree) in self.core.iter_mut().zip(degree) {
                *core &= degree > 1;
            }
            for edge in &mut self.edges {
                edge.core &= edge.nodes.iter().all(|&node| self.core[node]);
            }
            if self.core == before {
                return;
            }
        }
    }

    /// Everything the tree reaches from a part without passing through the world; by breadth, from the world where it touches it.
    fn walk(&self, start: usize, seen: &mut [bool]) -> LoopGroup {
        let mut members = vec![start];
        seen[start] = true;
        let mut next = 0;
        // Tied by any joint, of the tree or closing: their rows depend on each other.
        while let Some(&node) = members.get(next) {
            next += 1;
            for edge in self.edges.iter().filter(|edge| edge.core) {
                for &to in edge.nodes.iter().filter(|_| edge.nodes.contains(&node)) {
                    if to != 0 && !std::mem::replace(&mut seen[to], true) {
                        members.push(to);
                    }
                }
            }
        }
        let mut group = LoopGroup::default();
        let mut placed = vec![false; self.parts.len()];
        // From the world, then from a part of every piece that it does not reach.
        for root in std::iter::once(0).chain(members.iter().copied()) {
            if std::mem::replace(&mut placed[root], true) {
                continue;
            }
            group.roots.extend(self.parts[root]);
            let mut open = vec![root];
            let mut next = 0;
            while let Some(&node) = open.get(next) {
                next += 1;
                for edge in self.edges.iter().filter(|edge| edge.tree && edge.core) {
                    let (a, b) = (edge.nodes[0], edge.nodes[1]);
                    for (from, to, to_parent) in [(a, b, false), (b, a, true)] {
                        let own = from == node && to != 0 && members.contains(&to);
                        if !own || std::mem::replace(&mut placed[to], true) {
                            continue;
                        }
                        if let Some(part) = self.parts[to] {
                            group.links.push(WalkedJoint {
                                joint: edge.joint,
                                from: self.parts[from],
                                to: part,
                                to_parent,
                            });
                            open.push(to);
                        }
                    }
                }
            }
        }
        group
    }
}
