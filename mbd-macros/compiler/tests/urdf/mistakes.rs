//! What a file says wrongly is told at its place.

use mbd_compiler::read_urdf;
use mbd_scene::Layout;

use super::dice::Dice;
use super::{ARM, arm, declared, told};

/// What is wrong, and the arm with that mistake.
fn mistakes() -> Vec<(&'static str, String)> {
    let with = |from: &str, to: &str| {
        assert!(ARM.contains(from), "{from}");
        ARM.replacen(from, to, 1)
    };
    let joints = |joints: &str| ARM.replace("</robot>", &format!("{joints}</robot>"));
    let bomb =
        "<!DOCTYPE a [<!ENTITY a \"aaaa\"><!ENTITY b \"&a;&a;&a;&a;\">]>\n<robot name=\"&b;\"/>";
    vec![
        ("nothing at all", String::new()),
        ("truncated", ARM[..ARM.len() / 2].to_owned()),
        ("entities", bomb.to_owned()),
        (
            "another language",
            "<mujoco><worldbody/></mujoco>".to_owned(),
        ),
        (
            "xacro",
            with(
                "<link name=\"camera\">",
                "<xacro:arm xmlns:xacro=\"http://www.ros.org/wiki/xacro\"/><link name=\"camera\">",
            ),
        ),
        ("no links", "<robot name=\"a\"/>".to_owned()),
        (
            "unknown joint type",
            with("type=\"continuous\"", "type=\"continous\""),
        ),
        ("no joint type", with(" type=\"continuous\"", "")),
        (
            "missing link",
            with("<parent link=\"fore\"/>", "<parent link=\"for\"/>"),
        ),
        ("missing parent", with("<parent link=\"fore\"/>", "")),
        (
            "missing mimicked joint",
            with("<mimic joint=\"grip\"/>", "<mimic joint=\"gripper\"/>"),
        ),
        (
            "mimics itself",
            with("<mimic joint=\"grip\"/>", "<mimic joint=\"grip_mirror\"/>"),
        ),
        (
            "link twice",
            with("<link name=\"camera\">", "<link name=\"fore\">"),
        ),
        ("joint twice", with("name=\"wrist_roll\"", "name=\"elbow\"")),
        ("no name", with("<link name=\"camera\">", "<link>")),
        (
            "carried twice",
            joints(
                "<joint name=\"loop\" type=\"revolute\"><parent link=\"base_link\"/><child link=\"wrist\"/></joint>",
            ),
        ),
        (
            "circle",
            with("<parent link=\"upper\"/>", "<parent link=\"wrist\"/>"),
        ),
        ("two roots", joints("<link name=\"stray\"/>")),
        ("NaN", with("mass value=\"2.5\"", "mass value=\"nan\"")),
        ("infinite", with("xyz=\"0 0 0.2\"", "xyz=\"0 0 inf\"")),
        ("two numbers", with("xyz=\"0 0 0.2\"", "xyz=\"0 0.2\"")),
        ("a comma", with("xyz=\"0 0 0.2\"", "xyz=\"0, 0, 0.2\"")),
        (
            "negative mass",
            with("mass value=\"2.5\"", "mass value=\"-2.5\""),
        ),
        (
            "negative damping",
            with("damping=\"0.5\"", "damping=\"-0.5\""),
        ),
        ("no mass", with("<mass value=\"2.5\"/>", "")),
        (
            "massless link that moves",
            with(
                "<mass value=\"0.05\"/>\n      <inertia ixx=\"0.00002\" iyy=\"0.00002\" izz=\"0.00001\"",
                "<mass value=\"0\"/>\n      <inertia ixx=\"0\" iyy=\"0\" izz=\"0\"",
            ),
        ),
        ("impossible inertia", with("ixx=\"0.030\"", "ixx=\"0.30\"")),
        ("negative inertia", with("ixx=\"0.030\"", "ixx=\"-0.30\"")),
        (
            "inertia of a point",
            with(
                "ixx=\"0.00002\" iyy=\"0.00002\" izz=\"0.00001\"",
                "ixx=\"0\" iyy=\"0\" izz=\"0\"",
            ),
        ),
        ("zero axis", with("xyz=\"0.6 0 0.8\"", "xyz=\"0 0 0\"")),
        (
            "misspelt element",
            with("<inertial>", "<inertail>").replacen("</inertial>", "</inertail>", 1),
        ),
        (
            "misspelt attribute",
            with("rpy=\"0 0 0.4\"", "rpz=\"0 0 0.4\""),
        ),
        ("degrees", with("rpy=\"0 0 0.4\"", "rpy=\"0 0 90\"")),
        (
            "degrees of an inertia",
            with("rpy=\"0.1 0.2 0.3\"", "rpy=\"0.1 -45 0.3\""),
        ),
        (
            "quaternion",
            with("rpy=\"0 0 0.4\"", "quat_xyzw=\"0 0 0 1\""),
        ),
        (
            "second axis",
            with(
                "<axis xyz=\"0 0 1\"/>",
                "<axis xyz=\"0 0 1\"/><axis xyz=\"1 0 0\"/>",
            ),
        ),
        (
            "nothing moves",
            "<robot name=\"a\"><link name=\"b\"/></robot>".to_owned(),
        ),
        (
            "mimic of a planar joint",
            with(
                "name=\"grip\" type=\"prismatic\"",
                "name=\"grip\" type=\"planar\"",
            ),
        ),
    ]
}

