//! What is not in a scene costs nothing: operations are counted by hand and must come out exactly.
//!
//! Costs are written [additions, multiplications, divisions, roots, trigonometric functions, selections].

use fuzz::random_scene::random_scene;
use mbd_compiler::{Op, Operand, Program, SceneEquations, Slot};
use mbd_scene::{Cost, Layout, Quantity, Variable};
use tests::declared::{cost, derived_cost, operations, read};

/// An undamped line between two places that move, in the state derivative.
///
/// ```text
/// e = p_to − p_from          3 additions                     d = √(e·e)         3 mul, 2 add, 1 root
/// 1/max(d, tiny)             1 div, 1 sel                    u = e/d            3 mul
/// s = max(d, tiny) − L0      1 add                           pull = K s         1 mul
/// T = hold > 0 ? pull : hold < 0 ? 0 : max(pull, 0)          2 comparisons, 2 selects, 1 maximum
/// force = T u                3 mul
/// ```
const LINE: [usize; 6] = [6, 10, 1, 1, 0, 6];

/// Damping of such a line: ṡ = u·(v_to − v_from) 3 mul, 5 add; + C ṡ 1 mul, 1 add; "only while s > 0" one comparison and one select.
const DAMPING: [usize; 6] = [6, 4, 0, 0, 0, 2];

/// The acceleration of a point on which two lines pull: 3 additions of forces, 3 mul by 1/m, 1 addition of g (along z).
const POINT: [usize; 6] = [4, 3, 0, 0, 0, 0];

/// An undamped line of a static or stepwise node: as [`LINE`], but T = K_e max(d − L_e, 0) has one selection in place of five.
const NODE_LINE: [usize; 6] = [6, 10, 1, 1, 0, 2];

/// One line in the balance of a node, 3 nodes' worth of load and sums left out.
///
/// ```text
/// e, d, 1/d, u, s            6 add, 6 mul, 1 div, 1 root, 1 sel       T = K_e max(s, 0)     1 mul, 1 sel
/// force                      3 mul                                    into g                3 add
/// taut = 0 ≤ s               1 sel                                    τ = L_e > 0 ? T/d : K_e, if taut: 1 mul, 3 sel
/// along = (K_e if taut) − τ  1 add, 1 sel                             along u               3 mul
/// J = τ 1 + (along u) uᵀ     6 mul, 3 add
/// K_e (d + |p|₁) if taut     1 add, 1 mul, 1 sel                      1 if s > 0            2 sel
/// ```
const BALANCE_LINE: [usize; 6] = [14, 21, 1, 1, 0, 10];

/// What every line after the first adds to the sums: H 6, ΣT 1, scale 1, count 1.
const BALANCE_SUMS: [usize; 6] = [9, 0, 0, 0, 0, 0];

/// |p|₁ of a node: 3 absolute values, 2 additions.
const REACH: [usize; 6] = [2, 0, 0, 0, 0, 3];

fn sum(parts: &[(usize, [usize; 6])]) -> Cost {
    operations(std::array::from_fn(|kind| {
        parts.iter().map(|(times, part)| times * part[kind]).sum()
    }))
}

/// Three points in a chain between two anchors: four lines, the first of them damped or not.
fn chain(damping: &str) -> String {
    format!(
        "model Chain {{
            gravity: [0.0, 0.0, -9.81] m/s^2;
            world {{ frame left at [-2.0, 0.5, 1.0] m, frame right at [2.0, 0.3, 1.5] m, }}
            point a {{ mass: 2.0 kg }}
            point b {{ mass: 3.0 kg }}
            point c {{ mass: 5.0 kg }}
            line first from world.left to a {{ free_length: 0.7 m, stiffness: 900 N/m }}
            line second from a to b {{ free_length: 0.8 m, stiffness: 800 N/m{damping} }}
            line third from b to c {{ free_length: 0.9 m, stiffness: 700 N/m }}
            line fourth from c to world.right {{ free_length: 0.6 m, stiffness: 600 N/m }}
        }}"
    )
}

