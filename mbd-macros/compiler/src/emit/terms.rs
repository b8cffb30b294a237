//! Operations as text. A term has a `let` where the law named it or where it is used more than once; any other stands where it is used.
//!
//! Text, not tokens: a macro is seldom optimised, and the compiler that runs it reads text faster than it takes tokens one by one.

use super::literal::document;
use super::scalars::Scalar;
use crate::operation::{Binary, Comparison, Fused, Op, Unary};
use crate::partition::Local;

/// No `let` has more operations.
const LONGEST: usize = 12;

/// How tightly an expression binds: a sum, a product, a sign, a name or a call.
const SUM: u8 = 1;
const PRODUCT: u8 = 2;
const SIGN: u8 = 3;
const CALL: u8 = 4;

/// The operations of one function and the names in it.
pub struct Terms {
    /// What they are operations of.
    pub scalar: Scalar,
    /// Each operation, arguments counted inside the function.
    pub ops: Vec<Op<Local>>,
    /// Names of the numbers from outside.
    pub given: Vec<String>,
    /// Names of the numbers known at build time.
    pub constants: Vec<String>,
    /// The name of each operation's value; `None` for one that stands where it is used.
    pub values: Vec<Option<String>>,
    /// A line of documentation before an operation; as long as `ops`, or empty.
    pub headings: Vec<Option<String>>,
}

/// Which operations have a `let`: those that are `named`, those used more or less than once, the `results`, both of a sine and a cosine.
pub fn lets(ops: &[Op<Local>], named: impl Fn(usize) -> bool, results: &[usize]) -> Vec<bool> {
    let mut uses = vec![0_u32; ops.len()];
    for op in ops {
        for argument in op.arguments() {
            if let Local::Value(value) = argument
                && let Some(count) = uses.get_mut(value)
            {
                *count += 1;
            }
        }
    }
    for &result in results {
        if let Some(count) = uses.get_mut(result) {
            *count += 2;
        }
    }
    let mut lets: Vec<bool> = Vec::with_capacity(ops.len());
    let mut sizes: Vec<usize> = Vec::with_capacity(ops.len());
    for (index, op) in ops.iter().enumerate() {
        let mut size = 1;
        for argument in op.arguments() {
            if let Local::Value(value) = argument
                && lets.get(value) == Some(&false)
            {
                let inner = sizes.get(value).copied().unwrap_or_default();
                if size + inner > LONGEST {
                    lets[value] = true;
                } else {
                    size += inner;
                }
            }
        }
        sizes.push(size);
        let rotated = matches!(op, Op::Unary(Unary::Sin | Unary::Cos, _));
        lets.push(uses[index] != 1 || rotated || named(index));
    }
    lets
}

impl Terms {
    /// The `let`s, in order; sine and cosine of one angle are one.
    pub fn write(&self, out: &mut String) {
        let pairs = self.pairs();
        for (index, &op) in self.ops.iter().enumerate() {
            let Some(Some(name)) = self.values.get(index) else {
                continue;
            };
            if let Some(Some(heading)) = self.headings.get(index) {
                document(out, heading);
            }
            let pair = pairs.iter().find(|pair| pair.contains(&index));
            match pair {
                Some(&[sin, cos]) if index == sin.min(cos) => {
                    let name = |value: usize| self.values.get(value).cloned().flatten();
                    out.push_str("let (");
                    out.push_str(&name(sin).unwrap_or_default());
                    out.push_str(", ");
                    out.push_str(&name(cos).unwrap_or_default());
                    out.push_str(") = ");
                    if let Op::Unary(_, angle) = op {
                        self.of_scalar(out, "sin_cos", &[angle]);
                    }
                    out.push_str(";\n");
                }
                Some(_) => {}
                None => {
                    out.push_str("let ");
                    out.push_str(name);
                    out.push_str(" = ");
                    self.operation(out, op);
                    out.push_str(";\n");
                }
            }
        }
    }

    /// The name of a value that has one.
    pub fn name(&self, value: usize) -> &str {
        match self.values.get(value) {
            Some(Some(name)) => name,
            _ => "",
        }
    }

    /// Sine and cosine of one angle.
    fn pairs(&self) -> Vec<[usize; 2]> {
        let mut sines: Vec<(Local, usize)> = Vec::new();
        let mut cosines: Vec<(Local, usize)> = Vec::new();
        for (index, &op) in self.ops.iter().enumerate() {
            match op {
                Op::Unary(Unary::Sin, angle) => sines.push((angle, index)),
                Op::Unary(Unary::Cos, angle) => cosines.push((angle, index)),
                _ => {}
            }
        }
        let pair = |&(angle, sin): &(Local, usize)| {
            let cosine = cosines.iter().find(|(other, _)| *other == angle);
            cosine.map(|&(_, cos)| [sin, cos])
        };
        sines.iter().filter_map(pair).collect()
    }

