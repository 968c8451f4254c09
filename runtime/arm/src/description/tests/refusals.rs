//! What is refused, and how it is said.

use super::*;
use crate::description::mesh;
use proptest::prelude::*;

/// Loads the made-up arm with changed files; returns all faults.
fn refused(in_urdf: &[(&str, &str)], in_settings: &[(&str, &str)]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let edited = |name: &str, edits: &[(&str, &str)]| {
        let mut text = std::fs::read_to_string(arms().join(name)).unwrap();
        for (from, to) in edits {
            assert!(text.contains(from), "`{from}` is not in {name}");
            text = text.replacen(from, to, 1);
        }
        std::fs::write(folder.path().join(name), text).unwrap();
    };
    edited(
        "seven.urdf",
        &[in_urdf, &[("package://arms/", "")]].concat(),
    );
    edited("seven.toml", in_settings);
    std::fs::copy(arms().join("wrist.stl"), folder.path().join("wrist.stl")).unwrap();
    match Settings::load(&folder.path().join("seven.toml")) {
        Ok(_) => String::new(),
        Err(error) => error.to_string(),
    }
}

#[track_caller]
fn says(said: &str, parts: &[&str]) {
    for part in parts {
        assert!(said.contains(part), "`{part}` is not said: {said}");
    }
}

#[test]
fn the_made_up_arm_itself_is_accepted() {
    assert_eq!(refused(&[], &[]), "");
    assert_eq!(seven().model, "seven");
    let names = ["one", "two", "three", "four", "five", "six", "seven"];
    assert_eq!(seven().chain().names(), names);
}

#[test]
fn joints_that_do_not_turn_are_refused() {
    for kind in ["prismatic", "floating", "planar", "screw"] {
        let name = "name=\"three\" type=\"revolute\"";
        let said = refused(&[(name, &name.replace("revolute", kind))], &[]);
        says(
            &said,
            &[
                &format!("the joint `three` is `{kind}`"),
                "expected `revolute`",
            ],
        );
    }
    let said = refused(
        &[(
            "<axis xyz=\"0 -1 0\"/>",
            "<axis xyz=\"0 -1 0\"/><mimic joint=\"two\"/>",
        )],
        &[],
    );
    says(&said, &["the joint `four` follows `two`"]);
}

#[test]
fn too_few_and_too_many_joints_are_refused() {
    let fixed = |name: &str| format!("name=\"{name}\" type=\"fixed\"");
    let turns = |name: &str| format!("name=\"{name}\" type=\"revolute\"");
    let edits = ["one", "two"].map(|name| (turns(name), fixed(name)));
    let edits = edits
        .each_ref()
        .map(|(from, to)| (from.as_str(), to.as_str()));
    says(
        &refused(&edits, &[]),
        &["has 5 joints that move: `three`, `four`", "expected 6 or 7"],
    );
    let said = refused(&[(&fixed("stand"), &turns("stand"))], &[]);
    says(&said, &["has 8 joints that move", "`stand`"]);
    // One less is an arm of six.
    let said = refused(&edits[..1], &[("home_deg = [0, ", "home_deg = [")]);
    assert_eq!(said, "");
}

#[test]
fn links_that_are_missing_or_elsewhere_are_refused() {
    let said = refused(&[], &[("tip_link = \"hand\"", "tip_link = \"hant\"")]);
    says(&said, &["`arm.tip_link` is `hant`", "did you mean `hand`?"]);
    let said = refused(
        &[],
        &[("base_link = \"world\"", "base_link = \"left_finger\"")],
    );
    says(
        &said,
        &[
            "does not hang from `arm.base_link`, `left_finger`",
            "the link `world` hangs from 0 joints",
        ],
    );
    let said = refused(
        &[("<child link=\"elbow\"/>", "<child link=\"fore_arm\"/>")],
        &[],
    );
    says(&said, &["the link `fore_arm` hangs from 2 joints"]);
    let said = refused(&[("<link name=\"elbow\">", "<link name=\"other\">")], &[]);
    says(
        &said,
        &["the joint `three` names the link `elbow`, which is not there"],
    );
    let said = refused(&[("<link name=\"elbow\">", "<link name=\"palm\">")], &[]);
    says(&said, &["there are two links `palm`"]);
    let said = refused(
        &[("<child link=\"base\"/>", "<child link=\"flange\"/>")],
        &[],
    );
    says(&said, &["hangs from 2 joints"]);
    let circle = [("<parent link=\"world\"/>", "<parent link=\"flange\"/>")];
    says(&refused(&circle, &[]), &["and no circle"]);
}