#[test]
fn a_scene_of_three_points_and_four_lines_carries_no_rotation() {
    let scene = read(&chain(""));
    let layout = Layout::new(&scene);
    assert_eq!(
        (layout.nq, layout.nv, layout.nz),
        (9, 9, 0),
        "three coordinates a point, no quaternion"
    );
    assert_eq!(
        cost(&scene, Quantity::Derivative),
        sum(&[(4, LINE), (3, POINT)])
    );
    let equations = SceneEquations::trace(&scene);
    assert_eq!(equations.cost().trigs, 0);
    assert_eq!(equations.derived.cost().total(), 0, "every constant folds");
    let network = |what: &&(Quantity, Program)| {
        matches!(
            what.0,
            Quantity::AnchorStates
                | Quantity::Equilibrium(_)
                | Quantity::Balance
                | Quantity::NodeByAnchor(_)
                | Quantity::CondensedStiffness(_)
        )
    };
    assert_eq!(equations.programs.iter().find(network), None, "no node");
    let kinematics = equations.kinematics.expect("q̇ = v");
    assert_eq!(kinematics.cost().total(), 0, "q̇ is copied");
}

#[test]
fn removing_a_line_removes_its_operations() {
    let scene = read(&chain(""));
    let mut fewer = scene.clone();
    fewer.lines.pop();
    // The line itself, and the 3 additions that joined its force to the other one at `c`. What is left there is −f, whose sign folds
    // into the constant 1/m.
    let removed = sum(&[(1, LINE), (1, [3, 0, 0, 0, 0, 0])]);
    let after = cost(&fewer, Quantity::Derivative);
    assert_eq!(after + removed, cost(&scene, Quantity::Derivative));
    // Guards: stretch and pull of the line, without u and T: e 3, d 5 and a root, max(d, tiny) 1, s 1, K s 1.
    let removed = operations([6, 4, 0, 1, 0, 1]);
    let after = cost(&fewer, Quantity::Guards);
    assert_eq!(after + removed, cost(&scene, Quantity::Guards));
}

#[test]
fn removing_a_damping_constant_removes_the_rate_of_that_line() {
    let undamped = read(&chain(""));
    let damped = read(&chain(", damping: 20 N*s/m"));
    let zero = read(&chain(", damping: 0 N*s/m"));
    let what = Quantity::Derivative;
    assert_eq!(
        cost(&undamped, what) + operations(DAMPING),
        cost(&damped, what)
    );
    assert_eq!(
        cost(&undamped, what),
        cost(&zero, what),
        "a damping declared zero is none"
    );
}

/// A ring of four lines that hold a node below a body.
fn hung(node: &str, load: &str) -> String {
    format!(
        "model Hung {{
            gravity: [0.0, 0.0, -9.81] m/s^2;
            world {{
                frame a at [1.0, 0.0, 2.0] m,
                frame b at [-1.0, 0.2, 2.0] m,
                frame c at [0.1, 1.0, 2.1] m,
            }}
            body drum {{ mass: 3.0 kg, inertia: diag(0.1, 0.2, 0.3) kg*m^2, frame top at [0.0, 0.0, 0.2] m }}
            joint free_drum: free from world to drum.com;
            point knot {{ equilibrium: {node} }}
            line one from world.a to knot {{ free_length: 1.0 m, stiffness: 900 N/m, damping: 9 N*s/m }}
            line two from world.b to knot {{ free_length: 1.0 m, stiffness: 900 N/m, damping: 9 N*s/m }}
            line three from knot to world.c {{ free_length: 1.0 m, stiffness: 900 N/m, damping: 9 N*s/m }}
            line four from knot to drum.top {{ free_length: 0.4 m, stiffness: 900 N/m, damping: 9 N*s/m }}
            {load}
        }}"
    )
}

#[test]
fn a_node_found_with_the_derivative_measures_no_line_twice_and_costs_one_division() {
    let scene = read(&hung("rate", ""));
    let [alone, along] = [Quantity::Derivative, Quantity::Rates].map(|what| cost(&scene, what));
    // The derivative alone needs the line that pulls the drum, the node all four.
    assert_eq!([alone.sqrts, along.sqrts], [1, 4]);
    assert_eq!(along.divs, alone.divs + 3 + 1);
    // A load may depend on the velocity that is looked for, and the other models have none.
    let loaded = hung("rate", "load wind on knot = [1.0 N, 0.0 N, 0.0 N];");
    for other in [loaded, hung("stepwise", ""), chain("")] {
        let equations = SceneEquations::trace(&read(&other));
        assert_eq!(equations.program(Quantity::Rates), None);
    }
}

/// A body that floats free.
fn floater(gravity: &str, inertia: &str) -> String {
    format!(
        "model Floater {{
            gravity: {gravity};
            body drum {{ mass: 3.0 kg, inertia: {inertia}, }}
            joint loose: free from world to drum.com;
        }}"
    )
}