    fn argument(&self, out: &mut String, argument: Local, least: u8) {
        let name = match argument {
            Local::Given(index) => self.given.get(index),
            Local::Constant(index) => self.constants.get(index),
            Local::Value(index) => self.values.get(index).and_then(Option::as_ref),
        };
        if let Some(name) = name {
            out.push_str(name);
        } else if let Local::Value(index) = argument
            && let Some(&op) = self.ops.get(index)
        {
            let loose = tightness(op) < least;
            if loose {
                out.push('(');
            }
            self.operation(out, op);
            if loose {
                out.push(')');
            }
        }
    }

    fn operation(&self, out: &mut String, op: Op<Local>) {
        match op {
            Op::Unary(Unary::Neg, a) => {
                out.push('-');
                self.argument(out, a, CALL);
            }
            Op::Unary(Unary::Sin, a) => {
                self.of_scalar(out, "sin_cos", &[a]);
                out.push_str(".0");
            }
            Op::Unary(Unary::Cos, a) => {
                self.of_scalar(out, "sin_cos", &[a]);
                out.push_str(".1");
            }
            Op::Unary(kind, a) => {
                self.argument(out, a, CALL);
                out.push_str(match kind {
                    Unary::Sqrt => ".sqrt()",
                    Unary::Exp => ".exp()",
                    Unary::Ln => ".ln()",
                    Unary::Tanh => ".tanh()",
                    Unary::Floor => ".floor()",
                    _ => ".abs()",
                });
            }
            Op::Binary(Binary::Add, a, b) => self.between(out, a, (SUM, " + ", PRODUCT), b),
            Op::Binary(Binary::Sub, a, b) => self.between(out, a, (SUM, " - ", PRODUCT), b),
            Op::Binary(Binary::Mul, a, b) => self.between(out, a, (PRODUCT, " * ", SIGN), b),
            Op::Binary(Binary::Div, a, b) => self.between(out, a, (PRODUCT, " / ", SIGN), b),
            Op::Binary(Binary::Atan2, a, b) => self.method(out, a, ".atan2(", b),
            Op::Binary(Binary::Min, a, b) => self.of_scalar(out, "min", &[a, b]),
            Op::Binary(Binary::Max, a, b) => self.of_scalar(out, "max", &[a, b]),
            Op::Fused(kind, a, b, c) => self.fused(out, kind, [a, b], c),
            Op::Compare(Comparison::Lt, a, b) => self.method(out, a, ".lt(", b),
            Op::Compare(Comparison::Le, a, b) => self.method(out, a, ".le(", b),
            Op::Compare(Comparison::Both, a, b) => self.call(out, "T::both(", &[a, b]),
            Op::Select(mask, a, b) => self.call(out, "T::select(", &[mask, a, b]),
        }
    }

    /// The right side binds tighter than the sign between: nothing is re-associated.
    fn between(&self, out: &mut String, a: Local, sign: (u8, &str, u8), b: Local) {
        self.argument(out, a, sign.0);
        out.push_str(sign.1);
        self.argument(out, b, sign.2);
    }

    /// A function that `f64` has of its own by the same name, which differs: its sine in the last digit, its minimum where a number is none.
    fn of_scalar(&self, out: &mut String, function: &str, arguments: &[Local]) {
        match (self.scalar, arguments) {
            (Scalar::Any, [first, rest @ ..]) => {
                self.argument(out, *first, CALL);
                self.call(out, &format!(".{function}("), rest);
            }
            _ => self.call(out, &format!("::mbd_runtime::Real::{function}("), arguments),
        }
    }

    fn method(&self, out: &mut String, a: Local, method: &str, b: Local) {
        self.argument(out, a, CALL);
        self.call(out, method, &[b]);
    }

    /// What has no name of its own stands between the brackets.
    fn fused(&self, out: &mut String, kind: Fused, [a, b]: [Local; 2], c: Local) {
        let (a, b) = match self.is_named(a) || !self.is_named(b) {
            true => (a, b),
            false => (b, a),
        };
        self.argument(out, a, CALL);
        let method = match kind {
            Fused::Fmadd => ".fmadd(",
            Fused::Fmsub => ".fmsub(",
            Fused::Fnmadd => ".fnmadd(",
        };
        self.call(out, method, &[b, c]);
    }

    fn is_named(&self, argument: Local) -> bool {
        match argument {
            Local::Value(index) => self.values.get(index).is_some_and(Option::is_some),
            Local::Given(_) | Local::Constant(_) => true,
        }
    }