#[test]
fn a_branch_that_moves_beside_the_chain_is_refused() {
    let branch = "<joint name=\"wing\" type=\"continuous\"><parent link=\"elbow\"/><child link=\"tail\"/></joint>\
                  <link name=\"tail\"/></robot>";
    let said = refused(&[("</robot>", branch)], &[]);
    says(
        &said,
        &["the joint `wing` is `continuous` and moves `tail` beside the chain"],
    );
    let said = refused(&[("type=\"prismatic\"", "type=\"revolute\"")], &[]);
    says(
        &said,
        &["the joint `left_slide` is `revolute`", "`[[arm.hand]]`"],
    );
}

#[test]
fn limits_that_are_missing_absurd_or_looser_are_refused() {
    let limit = "lower=\"-2.9\" upper=\"2.9\" velocity=\"1.6\"";
    let with = |limit_to: &str| refused(&[(limit, limit_to)], &[]);
    says(
        &with("velocity=\"1.6\""),
        &["the limits of the joint `one` are not known", "`min_deg`"],
    );
    says(
        &with("lower=\"-2.9\" upper=\"2.9\""),
        &["the highest speed of the joint `one` is not known"],
    );
    says(
        &with("lower=\"-1e9\" upper=\"2.9\" velocity=\"1.6\""),
        &["the limits of the joint `one`", "within -720.000 to 166"],
    );
    says(
        &with("lower=\"2\" upper=\"1\" velocity=\"1.6\""),
        &["`114.592` to `57.296` deg"],
    );
    says(
        &with("lower=\"0\" upper=\"0\" velocity=\"1.6\""),
        &["`0.000` to `0.000` deg"],
    );
    says(
        &with("lower=\"nan\" upper=\"2.9\" velocity=\"1.6\""),
        &["`lower` is `nan`", "line 18"],
    );
    says(
        &with("lower=\"-2.9\" upper=\"2.9\" velocity=\"-1\""),
        &["`-57.296` deg/s"],
    );
    says(
        &with("lower=\"-2.9\" upper=\"2.9\" velocity=\"1e9\""),
        &["deg/s; expected above 0 and at most 720"],
    );
    let stated = |text: &str| {
        refused(
            &[],
            &[("[fingers]", &format!("[[arm.joint]]\n{text}\n[fingers]"))],
        )
    };
    says(
        &stated("name = \"one\"\nmax_deg = 170.0"),
        &["`-166.158` to `170.000` deg", "within -166.158 to 166.158"],
    );
    says(
        &stated("name = \"one\"\nmax_speed_deg_s = 200.0"),
        &["`200.000` deg/s; expected above 0 and at most 91.7"],
    );
    says(
        &stated("name = \"ten\""),
        &["`arm.joint[1].name` is `ten`", "`one`, `two`"],
    );
    says(
        &stated("name = \"seven\""),
        &["`arm.joint[1].name` is `seven`", "no other `[[arm.joint]]`"],
    );
    assert_eq!(
        stated("name = \"one\"\nmin_deg = -90.0\nmax_deg = 90.0\nmax_speed_deg_s = 30.0"),
        ""
    );
}