#[test]
fn a_free_body_costs_its_quaternion_rate_and_the_equation_of_euler() {
    let scene = read(&floater("none", "diag(2.0, 3.0, 4.0) kg*m^2"));
    // q̇ = ½ q ⊗ ω: −½ω 3 mul; four rows of 3 mul, 2 add.
    let quaternion = [6 + 2, 3 + 9 + 3, 0, 0, 0, 0];
    // ω̇ = I⁻¹ (I ω × ω), about principal axes (I_y − I_z) ω_y ω_z and so on: 3 mul, one more by the difference that is not 1, I⁻¹ 3 mul.
    // No rotation matrix: no torque is given in world axes.
    let euler = [0, 7, 0, 0, 0, 0];
    let derivative = cost(&scene, Quantity::Derivative);
    assert_eq!(derivative, sum(&[(1, quaternion), (1, euler)]));
    assert_eq!(
        cost(&scene, Quantity::Forces).total(),
        0,
        "nothing is applied"
    );
    assert_eq!(
        cost(&scene, Quantity::MassMatrix).total(),
        0,
        "the mass matrix in body components is constant"
    );
    assert!(!Layout::new(&scene).quantities().contains(&Quantity::Guards));
}

#[test]
fn removing_an_inertia_product_removes_the_terms_it_couples() {
    let full =
        "full { xx: 2.0, yy: 3.0, zz: 4.0, xy: 0.1, xz: 0.0, yz: 0.0 } kg*m^2 (matrix elements)";
    let (with, without) = (
        read(&floater("none", full)),
        read(&floater("none", "diag(2.0, 3.0, 4.0) kg*m^2")),
    );
    // I ω and I⁻¹ M each gain two products and two additions from the pair xy, yx; off principal axes the couple is I ω (3 mul) × ω (6 mul,
    // 3 add) in place of 4 mul.
    let product = operations([4 + 3, 4 + 5, 0, 0, 0, 0]);
    let what = Quantity::Derivative;
    assert_eq!(cost(&without, what) + product, cost(&with, what));
    let energy = operations([2, 2, 0, 0, 0, 0]);
    let what = Quantity::Energy;
    assert_eq!(cost(&without, what) + energy, cost(&with, what));
}

#[test]
fn gravity_that_is_not_declared_costs_nothing() {
    let inertia = "diag(2.0, 3.0, 4.0) kg*m^2";
    let none = read(&floater("none", inertia));
    let down = read(&floater("[0.0, 0.0, -9.81] m/s^2", inertia));
    let skew = read(&floater("[0.1, 0.2, -9.81] m/s^2", inertia));
    let what = Quantity::Derivative;
    assert_eq!(
        cost(&none, what),
        cost(&down, what),
        "without another force the acceleration is the constant g"
    );
    // Energy −m (g·r): one product an axis, joined by additions, times −m.
    let energy = Quantity::Energy;
    assert_eq!(
        cost(&none, energy) + operations([0, 2, 0, 0, 0, 0]),
        cost(&down, energy)
    );
    assert_eq!(
        cost(&none, energy) + operations([2, 4, 0, 0, 0, 0]),
        cost(&skew, energy)
    );
    // In a chain each point adds g to its acceleration, along every axis that has it.
    let scene = read(&chain(""));
    let mut weightless = scene.clone();
    weightless.gravity = mbd_scene::Gravity::None;
    assert_eq!(
        cost(&weightless, what) + operations([3, 0, 0, 0, 0, 0]),
        cost(&scene, what)
    );
}

#[test]
fn a_load_costs_what_it_says_and_one_that_is_not_declared_nothing() {
    let with = |load: &str| {
        let text = chain("");
        let end = text.rfind('}').expect("a model ends");
        read(&format!("{}{load}}}", &text[..end]))
    };
    let what = Quantity::Derivative;
    let none = cost(&with(""), what);
    // |v| 3 mul, 2 add, 1 root; times the constant 1 mul; times v 3 mul; joined to the forces of the lines 3 add.
    let drag = operations([5, 7, 0, 1, 0, 0]);
    let load = "load drag on a = -(0.3 kg/m) * norm(a.velocity) * a.velocity;";
    assert_eq!(none + drag, cost(&with(load), what));
    // The drag of `b` is another three coordinates: nothing is shared.
    let two = format!("{load} load drag_b on b = -(0.3 kg/m) * norm(b.velocity) * b.velocity;");
    assert_eq!(none + drag + drag, cost(&with(&two), what));
}

