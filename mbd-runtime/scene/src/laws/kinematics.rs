//! Where everything is and how it moves at one instant: what every law reads first.

use std::sync::OnceLock;

use nalgebra::Vector3;

use crate::laws::body::BodyMotion;
use crate::laws::evaluation::Evaluation;
use crate::laws::formula::Value;
use crate::laws::ground;
use crate::laws::numbers::Numbers;
use crate::laws::origin::Origin;
use crate::tree::{self, LinkMotion};
use crate::{At, FrameMotion, Layout, Real, Scene};

/// Motions of the bodies and of the frames of the world. Carries nothing from call to call.
#[derive(Clone, Debug)]
pub struct Kinematics<S: Real> {
    motions: Vec<BodyMotion<S>>,
    links: Vec<LinkMotion<S>>,
    ground: Vec<Option<FrameMotion<S>>>,
    networks: Vec<OnceLock<Vec<Vector3<S>>>>,
    lets: Vec<OnceLock<Value<S>>>,
}

impl<S: Real> Kinematics<S> {
    /// Room for the scene of a layout.
    pub fn new(layout: &Layout) -> Self {
        Kinematics {
            motions: vec![BodyMotion::unknown(); layout.bodies.len()],
            links: vec![
                LinkMotion::unknown();
                layout.tree.as_ref().map_or(0, |tree| tree.links.len())
            ],
            ground: Vec::new(),
            networks: vec![OnceLock::new(); layout.networks.len()],
            lets: vec![OnceLock::new(); layout.lets],
        }
    }

    /// Reads them at an instant; nothing of the solved system.
    pub fn read<'a>(
        &'a mut self,
        scene: &'a Scene,
        layout: &'a Layout,
        numbers: &'a Numbers<S>,
        at: &'a At<'a, S>,
    ) -> Evaluation<'a, S> {
        ground(scene, numbers, at.time, &mut self.ground);
        let origin = scene.runs.origin.map(|_| Origin::read(layout, at));
        if layout.tree.is_some() {
            let scene = (scene, layout, numbers);
            let world = (&self.ground[..], origin);
            tree::read(scene, at, world, &mut self.links, &mut self.motions);
        } else {
            for (body, slots) in layout.own_bodies() {
                S::section(&scene.bodies[body].name);
                self.motions[body] = BodyMotion::read(
                    at.state,
                    slots,
                    layout.nq,
                    layout.directions,
                    scene.angular_velocity,
                );
            }
        }
        self.networks.fill(OnceLock::new());
        self.lets.fill(OnceLock::new());
        Evaluation {
            scene,
            layout,
            numbers,
            at,
            motions: &self.motions,
            links: &self.links,
            ground: &self.ground,
            networks: &self.networks,
            lets: &self.lets,
            multipliers: &[],
            reactions: &[],
            accelerations: &[],
            body_accelerations: &[],
            balanced: &[],
            origin,
        }
    }
}