#[test]
fn numbers_that_are_none_are_refused_with_their_line() {
    says(
        &refused(&[("xyz=\"0 0 0.2\"", "xyz=\"0 x 0.2\"")], &[]),
        &["`xyz` is `0 x 0.2`; expected 3 finite numbers", "line 16"],
    );
    says(
        &refused(&[("xyz=\"0 0 0.2\"", "xyz=\"0 0 0.2 0\"")], &[]),
        &["expected 3 finite numbers"],
    );
    says(
        &refused(&[("xyz=\"0 0 0.2\"", "xyz=\"0 0 inf\"")], &[]),
        &["expected 3 finite numbers"],
    );
    says(
        &refused(&[("xyz=\"0 0 0.2\"", "xyz=\"0 0 200\"")], &[]),
        &["expected 3 finite numbers of -10 to 10"],
    );
    says(
        &refused(&[("<axis xyz=\"0 2 0\"/>", "<axis xyz=\"0 0 0\"/>")], &[]),
        &["the axis of `six` has no direction", "cannot be used"],
    );
    // The axis of a fixed joint is never used.
    let stand = "<joint name=\"stand\" type=\"fixed\">";
    for axis in ["0 0 0", "a b c", ""] {
        let with_axis = format!("{stand}<axis xyz=\"{axis}\"/>");
        assert_eq!(refused(&[(stand, &with_axis)], &[]), "");
    }
    says(
        &refused(
            &[(
                "radius=\"0.07\"/></geometry></collision>",
                "radius=\"-1\"/></geometry></collision>",
            )],
            &[],
        ),
        &["`radius` is `-1`"],
    );
    says(
        &refused(&[("<sphere", "<torus")], &[]),
        &["`<torus>` is no shape"],
    );
    says(
        &refused(&[("<robot", "<sdf"), ("</robot>", "</sdf>")], &[]),
        &["it begins with `<sdf>`"],
    );
    says(
        &refused(&[("</robot>", "")], &[]),
        &["`arm.urdf`", "never closed"],
    );
    let xacro = "<xacro:arm xmlns:xacro=\"http://www.ros.org/wiki/xacro\"/></robot>";
    says(
        &refused(&[("</robot>", xacro)], &[]),
        &["xacro has expanded"],
    );
}

#[test]
fn a_link_without_a_shape_is_refused_and_not_free() {
    let box_of = "<collision>\n      <origin xyz=\"0 0 0.1\"/>\n      <geometry><box size=\"0.08 0.08 0.2\"/></geometry>\n    </collision>";
    let said = refused(&[(box_of, "")], &[]);
    says(
        &said,
        &["the link `elbow` has no shape, so nothing would keep it off the table"],
    );
    let shape = "[[arm.shape]]\nlink = \"elbow\"\nfrom_m = [0, 0, 0]\nto_m = [0, 0, 0.2]\nradius_m = 0.07\n[fingers]";
    assert_eq!(refused(&[(box_of, "")], &[("[fingers]", shape)]), "");
    let said = refused(&[], &[("[fingers]", &shape.replace("elbow", "base"))]);
    says(
        &said,
        &["`arm.shape[0].link` is `base`; expected a link that a joint of the arm moves"],
    );
    // Nothing is where two joints are in one place, unless it is drawn.
    let sphere = "<collision><geometry><sphere radius=\"0.07\"/></geometry></collision>";
    assert_eq!(refused(&[(sphere, "")], &[]), "");
    says(
        &refused(&[(sphere, &sphere.replace("collision", "visual"))], &[]),
        &["the link `shoulder` has no shape"],
    );
    // A visible part of the hand, too.
    let finger = "<collision><geometry><box size=\"0.015 0.01 0.07\"/></geometry></collision>";
    says(
        &refused(&[(finger, "")], &[]),
        &["the link `left_finger` has no shape"],
    );
}

#[test]
fn a_hand_without_a_shape_is_refused() {
    let said = refused(&[], &[("tip_link = \"hand\"", "tip_link = \"flange\"")]);
    assert_eq!(said, "", "the hand hangs from the flange");
    let edits = [("<parent link=\"flange\"/>", "<parent link=\"world\"/>")];
    let said = refused(&edits, &[("tip_link = \"hand\"", "tip_link = \"flange\"")]);
    says(&said, &["the hand has no shape", "`[[arm.hand]]`"]);
}