#[test]
fn asking_for_fewer_outputs_computes_fewer_terms() {
    let with = |outputs: &str| {
        let text = chain("");
        let end = text.rfind('}').expect("a model ends");
        read(&format!("{}{outputs}}}", &text[..end]))
    };
    let outputs = |text: &str| cost(&with(text), Quantity::Outputs);
    assert_eq!(
        outputs("output place = b.position;").total(),
        0,
        "a coordinate is copied"
    );
    let length = "output length = second.length;";
    // e 3 add, d 3 mul, 2 add, 1 root.
    assert_eq!(outputs(length), operations([5, 3, 0, 1, 0, 0]));
    let both = format!("{length} output tension = second.tension;");
    // max(d, tiny) 1, s 1 add, K s 1 mul, maximum, 2 comparisons, 2 selects, and the maximum that cuts what a mode holds below zero; the length is
    // shared.
    let tension = operations([1, 1, 0, 0, 0, 7]);
    assert_eq!(outputs(length) + tension, outputs(&both));
    let three = format!("{both} output rate = second.stretch_rate;");
    // u: 1 div, 3 mul; v_to − v_from 3 add; their product 3 mul, 2 add.
    let rate = operations([5, 6, 1, 0, 0, 0]);
    assert_eq!(outputs(&both) + rate, outputs(&three));
}

#[test]
fn asking_for_fewer_quantities_drops_their_programs_and_no_other() {
    let scene = read(&random_scene(3));
    let all = SceneEquations::trace(&scene);
    let wanted = [Quantity::Derivative, Quantity::Guards];
    let few = SceneEquations::trace_only(&scene, &wanted);
    assert_eq!(few.programs.len(), 2);
    for what in wanted {
        assert_eq!(
            few.program(what).map(Program::cost),
            all.program(what).map(Program::cost)
        );
    }
    assert!(few.cost().total() < all.cost().total());
    assert!(few.derived.cost().total() <= all.derived.cost().total());
}

/// A ball on a line, with a declaration of its mass, the free length and the drag.
fn ball(mass: &str, length: &str, area: &str) -> String {
    format!(
        "model Ball {{
            gravity: [0.0, 0.0, -9.81] m/s^2;
            world {{ frame hook at [0.1, 0.2, 2.0] m, }}
            const RHO = 1.2 kg/m^3;
            {mass} {length} {area}
            point ball {{ mass: m_ball }}
            line cord from world.hook to ball {{ free_length: l_cord, stiffness: 900 N/m }}
            load drag on ball = -0.5 * RHO * area * norm(ball.velocity) * ball.velocity;
        }}"
    )
}

#[test]
fn folding_a_param_to_a_const_removes_what_is_computed_per_set_of_params() {
    let live = [
        "param m_ball = 2.0 kg in 1 kg ..= 3 kg;",
        "param l_cord = 0.7 m in 0.0 m ..= 1.0 m;",
        "param area = 0.3 m^2 in 0.1 m^2 ..= 0.9 m^2;",
    ];
    let all = read(&ball(live[0], live[1], live[2]));
    let what = Quantity::Derivative;
    // 1/m: 1 div. −½ ρ is a number; times s: 1 mul. The weight m g_z of the bias force: 1 mul.
    assert_eq!(derived_cost(&all).divs, 1);
    let before = derived_cost(&all);
    let by_params = Quantity::Partial(mbd_scene::Differentiated::Derivative, Variable::Parameter);
    let mass = read(&ball("const m_ball = 2.0 kg;", live[1], live[2]));
    assert_eq!(derived_cost(&mass).divs, 0, "1/m folds");
    assert!(derived_cost(&mass).total() < before.total());
    assert_eq!(
        cost(&mass, what),
        cost(&all, what),
        "the state derivative multiplies by 1/m either way"
    );
    // ∂v̇/∂m = −f/m² goes away.
    assert!(cost(&mass, by_params).total() < cost(&all, by_params).total());
    let area = read(&ball(live[0], live[1], "const area = 0.3 m^2;"));
    assert_eq!(derived_cost(&area).muls + 1, before.muls, "−½ρ s folds");
    assert_eq!(cost(&area, what), cost(&all, what));
    let none = read(&ball(
        "const m_ball = 2.0 kg;",
        "const l_cord = 0.7 m;",
        "const area = 0.3 m^2;",
    ));
    assert_eq!(derived_cost(&none).total(), 0);
    assert_eq!(cost(&none, by_params).total(), 0, "no param, no derivative");
    assert_eq!(cost(&none, what), cost(&all, what));
    // Numbers that make a term vanish: L0 = 0 saves s = d − L0; m = 1 saves three products by 1/m.
    let slackless = read(&ball(
        "const m_ball = 2.0 kg;",
        "const l_cord = 0.0 m;",
        "const area = 0.3 m^2;",
    ));
    assert_eq!(
        cost(&slackless, what) + operations([1, 0, 0, 0, 0, 0]),
        cost(&none, what)
    );
    let unit = read(&ball(
        "const m_ball = 1.0 kg;",
        "const l_cord = 0.7 m;",
        "const area = 0.3 m^2;",
    ));
    assert_eq!(
        cost(&unit, what) + operations([0, 3, 0, 0, 0, 0]),
        cost(&none, what)
    );
}

