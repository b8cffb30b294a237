//! Long programs in kernels: same operations, same order, shared shapes.

mod scenes;

use std::collections::HashSet;

use mbd_compiler::{
    EmitSettings, Kernels, NameSpans, Op, Operand, Program, Registers, SceneEquations, Solution,
    emit_model, partition, read_text,
};
use mbd_scene::{AngularVelocity, At, Gravity, Layout, Place, Quantity, Scene};
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
        SceneEquations::trace(scene)
            .programs
            .into_iter()
            .map(|(_, program)| program)
    };
    all.iter().flat_map(of).collect()
}

#[test]
fn blocks_do_the_same_operations_in_the_same_order() {
    let mut cuts = 0;
    for program in programs() {
        let Some(blocks) = partition(&program) else {
            assert!(program.instructions.len() <= 1000);
            continue;
        };
        cuts += 1;
        let is_mask = |index: usize| matches!(program.instructions[index].op, Op::Compare(..));
        let mut next = 0;
        let mut known: HashSet<usize> = HashSet::new();
        for block in &blocks {
            let mut inside = HashSet::new();
            for &index in &block.instructions {
                for argument in program.instructions[index].op.arguments() {
                    let local = match program.operand(argument) {
                        Operand::Constant(_) => block.constants.contains(&argument),
                        Operand::Slot(_) => block.given.contains(&argument),
                        Operand::Value(value) => {
                            inside.contains(&value)
                                || (block.given.contains(&argument) && known.contains(&value))
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
            assert!(block.instructions.len() <= 1000);
            known.extend(block.results.iter().map(|&at| block.instructions[at]));
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
        let equations = SceneEquations::trace_only(&scene, &laws);
        let kernels = Kernels::of(&equations);
        let operations: usize = kernels
            .kernels
            .iter()
            .map(|kernel| {
                let (program, block) = kernel.first;
                let driver = kernels.drivers[program].as_ref().expect("cut");
                driver.blocks[block].instructions.len()
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

/// What the documentation of a kernel says is a part of `COST`: a product in a sum is two operations in both.
#[test]
fn a_product_in_a_sum_counts_as_two_in_the_documentation_of_its_kernel() {
    let equations = SceneEquations::trace(&string_of_bodies(12));
    let kernels = Kernels::of(&equations);
    let text = emit_model(&equations, &NameSpans::default(), &EmitSettings::default());
    let text = text.to_string();
    let said: Vec<usize> = text
        .split(" operations.\"")
        .filter_map(|before| {
            let terms = before.rsplit_once("Terms of ")?.1;
            terms.rsplit_once(": ")?.1.parse().ok()
        })
        .collect();
    let mut fused = 0;
    let counted: Vec<usize> = kernels
        .kernels
        .iter()
        .map(|kernel| {
            let (program, block) = kernel.first;
            let driver = kernels.drivers[program].as_ref().expect("cut");
            let ops = &driver.blocks[block].pattern;
            let products = ops.iter().filter(|op| matches!(op, Op::Fused(..))).count();
            fused += products;
            ops.len() + products
        })
        .collect();
    assert!(fused > 0 && said == counted, "{said:?} {counted:?}");
}

#[test]
fn no_place_of_a_call_is_outside_the_working_list() {
    for scene in scenes::all().into_iter().chain([string_of_bodies(30)]) {
        let equations = SceneEquations::trace(&scene);
        let kernels = Kernels::of(&equations);
        for driver in kernels.drivers.iter().flatten() {
            let mut begin =
                driver.work - driver.blocks.iter().map(|p| p.results.len()).sum::<usize>();
            for run in &driver.calls {
                for round in 0..run.rounds {
                    for (index, item) in run.items.iter().enumerate() {
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
                            .block(run, round, index)
                            .expect("a block")
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
        let equations = SceneEquations::trace_only(&scene, &[Quantity::Derivative]);
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

/// Identical rods on spherical joints, as a declaration.
fn spherical(count: usize) -> SceneEquations {
    beside_stones(count, 0)
}

/// The same beside bodies that fall.
fn beside_stones(count: usize, stones: usize) -> SceneEquations {
    let text = format!(
        "model Chain {{
            gravity: [0.0, 0.0, -9.81] m/s^2;
            body rod[i in 0..{count}] {{ mass: 1 kg, inertia: diag(0.085, 0.085, 0.001) kg*m^2,
                frame top at [0, 0, 0.5] m, frame end at [0, 0, -0.5] m }}
            joint hold: spherical from world to rod[0].top;
            joint pin[i in 1..{count}]: spherical from rod[i - 1].end to rod[i].top;
            body stone[i in 0..{stones}] {{ mass: 1 kg, inertia: diag(0.1, 0.2, 0.25) kg*m^2 }}
            joint fall[i in 0..{stones}]: free from world to stone[i].com;
        }}"
    );
    let reading = read_text(&text);
    SceneEquations::trace(&reading.scene.expect("a scene"))
}

#[test]
fn sixty_four_jointed_bodies_are_no_more_code_than_eight_twice_and_no_function_is_long() {
    let measured = |count: usize| {
        let equations = spherical(count);
        let kernels = Kernels::of(&equations);
        let lengths = kernels.lengths(&equations);
        let calls = kernels.drivers.iter().flatten();
        let calls: usize = calls.map(|driver| driver.items().count()).sum();
        let longest = lengths.iter().max().copied().unwrap_or_default();
        (lengths.iter().sum::<usize>(), calls, longest)
    };
    let [eight, many, more] = [8, 64, 128].map(measured);
    assert!(many.0 <= 2 * eight.0, "{many:?} against {eight:?}");
    assert!(20 * more.0 <= 21 * many.0, "{more:?} against {many:?}");
    assert!(20 * more.1 <= 21 * many.1, "{more:?} against {many:?}");
    assert!(more.2 <= 1000 && many.2 <= 1000 && eight.2 <= 1000);
}

#[test]
fn the_system_is_solved_once_for_accelerations_multipliers_and_reactions() {
    let state = |layout: &Layout| -> Vec<f64> {
        let spread = |index: usize| (index * 7919 % 97) as f64 / 97.0 - 0.3;
        (0..layout.nx()).map(spread).collect()
    };
    // The derivative of 3 rods and some stones fits one function, but not with all the rest.
    for (count, stones, members) in [(3, 0, 3), (3, 10, 2), (12, 0, 3)] {
        let equations = beside_stones(count, stones);
        let flat = count == 3;
        let solution = Solution::of(&equations).expect("three quantities");
        assert_eq!(
            solution.members.len(),
            members,
            "{count} rods, {stones} stones: {}",
            solution.program.instructions.len()
        );
        let x = state(&equations.layout);
        let at = At::of_state(0.0, &x, &[]);
        let run = |program: &Program| {
            let mut out = vec![0.0; program.len];
            let mut registers = Registers::new(program.registers());
            let derived = vec![0.5; equations.derived.len];
            program.run(&at, &[], &derived, &mut registers, &mut out);
            out
        };
        for &member in &solution.members {
            let alone = run(equations.program(member.what).expect("traced"));
            assert!(alone.iter().any(|&value| value != 0.0));
            let together = run(&solution.view(member));
            let bits = |list: &[f64]| list.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&alone), bits(&together), "{:?}", member.what);
        }
        let length = |what: Quantity| equations.program(what).map_or(0, |p| p.instructions.len());
        let (whole, first) = (
            solution.program.instructions.len(),
            length(solution.members[0].what),
        );
        assert!(4 * whole <= 5 * first, "{whole} operations after {first}");
        // Kernels of the elimination serve all members.
        let kernels = Kernels::of(&equations);
        assert_eq!(kernels.solution.is_some(), solution.is_flat());
        assert_eq!(solution.is_flat(), flat);
        let drivers = kernels.drivers.iter().flatten();
        let shared = drivers.filter(|driver| driver.shared.is_some()).count();
        assert_eq!(shared, if flat { 0 } else { members });
    }
}

/// A chain of links in relative coordinates about axes that are parallel or cross, with a quantity of its tip.
fn hanging(links: usize, crossed: bool) -> String {
    let joints = (0..links).map(|link| {
        let from = match link {
            0 => "world".to_owned(),
            _ => format!("link[{}].tip", link - 1),
        };
        let axis = if crossed && link % 2 == 1 { "x" } else { "y" };
        format!("joint pin{link}: hinge from {from} to link[{link}].top {{ axis: {axis} }}\n")
    });
    let joints: String = joints.collect();
    format!(
        "model Hanging {{
            gravity: [0.0, 0.0, -9.81] m/s^2;
            coordinates: relative;
            emit: [outputs, partial];
            body link[i in 0..{links}] {{ mass: 1.0 kg, inertia: diag(0.08, 0.08, 0.001) kg*m^2,
                frame top at [0.0, 0.0, 0.5] m, frame tip at [0.0, 0.0, -0.5] m }}
            {joints}
            output tip = link[{}].tip.velocity;
        }}",
        links - 1
    )
}

/// Equations, their derivatives, the factor and solutions by it, outputs: all that `emit: [outputs, partial]` writes.
#[test]
fn twice_as_long_a_chain_in_relative_coordinates_is_at_most_twice_as_much_code() {
    for crossed in [false, true] {
        let lengths = [16, 32, 64, 128, 256].map(|links| {
            let reading = mbd_compiler::read_text(&hanging(links, crossed));
            assert!(reading.errors.is_empty(), "{:?}", reading.errors);
            mbd_compiler::emit(&reading).to_string().len()
        });
        println!("crossed {crossed}: {lengths:?} letters");
        for pair in lengths.windows(2) {
            assert!(pair[1] < 2 * pair[0], "{lengths:?}");
        }
        // From where loops stand for everything, a link more is the same few calls and numbers, and a row of the names of the tables.
        let [_, _, long, longer, _] = lengths;
        assert!(longer < long + long / 2, "{lengths:?}");
    }
}
