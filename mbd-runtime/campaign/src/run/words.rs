//! Words of other tools for the settings and the methods of a run, and what is written here.

/// Words, and the answer to them.
type WordAnswers = &'static [(&'static [&'static str], &'static str)];

/// The answer to a setting of another tool.
pub(super) fn of_setting(word: &str) -> Option<&'static str> {
    answer(SETTINGS, word)
}

/// The answer to a method of another tool.
pub(super) fn of_method(word: &str) -> Option<&'static str> {
    answer(METHODS, word)
}

/// The answer to a setting of a distribution of another tool.
pub(crate) fn of_distribution_setting(word: &str) -> Option<&'static str> {
    answer(DISTRIBUTION_SETTINGS, word)
}

/// The answer to a distribution of another tool.
pub(crate) fn of_distribution(word: &str) -> Option<&'static str> {
    answer(DISTRIBUTIONS, word)
}

/// The answer to a way to draw of another tool.
pub(crate) fn of_sampling(word: &str) -> Option<&'static str> {
    answer(SAMPLINGS, word)
}

fn answer(answers: WordAnswers, word: &str) -> Option<&'static str> {
    let word = word.to_lowercase();
    let mut answers = answers.iter();
    let found = answers.find(|(theirs, _)| theirs.contains(&word.as_str()));
    found.map(|(_, ours)| *ours)
}

/// Settings of distributions of other tools, and ours.
const DISTRIBUTION_SETTINGS: WordAnswers = &[
    (
        &[
            "std",
            "stdev",
            "stddev",
            "std_dev",
            "sd",
            "standard_deviation",
            "scale",
        ],
        "the standard deviation is called `sigma`: `sigma = \"5 %\"`",
    ),
    (&["mu", "loc", "average"], "it is called `mean`"),
    (
        &["min", "minimum", "lower", "lo", "from", "left"],
        "the smallest value is called `low`",
    ),
    (
        &["max", "maximum", "upper", "hi", "to", "right"],
        "the largest value is called `high`",
    ),
    (
        &["type", "kind", "distribution"],
        "the word of the distribution is called `dist`: `dist = \"normal\"`",
    ),
    (
        &["count", "num", "n", "points", "steps", "step"],
        "the values of a grid are listed: `values = [\"1 kg\", \"2 kg\"]`",
    ),
    (
        &["probabilities", "probability", "p"],
        "how likely each of `values` is stands in `weights`",
    ),
];

/// Distributions of other tools, and ours.
const DISTRIBUTIONS: WordAnswers = &[
    (&["gaussian", "gauss", "norm"], "it is called `normal`"),
    (
        &["truncated", "truncnorm", "truncated_gaussian", "clipped"],
        "it is called `truncated_normal`, with `low` and `high`",
    ),
    (&["rect", "flat", "range"], "it is called `uniform`"),
    (
        &["choice", "choices", "categorical", "list", "set"],
        "one of a list is `discrete`, with `values`; all of them in turn are a `grid`",
    ),
    (&["csv", "file", "empirical"], "it is called `table`"),
    (
        &["sweep", "linspace"],
        "it is called `grid`, with `sampling = \"grid\"`",
    ),
];

/// Ways to draw of other tools, and ours.
const SAMPLINGS: WordAnswers = &[
    (
        &["lhs", "latin_hypercube", "latinhypercube", "hypercube"],
        "it is called `latin`",
    ),
    (
        &["monte_carlo", "montecarlo", "mc"],
        "it is called `random`",
    ),
    (
        &["sweep", "factorial", "full_factorial"],
        "it is called `grid`",
    ),
];

/// Settings of other tools, and ours.
const SETTINGS: WordAnswers = &[
    (
        &[
            "end",
            "t_end",
            "tend",
            "stop",
            "duration",
            "time",
            "length",
            "t_final",
            "stop_time",
            "end_time",
        ],
        "the end of a run is called `until`: `until = \"10 s\"`",
    ),
    (
        &["tol", "rtol", "reltol", "rel_tol", "accuracy"],
        "it is called `tolerance`: `tolerance = 1e-8`",
    ),
    (
        &["atol", "abstol"],
        "a tolerance is one number over the scales of the scene, `tolerance = 1e-8`, and these are set in `[run.scales]`",
    ),
    (
        &["dt", "h", "timestep", "time_step", "step_size"],
        "a fixed step is called `step`, `step = \"1 ms\"`; the distance of the rows of the history `every`",
    ),
    (
        &[
            "output",
            "output_step",
            "interval",
            "sampling",
            "rows",
            "dt_out",
        ],
        "the distance of the rows of the history is called `every`: `every = \"10 ms\"`",
    ),
    (
        &["solver", "integrator", "scheme"],
        "it is called `method`: `method = \"tsit5\"`",
    ),
    (
        &["initial", "init", "initial_conditions", "ic"],
        "where a run starts is the table `[run.start]`",
    ),
    (
        &["parameters", "param", "set"],
        "values of params are the table `[run.params]`",
    ),
    (&["input"], "values of inputs are the table `[run.inputs]`"),
];

/// Methods of other tools, and what to take here.
const METHODS: WordAnswers = &[
    (
        &[
            "rk45", "ode45", "dopri5", "dopri", "dp5", "rkf45", "cashkarp", "adaptive",
        ],
        "an adaptive method of order 5 is `tsit5`",
    ),
    (
        &[
            "dop853", "rk78", "ode78", "ode89", "rkf78", "vern9", "vern8",
        ],
        "an adaptive method of high order is `vern7`",
    ),
    (
        &[
            "bdf",
            "cvode",
            "radau",
            "radau5",
            "ode15s",
            "ode23s",
            "ode23t",
            "lsoda",
            "ida",
            "dassl",
            "trapezoidal",
            "implicit",
            "stiff",
            "gear",
        ],
        "a method for what is stiff is `rodas5p`, or `auto`",
    ),
    (
        &[
            "euler",
            "rk2",
            "heun",
            "midpoint",
            "semi_implicit_euler",
            "rungekutta",
            "runge_kutta",
            "runge-kutta",
        ],
        "a method with a fixed step is `rk4`",
    ),
    (
        &["verlet", "leapfrog", "symplectic", "stoermer", "shake"],
        "a symplectic method with a fixed step is `rattle`",
    ),
];
