//! How many of each thing a scene has, its freedoms, and what is ambiguous in it.

use mbd_runtime::scene::{Formula, Gravity, Layout, Scene};

use mbd_report::ReportTable;

/// How many of each thing the scene has.
#[must_use]
pub fn counts(scene: &Scene) -> ReportTable {
    let layout = Layout::new(scene);
    let lines = |one_way: bool| {
        let kinds = scene.lines.iter().map(|line| line.kind);
        kinds.filter(|kind| kind.is_unilateral() == one_way).count()
    };
    let locks = layout.joints.iter().filter(|slots| slots.held.is_some());
    let locks = locks.count();
    let rows: [(&str, usize); 19] = [
        ("bodies", scene.bodies.len()),
        ("points with mass", scene.points.len() - layout.nodes.len()),
        ("equilibrium points", layout.nodes.len()),
        (
            "networks of them, each solved together",
            layout.networks.len(),
        ),
        ("joints", scene.joints.len() - locks),
        ("rows of the joints", layout.nc),
        ("of them independent", layout.rank()),
        (
            "loops of joints",
            layout.redundancy.loops.saturating_sub(locks),
        ),
        ("lines (tension only)", lines(true)),
        ("springs (both ways)", lines(false)),
        ("loads", scene.loads.len()),
        ("coordinates q", layout.nq),
        ("speeds v", layout.nv),
        ("states of equilibrium points", layout.nz),
        ("declared states", layout.ns),
        ("numbers from the caller at each evaluation", layout.ni),
        ("params (live)", scene.params.len()),
        ("consts (folded)", scene.consts.len()),
        ("columns of outputs", layout.columns),
    ];
    let mut table = ReportTable::new(format!("Scene {}", scene.name))
        .column("what", "")
        .column("number", "");
    for (what, number) in rows {
        table.push([what.into(), number.into()]);
    }
    let told = layout.redundancy.sentences(scene);
    let told = told.into_iter().chain(ambiguous(scene, &layout));
    let tree = layout.tree.as_ref().map(|tree| tree.sentence(scene));
    let notes = [freedoms(scene, &layout)]
        .into_iter()
        .chain(tree)
        .chain(told);
    let gravity = format!("gravity: {}", gravity(&scene.gravity));
    notes.chain([gravity]).fold(table, ReportTable::note)
}

/// Freedoms by Grübler's count, which takes rows as independent (6 a body, 3 a point with mass, in a plane 3 and 2, in relative coordinates the
/// speeds of the tree, less the rows of the joints), and by the true rank; loops. Rows of locks and of joints that are detached at the start are told
/// apart: they hold nothing then.
fn freedoms(scene: &Scene, layout: &Layout) -> String {
    let later = layout.joints.iter().enumerate();
    let later = later.filter(|(joint, slots)| slots.len > 0 && !layout.starts_joined(*joint));
    let later = later.map(|(_, slots)| {
        let is_lock = slots.held.is_some();
        [slots.len, slots.kept.len(), usize::from(is_lock)]
    });
    let [later, later_kept, locks] =
        later.fold([0; 3], |sum, one| [0, 1, 2].map(|k| sum[k] + one[k]));
    let (bodies, rows) = (scene.bodies.len(), layout.nc.saturating_sub(later));
    let rank = layout.rank().saturating_sub(later_kept);
    let points = scene.points.len() - layout.nodes.len();
    let (body, point) = (
        layout.directions.speeds(),
        layout.directions.translations().len(),
    );
    let count = |rows: usize| layout.nv as i64 - rows as i64;
    let speeds = match layout.tree {
        None => format!("freedoms (Grübler): {body}·{bodies} + {point}·{points}"),
        Some(_) => format!("freedoms: {} speeds of the tree and of points", layout.nv),
    };
    let mut text = format!("{speeds} − {rows} = {}", count(rows));
    if rows > 0 {
        let left = count(rank);
        let loops = layout.redundancy.loops.saturating_sub(locks);
        text += &format!("; by the rank {rank} of the rows: {left}; loops: {loops}");
    }
    if later > 0 {
        let rows = if later == 1 { "row" } else { "rows" };
        text += &format!("; {later} {rows} more where events lock or attach");
    }
    text
}

/// A warning for each output, metric and event that asks for a reaction of which there are many.
#[must_use]
pub fn warnings_of_reactions(scene: &Scene) -> Vec<String> {
    let reaction =
        |part: &Formula| matches!(part, Formula::ReactionForce(_) | Formula::ReactionTorque(_));
    let outputs = scene.outputs.iter().map(|output| &output.value);
    let mut asked = outputs.chain(scene.events.iter().map(|event| &event.guard));
    // Which rows repeat others takes a search, and most scenes ask for no reaction.
    if !asked.any(|formula| scene.contains(formula, reaction)) {
        return Vec::new();
    }
    let told = ambiguous(scene, &Layout::new(scene)).into_iter();
    told.map(|text| format!("warning: {text}")).collect()
}

/// Outputs and events that ask for reactions of which there are many.
fn ambiguous(scene: &Scene, layout: &Layout) -> Vec<String> {
    let outputs = scene.outputs.iter();
    let metric = |name: &String| scene.runs.metrics.iter().any(|metric| metric.name == *name);
    let outputs = outputs.map(|output| {
        let kind = if metric(&output.name) {
            "metric"
        } else {
            "output"
        };
        (kind, &output.name, &output.value)
    });
    let events = scene.events.iter();
    let events = events.map(|event| ("event", &event.name, &event.guard));
    let mut told = Vec::new();
    for (kind, name, formula) in outputs.chain(events) {
        let reactions = scene.ambiguous_reactions(layout, formula, None).into_iter();
        let reactions = reactions.filter_map(|of| Some((scene.joints.get(of.joint)?, of)));
        told.extend(reactions.map(|(joint, of)| {
            format!(
                "{kind} `{name}` asks for the reaction of `{}`, which is not unique in its {}: rows of joints repeat each other, and what it shows is one choice of many",
                joint.name,
                of.named().join(", ")
            )
        }));
    }
    told.dedup();
    told
}

fn gravity(gravity: &Gravity) -> &'static str {
    match gravity {
        Gravity::None => "none",
        Gravity::Uniform { .. } => "uniform",
        Gravity::PointMass { .. } => "point mass",
        Gravity::Oblate { .. } => "oblate planet (J2)",
        Gravity::Field => "from the caller",
    }
}