#[test]
fn a_mistake_is_told_with_its_place_and_its_remedy() {
    let mut found = String::new();
    for (name, text) in mistakes() {
        let reading = read_urdf(&text);
        assert!(reading.scene.is_none(), "{name} was read");
        found.push_str(&format!("# {name}\n{}\n", told(&reading)));
    }
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden/urdf.txt");
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(path, &found).unwrap();
    }
    assert_eq!(found, std::fs::read_to_string(path).unwrap());
}

#[test]
fn a_declaration_is_told_where_in_the_file_a_mistake_is_and_where_it_names_the_file() {
    let lines = |fields: &str, items: &str| -> Vec<String> {
        let errors = arm(fields, items).errors;
        errors.iter().map(|message| message.to_string()).collect()
    };
    assert_eq!(
        lines(";", "extend shoulde { force: 2 N*m }"),
        ["1:43: the URDF declares nothing that is called `shoulde`; did you mean `shoulder`?"]
    );
    assert_eq!(
        lines("{ base: loose }", ""),
        ["1:42: this is `fixed` or `free`"]
    );
    assert_eq!(
        lines("{ bas: free }", ""),
        [
            "1:36: unknown field `bas`; did you mean `base`? fields here: base, inertias, angle, slide"
        ]
    );
    let told = |text: &str| -> Vec<String> {
        let errors = declared(text).errors;
        errors.iter().map(|message| message.to_string()).collect()
    };
    // Links without mass, and inertias of no body, as the option would have let them through.
    for coordinates in ["absolute", "relative"] {
        for (file, options, expected) in [
            (
                "hip",
                "inertias: uncheked",
                "this is `checked` or `unchecked`",
            ),
            ("hip", "inertia: unchecked", "unknown field `inertia`"),
            (
                "impossible",
                "inertias: uncheked",
                "this is `checked` or `unchecked`",
            ),
        ] {
            let told = told(&format!(
                "model A {{ coordinates: {coordinates}; urdf: \"{file}.urdf\" {{ {options} }}; }}"
            ));
            let [only] = told.as_slice() else {
                panic!("{told:?}");
            };
            assert!(only.contains(expected), "{only}");
        }
    }
    assert_eq!(
        told("model A { urdf: \"broken.urdf\"; extend a { force: 1 N } output b = c.position; }"),
        ["1:17: broken.urdf:4:12: `value` of `<mass>` is one finite number, not \"nan\""]
    );
    assert_eq!(
        told("model A { gravity: none; extend a { force: 1 N } }"),
        [
            "1:33: `extend` adds to what a `urdf` declares, and this declaration has none: write the fields where the thing is declared"
        ]
    );
    assert!(
        told("model A { urdf: \"missing.urdf\"; }")[0]
            .starts_with("1:17: cannot read missing.urdf: ")
    );
    assert_eq!(
        told("model A { urdf: arm; }"),
        ["1:17: expected the path of a URDF in quotes, such as `urdf: \"robots/arm.urdf\";`"]
    );
}

#[test]
fn whatever_a_file_holds_reading_ends_and_a_mistake_has_a_line() {
    let check = |bytes: &[u8]| {
        let reading = read_urdf(&String::from_utf8_lossy(bytes));
        match &reading.scene {
            // What can be read can be laid out.
            Some(scene) => assert!(Layout::new(scene).nv > 0),
            None => {
                let first = reading.errors[0].to_string();
                let line = first
                    .split(':')
                    .next()
                    .and_then(|line| line.parse::<usize>().ok());
                assert!(line.is_some_and(|line| line > 0), "{first}");
            }
        }
    };
    let arm = ARM.as_bytes();
    (0..arm.len()).step_by(7).for_each(|end| check(&arm[..end]));
    let mut dice = Dice(7);
    for _ in 0..600 {
        let mut bytes = arm.to_vec();
        for _ in 0..=dice.below(4) {
            let (at, other) = (dice.below(bytes.len()), dice.below(bytes.len()));
            match dice.below(5) {
                0 => {
                    bytes.remove(at);
                }
                1 => bytes.insert(at, bytes[other]),
                2 => bytes.swap(at, other),
                3 => bytes[at] = b"<>/\"0-e.&\0"[dice.below(10)],
                _ => {
                    let (from, to) = (at.min(other), at.max(other).min(at.min(other) + 300));
                    let copy = bytes[from..to].to_vec();
                    bytes.splice(from..from, copy);
                }
            }
        }
        check(&bytes);
    }
}

#[test]
fn a_file_that_is_too_large_or_too_deep_is_refused_soon() {
    let large = format!("<robot name=\"a\">{}</robot>", " ".repeat(100_000_000));
    assert_eq!(
        told(&read_urdf(&large)),
        "arm.urdf:1:1: 100000024 bytes are no robot"
    );
    let deep = format!(
        "{}{}",
        "<robot>".repeat(100_000),
        "</robot>".repeat(100_000)
    );
    assert!(read_urdf(&deep).scene.is_none());
    let links: String = (0..5000)
        .map(|i| format!("<link name=\"l{i}\"/>"))
        .collect();
    assert!(
        told(&read_urdf(&format!("<robot>{links}</robot>")))
            .contains("5000 links are more than 2000")
    );
    let attributes: String = (0..5000).map(|i| format!("a{i}=\"1\" ")).collect();
    assert_eq!(
        told(&read_urdf(&format!(
            "<robot name=\"r\">\n  <link {attributes}/></robot>"
        ))),
        "arm.urdf:2:3: 5000 attributes are more than 1000, which no element of a robot has"
    );
}