#[test]
fn meshes_that_cannot_be_read_are_refused() {
    let mesh = |name: &str| {
        refused(
            &[
                ("package://arms/wrist.stl", name),
                ("<robot name", "<!-- package://arms/ --><robot name"),
            ],
            &[],
        )
    };
    says(
        &mesh("wrist.dae"),
        &[
            "the link `wrist` has a shape that cannot be used",
            "`.stl` and `.obj`",
        ],
    );
    says(&mesh("none.stl"), &["the mesh `none.stl`"]);
    says(
        &mesh("package://other/none.stl"),
        &["there is no `other/none.stl` in any folder above"],
    );
    says(
        &mesh("http://host/wrist.stl"),
        &["`http://host/wrist.stl` is no file"],
    );
    let said = refused(&[(" scale=\"0.001 0.001 0.001\"", "")], &[]);
    says(
        &said,
        &[
            "a corner is `80.0` m from its middle",
            "is it in millimetres",
        ],
    );
}

#[test]
fn what_the_settings_say_of_the_arm_is_checked() {
    says(
        &refused(&[], &[("[arm]", "[arm]\nurdff = 3")]),
        &["`arm.urdff` is not a setting"],
    );
    says(
        &refused(&[], &[("home_deg = [0, 35", "home_deg = [0, 350")]),
        &["`arm.home_deg` holds `350` for the joint `two`"],
    );
    says(
        &refused(&[], &[("home_deg = [0, ", "home_deg = [")]),
        &["`arm.home_deg` holds 6 angles; expected 7"],
    );
    says(
        &refused(
            &[],
            &[("name = \"seven\"", "name = \"seven\"\nmodel = \"j2n6s200\"")],
        ),
        &["no `model` beside a section `[arm]`"],
    );
    let ros = "driver = \"kinova\"\nros = { master = \"http://a:1\", arm = \"/a\" }";
    says(
        &refused(&[], &[("driver = \"simulated\"", ros)]),
        &["`driver` is `kinova`, whose node moves"],
    );
    says(
        &refused(&[], &[("urdf = \"seven.urdf\"", "urdf = \"none.urdf\"")]),
        &["`arm.urdf`", "none.urdf`, cannot be used"],
    );
}

#[test]
fn a_description_nested_deeply_ends_soon() {
    let begun = std::time::Instant::now();
    let deep = format!(
        "{}{}</robot>",
        "<a>".repeat(100_000),
        "</a>".repeat(100_000)
    );
    refused(&[("</robot>", &deep)], &[]);
    assert!(begun.elapsed().as_secs() < 20);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    /// Whatever is cut out of the description, it is an arm or it is refused.
    #[test]
    fn a_description_cut_anywhere_is_an_arm_or_is_refused(at in 0.0..1.0f64, len in 1..200usize) {
        let text = std::fs::read_to_string(arms().join("seven.urdf")).unwrap();
        let at = (at * text.len() as f64) as usize;
        let end = (at + len).min(text.len());
        let cut = format!("{}{}", &text[..at], &text[end..]);
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("seven.urdf"), cut).unwrap();
        std::fs::copy(arms().join("seven.toml"), folder.path().join("seven.toml")).unwrap();
        match Settings::load(&folder.path().join("seven.toml")) {
            Ok(settings) => prop_assert!((6..=7).contains(&settings.chain().joints().len())),
            Err(error) => prop_assert!(error.to_string().contains("arm")),
        }
    }

    #[test]
    fn any_bytes_are_a_mesh_or_are_refused(bytes in prop::collection::vec(any::<u8>(), 0..400), is_text in any::<bool>()) {
        let mut bytes = bytes;
        if is_text {
            bytes.splice(0..0, *b"solid a\nvertex ");
        }
        for path in ["a.stl", "a.obj"].map(Path::new) {
            if let Ok(corners) = mesh::corners(path, &bytes) {
                prop_assert!(!corners.is_empty());
            }
        }
    }
}
