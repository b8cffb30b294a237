//! Long programs in kernels: same operations, same order, shared shapes.

mod scenes;

use std::collections::HashSet;

use mbd_compiler::{Equations, Kernels, Op, Operand, Program, outline};
use mbd_scene::{AngularVelocity, Gravity, Layout, Place, Quantity, Scene};
use scenes::{body, frame, line, numbers};

/// Equal bodies that hang from each other by lines.
fn string_of_bodies(count: usize) -> Scene {
    let mut scene = Scene {
        name: "String".into(),
        angular_velocity: AngularVelocity::Body,
        gravity: Gravity::Uniform {
            acceleration: numbers([0.0, 0.0, -9.81]),
        },
        world_frames: vec![frame("world", [0.0; 3])],
        ..Scene::default()
    };
    for index in 0..count {
        let ends = vec![
            frame("top", [0.0, 0.1, 0.5]),
            frame("bottom", [0.1, 0.0, -0.5]),
        ];
        scene.bodies.push(body(
            &format!("link[{index}]"),
            (1.0 + index as f64).into(),
            [1.0, 2.0, 2.5, 0.1, 0.2, 0.3],
            ends,
        ));
        let above = if index == 0 {
            Place::World(0)
        } else {
            Place::Body(index - 1, 2)
        };
        let law = [(100.0 + index as f64).into(), 1.0.into(), 0.2.into()];
        scene.lines.push(line(
            &format!("tie[{index}]"),
            above,
            Place::Body(index, 1),
            law,
        ));
    }
    scene
}

fn programs() -> Vec<Program> {
    let mut all = scenes::all();
    all.push(string_of_bodies(12));
    let of = |scene: &Scene| {
        Equations::trace(scene)
            .programs
            .into_iter()
            .map(|(_, program)| program)
    };
    all.iter().flat_map(of).collect()
}

#[test]
fn pieces_do_the_same_operations_in_the_same_order() {
    let mut cuts = 0;
    for program in programs() {
        let Some(pieces) = outline(&program) else {
            assert!(program.instructions.len() <= 1000);
            continue;
        };
        cuts += 1;
        let is_mask = |index: usize| matches!(program.instructions[index].op, Op::Compare(..));
        let mut next = 0;
        let mut known: HashSet<usize> = HashSet::new();
        for piece in &pieces {
            let mut inside = HashSet::new();
            for &index in &piece.instructions {
                for argument in program.instructions[index].op.arguments() {
                    let local = match program.operand(argument) {
                        Operand::Constant(_) => piece.constants.contains(&argument),
                        Operand::Slot(_) => piece.given.contains(&argument),
                        Operand::Value(value) => {
                            inside.contains(&value)
                                || (piece.given.contains(&argument) && known.contains(&value))
                        }
                    };
                    assert!(local, "{:?}: an argument comes from nowhere", program.what);
                }
                inside.insert(index);
                // A mask may be compared again; everything else is computed once, in order.
                if index == next {
                    next += 1;
                } else {
                    assert!(is_mask(index) && index < next, "{:?}", program.what);
                }
            }
            assert!(piece.instructions.len() <= 1000);
            known.extend(piece.results.iter().map(|&at| piece.instructions[at]));
        }
        assert_eq!(next, program.instructions.len());
        for &(_, register) in &program.outputs {
            if let Operand::Value(value) = program.operand(register) {
                assert!(
                    known.contains(&value),
                    "{:?}: a result is lost",
                    program.what
                );
            }
        }
    }
    assert!(cuts > 5, "the scenes are large enough to be cut");
}

#[test]
fn equal_bodies_share_their_kernels_and_their_calls_are_loops() {
    let code = |count: usize| {
        let scene = string_of_bodies(count);
        let mut laws = Layout::new(&scene).quantities();
        laws.retain(|what| !matches!(what, Quantity::Partial(..)));
        let equations = Equations::trace_only(&scene, &laws);
        let kernels = Kernels::of(&equations);
        let operations: usize = kernels
            .kernels
            .iter()
            .map(|kernel| {
                let (program, piece) = kernel.first;
                let driver = kernels.drivers[program].as_ref().expect("cut");
                driver.pieces[piece].instructions.len()
            })
            .sum();
        let drivers = kernels.drivers.iter().flatten();
        let items = drivers.map(|driver| driver.items().count()).sum::<usize>();
        (operations, items)
    };
    let (forty, eighty) = (code(40), code(80));
    assert_eq!(
        forty, eighty,
        "twice as many bodies, not one operation more"
    );
}

#[test]
fn no_place_of_a_call_is_outside_the_working_list() {
    for scene in scenes::all().into_iter().chain([string_of_bodies(30)]) {
        let equations = Equations::trace(&scene);
        let kernels = Kernels::of(&equations);
        for driver in kernels.drivers.iter().flatten() {
            let mut begin =
                driver.work - driver.pieces.iter().map(|p| p.results.len()).sum::<usize>();
            for cycle in &driver.calls {
                for round in 0..cycle.rounds {
                    for (index, item) in cycle.items.iter().enumerate() {
                        let place = |at: usize| {
                            let rounds = isize::try_from(round).expect("few");
                            item.at[at]
                                .checked_add_signed(item.step[at] * rounds)
                                .expect("a place")
                        };
                        assert_eq!(place(0), begin, "blocks follow one another");
                        for (at, window) in kernels.kernels[item.key].windows.iter().enumerate() {
                            assert!(
                                place(at + 1) + window.len <= begin,
                                "read before it is written"
                            );
                        }
                        begin += driver
                            .piece(cycle, round, index)
                            .expect("a piece")
                            .results
                            .len();
                    }
                }
            }
            assert_eq!(begin, driver.work);
        }
    }
}

#[test]
fn the_cost_of_a_string_grows_with_its_length() {
    let total = |count: usize| {
        let scene = string_of_bodies(count);
        let equations = Equations::trace_only(&scene, &[Quantity::Derivative]);
        equations
            .program(Quantity::Derivative)
            .expect("traced")
            .cost()
            .total()
    };
    let (eight, sixteen, thirty_two) = (total(8), total(16), total(32));
    assert_eq!(
        thirty_two - sixteen,
        2 * (sixteen - eight),
        "linear to the operation"
    );
}
