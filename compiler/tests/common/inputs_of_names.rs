//! Generated inputs about names: unknown, repeated, many.

use super::{Input, KEYPOINTS, STAGE, WHOLE, input};

/// One input for each way in which names can be many or wrong.
pub const NAMES: &[Input] = &[
    // Names: unknown, repeated, many.
    input("unknown masks", KEYPOINTS, "k@ = centroid(u@)\n", "}}\n"),
    input("unknown functions", KEYPOINTS, "k@ = f@(1)\n", "}}\n"),
    input("unknown components", STAGE, "say u@\n", "}}\n"),
    input(
        "unknown components in one line",
        "task t {\nstage s {\nsay a",
        ", u@",
        "\n}}\n",
    ),
    input("unknown bases", "", "task t@ extends u@ { }\n", ""),
    input("unknown experts", "", "task t@ { experts u@ }\n", ""),
    input("unknown files", "", "use \"u@.fab\"\n", ""),
    input(
        "unknown arguments",
        "task t {\ncamera top_down(",
        "u@: 1mm, ",
        "a: 1)\n}\n",
    ),
    input(
        "one keypoint repeated",
        KEYPOINTS,
        "k = mask(depth < 1mm)\n",
        "}}\n",
    ),
    input(
        "one component repeated",
        "task t {\n",
        "component c \"a\"\n",
        "}\n",
    ),
    input(
        "one component overridden",
        "task t {\n",
        "override component c \"a\"\n",
        "}\n",
    ),
    input(
        "one component left out",
        "task t {\nwithout component c",
        ", c@",
        "\n}\n",
    ),
    input("one stage repeated", "task t {\n", "stage s { }\n", "}\n"),
    input("one section repeated", "task t {\n", "horizon 1\n", "}\n"),
    input("one task repeated", "", "task t { }\n", ""),
    input(
        "one file used again and again",
        "",
        "use \"input.fab\"\n",
        "",
    ),
    input("keypoints", KEYPOINTS, "k@ = mask(depth < 1mm)\n", "}}\n"),
    input(
        "centroids of the keypoint before",
        KEYPOINTS,
        "k@ = mask(depth < 1mm)\nc@ = centroid(k@)\n",
        "}}\n",
    ),
    input("components", "task t {\n", "component c@ \"a\"\n", "}\n"),
    input(
        "components said",
        "",
        "task t@ { component a \"b\" stage s { model text say a read action } }\n",
        "",
    ),
    input(
        "one component said often",
        "task t {\ncomponent a \"b\"\nstage s {\nmodel text\nsay a",
        ", a",
        "\nread action\n}}\n",
    ),
    input(
        "stages",
        "task t {\n",
        "stage s@ { model text say \"a\" read a from \"b {a}\" }\n",
        "}\n",
    ),
    input(
        "checks",
        "task t {\nverify {\n",
        "check c@ { distance(pick, place) > 1px } else \"a\"\n",
        "}}\n",
    ),
    input(
        "fields",
        "task t {\nactions {\n",
        "f@: one of a, b\n",
        "}}\n",
    ),
    input(
        "choices",
        "task t {\nactions {\npick: one of a",
        ", a@",
        "\n}}\n",
    ),
    input(
        "settings",
        "task t {\nstage s {\nmodel text",
        ", temperature @",
        "\n}}\n",
    ),
    input(
        "images",
        "task t {\nsubgoals {\n",
        "image \"@.png\"\n",
        "}}\n",
    ),
    input(
        "images that climb",
        "task t {\nsubgoals {\nimage \"",
        "../",
        "a.png\"\n}}\n",
    ),
    input(
        "folds",
        "task t {\nsubgoals {\ndemonstrate {\n",
        "fold corner(back_left) -> center\n",
        "}}}\n",
    ),
    input(
        "sequences",
        "experts e {\n",
        "sequence { fold corner(back_left) -> center }\n",
        "}\n",
    ),
    input(
        "units that are unknown",
        "task t {\n",
        "horizon @parsecs\n",
        "}\n",
    ),
    input(
        "tasks that extend one",
        "task base { horizon 1 }\n",
        "task t@ extends base { }\n",
        "",
    ),
    input(
        "tasks that extend themselves",
        "",
        "task t@ extends t@ { }\n",
        "",
    ),
    input("tasks with everything", "", WHOLE, ""),
];
