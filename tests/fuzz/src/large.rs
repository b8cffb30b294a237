//! Files that are large in one way: one word, one number, nothing but brackets, one sum, many items, many links, noise.

use std::fmt::Write as _;

use crate::mutate::{BYTES, Form, Input, robot};
use laws::random::Random;

/// How a file is made of its size.
type Written = fn(usize) -> String;

/// The files: what each is large in, its form, and how it is written.
const FILES: [(&str, Form, Written); 25] = [
    ("one word", Form::Text, |size| model(&times("a", size))),
    ("one number", Form::Text, |size| {
        model(&format!("const K = {};", times("9", size)))
    }),
    ("brackets that open", Form::Text, |size| {
        model(&times("[", size))
    }),
    ("brackets", Form::Text, |size| model(&times("[]", size))),
    ("one sum", Form::Text, |size| {
        model(&format!("const K = 1{};", times(" + 1", size)))
    }),
    ("one product", Form::Text, |size| {
        model(&format!("const K = 1{};", times(" * -1", size)))
    }),
    ("a comment without end", Form::Text, |size| {
        model(&times("/* a ", size))
    }),
    ("a string without end", Form::Text, |size| {
        model(&format!("\"{}", times("a", size)))
    }),
    ("empty lines", Form::Text, |size| model(&times("\n", size))),
    ("points", Form::Text, |size| {
        model(&many(size, |text, k| {
            writeln!(text, "point p{k} {{ mass: 1 kg }}")
        }))
    }),
    ("consts", Form::Text, |size| {
        model(&many(size, |text, k| writeln!(text, "const C{k} = {k} m;")))
    }),
    ("points of one name", Form::Text, |size| {
        model(&times("point p { mass: 1 kg }\n", size))
    }),
    ("repetitions", Form::Text, |size| {
        let points =
            |text: &mut String, k| writeln!(text, "point p{k}[i in 0..9999] {{ mass: 1 kg }}");
        model(&many(size, points))
    }),
    ("mistakes", Form::Text, |size| {
        model(&times("bdy b { mss: 1 kgg }\n", size))
    }),
    ("noise", Form::Text, noise),
    ("TOML: tables", Form::Toml, |size| {
        many(size, |text, k| {
            write!(text, "[point.p{k}]\nmass = \"1 kg\"\n")
        })
    }),
    ("TOML: one array", Form::Toml, |size| {
        format!("a = {}", times("[", size))
    }),
    ("TOML: one string", Form::Toml, |size| {
        format!("gravity = \"{}\"", times("a", size))
    }),
    ("TOML: keys", Form::Toml, |size| times("a.", size)),
    ("TOML: noise", Form::Toml, noise),
    ("URDF: links", Form::Urdf, |size| {
        let links = many(size, |text, k| writeln!(text, "<link name=\"l{k}\"/>"));
        format!("<robot name=\"r\">{links}</robot>")
    }),
    ("URDF: a chain", Form::Urdf, |size| robot(size / 480)),
    ("URDF: elements that open", Form::Urdf, |size| {
        times("<link>", size)
    }),
    ("URDF: attributes", Form::Urdf, |size| {
        format!(
            "<robot {}/>",
            many(size, |text, k| write!(text, "a{k}=\"1\" "))
        )
    }),
    ("URDF: noise", Form::Urdf, noise),
];

/// How many files there are.
pub const LARGE: usize = FILES.len();

/// The file of a number with `size` bytes or some more, and what it is large in; `None` if there is no such file.
#[must_use]
pub fn large_file(size: usize, number: usize) -> Option<(&'static str, Input)> {
    let (name, form, written) = FILES.get(number)?;
    let input = Input {
        form: *form,
        text: written(size),
        meant: false,
    };
    Some((name, input))
}

fn model(inside: &str) -> String {
    format!("model Large {{ gravity: none; {inside} }}")
}

fn times(one: &str, size: usize) -> String {
    one.repeat(size / one.len())
}

/// Items one after another; writing to a text cannot fail.
fn many(size: usize, item: impl Fn(&mut String, usize) -> std::fmt::Result) -> String {
    let mut text = String::with_capacity(size + 100);
    let mut number = 0;
    while text.len() < size && item(&mut text, number).is_ok() {
        number += 1;
    }
    text
}

fn noise(size: usize) -> String {
    let mut random = Random::new(1);
    let noise: Vec<u8> = (0..size)
        .map(|_| BYTES[random.below(BYTES.len())])
        .collect();
    String::from_utf8_lossy(&noise).into_owned()
}