    fn call(&self, out: &mut String, function: &str, arguments: &[Local]) {
        out.push_str(function);
        for (index, &argument) in arguments.iter().enumerate() {
            if index > 0 {
                out.push_str(", ");
            }
            self.argument(out, argument, SUM);
        }
        out.push(')');
    }
}

fn tightness(op: Op<Local>) -> u8 {
    match op {
        Op::Binary(Binary::Add | Binary::Sub, ..) => SUM,
        Op::Binary(Binary::Mul | Binary::Div, ..) => PRODUCT,
        Op::Unary(Unary::Neg, _) => SIGN,
        _ => CALL,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(ops: &[Op<Local>], results: &[usize]) -> String {
        written_of(Scalar::Any, ops, results)
    }

    fn written_of(scalar: Scalar, ops: &[Op<Local>], results: &[usize]) -> String {
        let lets = lets(ops, |_| false, results);
        let name = |(index, &has): (usize, &bool)| has.then(|| format!("t{index}"));
        let terms = Terms {
            scalar,
            ops: ops.to_vec(),
            given: ["a", "b", "c"].map(str::to_owned).to_vec(),
            constants: vec!["half".to_owned()],
            values: lets.iter().enumerate().map(name).collect(),
            headings: Vec::new(),
        };
        let mut text = String::new();
        terms.write(&mut text);
        text
    }

    const A: Local = Local::Given(0);
    const B: Local = Local::Given(1);
    const C: Local = Local::Given(2);

    fn value(index: usize) -> Local {
        Local::Value(index)
    }

    #[test]
    fn the_right_side_of_a_sign_is_bracketed_where_it_binds_no_tighter() {
        let sum = [
            Op::Binary(Binary::Add, B, C),
            Op::Binary(Binary::Sub, A, value(0)),
            Op::Binary(Binary::Mul, value(1), C),
            Op::Unary(Unary::Neg, value(2)),
        ];
        assert_eq!(written(&sum, &[3]), "let t3 = -((a - (b + c)) * c);\n");
        let product = [
            Op::Binary(Binary::Mul, A, B),
            Op::Binary(Binary::Div, value(0), C),
            Op::Binary(Binary::Add, value(1), A),
            Op::Binary(Binary::Sub, value(2), B),
            Op::Unary(Unary::Sqrt, value(3)),
        ];
        let text = "let t4 = (a * b / c + a - b).sqrt();\n";
        assert_eq!(written(&product, &[4]), text);
        let quotient = [
            Op::Binary(Binary::Div, A, B),
            Op::Unary(Unary::Neg, C),
            Op::Binary(Binary::Div, value(1), value(0)),
        ];
        assert_eq!(written(&quotient, &[2]), "let t2 = -c / (a / b);\n");
    }

    #[test]
    fn what_is_used_twice_has_a_name_and_sine_and_cosine_are_one_call() {
        let ops = [
            Op::Binary(Binary::Mul, Local::Constant(0), A),
            Op::Unary(Unary::Cos, value(0)),
            Op::Unary(Unary::Sin, value(0)),
            Op::Binary(Binary::Mul, value(1), value(2)),
            Op::Compare(Comparison::Lt, value(3), B),
            Op::Select(value(4), value(3), C),
        ];
        let text = "let t0 = half * a;\nlet (t2, t1) = t0.sin_cos();\nlet t3 = t1 * t2;\nlet t5 = T::select(t3.lt(b), t3, c);\n";
        assert_eq!(written(&ops, &[5]), text);
    }

    #[test]
    fn functions_that_f64_has_otherwise_are_those_of_the_scalar() {
        let ops = [
            Op::Unary(Unary::Sin, A),
            Op::Unary(Unary::Sqrt, value(0)),
            Op::Binary(Binary::Max, value(1), B),
        ];
        let text = "let t0 = ::mbd_runtime::Real::sin_cos(a).0;\nlet t2 = ::mbd_runtime::Real::max(t0.sqrt(), b);\n";
        assert_eq!(written_of(Scalar::Double, &ops, &[2]), text);
        let text = "let t0 = a.sin_cos().0;\nlet t2 = t0.sqrt().max(b);\n";
        assert_eq!(written(&ops, &[2]), text);
    }

    #[test]
    fn no_let_is_longer_than_a_line_or_two() {
        let ops: Vec<Op<Local>> = (0..100)
            .map(|index| match index {
                0 => Op::Binary(Binary::Mul, A, B),
                _ => Op::Binary(Binary::Add, value(index - 1), A),
            })
            .collect();
        let lets = lets(&ops, |_| false, &[99]);
        assert!(lets[99] && lets[LONGEST - 1] && !lets[0]);
        let ends: Vec<usize> = (0..100).filter(|&index| lets[index]).collect();
        assert!(ends.windows(2).all(|pair| pair[1] - pair[0] <= LONGEST));
    }
}