/// A knot held by anchors, from which a ball hangs; `stays` of them.
fn knot(stays: usize) -> String {
    let lines: String = (0..stays)
        .map(|i| {
            format!(
                "line stay{i} from world.hook{i} to knot {{ free_length: 0.6 m, stiffness: 900 N/m }}\n"
            )
        })
        .collect();
    let hooks: String = (0..stays)
        .map(|i| format!("frame hook{i} at [{i}.5, {i}.2, 2.{i}] m, "))
        .collect();
    format!(
        "model Knot {{
            gravity: [0.0, 0.0, -9.81] m/s^2;
            world {{ {hooks} }}
            point knot {{ equilibrium: static }}
            point ball {{ mass: 2.0 kg }}
            {lines}
            line cord from ball to knot {{ free_length: 0.5 m, stiffness: 800 N/m }}
        }}"
    )
}

#[test]
fn every_line_of_a_node_costs_the_same_in_its_balance() {
    for stays in 2..6 {
        let scene = read(&knot(stays));
        let lines = stays + 1;
        // The load of the node is a slot: −W + f is 3 additions for every line, counted with it.
        assert_eq!(
            cost(&scene, Quantity::Equilibrium(0)),
            sum(&[(lines, BALANCE_LINE), (lines - 1, BALANCE_SUMS), (1, REACH)]),
            "{stays} stays"
        );
        // Only the line at the ball moves anything: its force by 1/m, and g.
        assert_eq!(
            cost(&scene, Quantity::Derivative),
            sum(&[(1, NODE_LINE), (1, [1, 3, 0, 0, 0, 0])]),
            "{stays} stays"
        );
    }
}

#[test]
fn removing_a_node_removes_its_balance_and_everything_around_it() {
    let mut scene = read(&knot(3));
    let before = Layout::new(&scene).quantities();
    assert!(before.contains(&Quantity::Equilibrium(0)));
    scene.points.remove(0);
    scene.lines.clear();
    let quantities = Layout::new(&scene).quantities();
    for what in quantities {
        assert!(
            !matches!(
                what,
                Quantity::AnchorStates
                    | Quantity::Balance
                    | Quantity::Equilibrium(_)
                    | Quantity::NodeByAnchor(_)
                    | Quantity::CondensedStiffness(_)
                    | Quantity::Partial(_, Variable::Node)
            ),
            "{what:?} needs a node"
        );
    }
    assert_eq!(
        cost(&scene, Quantity::Derivative).total(),
        0,
        "a ball in free fall: q̇ = v, v̇ = g"
    );
}

#[test]
fn no_instruction_depends_on_constants_alone() {
    for seed in 0..50 {
        let equations = SceneEquations::trace(&read(&random_scene(seed)));
        let programs = equations.programs.iter().map(|(_, program)| program);
        for program in programs.chain([&equations.derived]) {
            for instruction in &program.instructions {
                let constant = |register| matches!(program.operand(register), Operand::Constant(_));
                assert!(
                    !instruction.op.arguments().all(constant),
                    "scene {seed}, {:?}: {instruction:?}",
                    program.what
                );
            }
        }
    }
}

#[test]
fn no_instruction_of_a_quantity_depends_on_params_alone() {
    for seed in 0..50 {
        let equations = SceneEquations::trace(&read(&random_scene(seed)));
        for (what, program) in &equations.programs {
            for instruction in &program.instructions {
                // A comparison gives no number that could be kept.
                if matches!(instruction.op, Op::Compare(..)) {
                    continue;
                }
                let known = |register| {
                    matches!(
                        program.operand(register),
                        Operand::Constant(_) | Operand::Slot(Slot::Param(_) | Slot::Derived(_))
                    )
                };
                assert!(
                    !instruction.op.arguments().all(known),
                    "scene {seed}, {what:?}: {instruction:?}"
                );
            }
        }
    }
}
