//! Command lines of mmg3d and refine.
use super::{translated, typed};
use std::ffi::OsString;

/// What is typed here for a command line.
fn ours(line: &str) -> Result<String, String> {
    let words: Vec<OsString> = line.split_whitespace().map(OsString::from).collect();
    translated(&words).expect("it is known as one of another adapter").map(|command| typed(&command.words))
}

#[test]
fn lines_of_mmg3d_are_understood() {
    for (line, expected) in [
        ("mmg3d -in a.mesh -sol m.sol -out b.mesh", "geo-adapt adapt a.mesh --metric m.sol -o b.mesh"),
        ("-in a.mesh -met m.sol -out b.mesh", "geo-adapt adapt a.mesh --metric m.sol -o b.mesh"),
        ("mmg3d_O3 a.meshb b.meshb -hsiz 0.1 -v 0", "geo-adapt adapt a.meshb --size 0.1 -o b.meshb --quiet"),
        (
            "mmg3d -v 5 a.mesh -sol m.sol -hmin 0.01 -hmax 1 -hgrad 1.3 -hausd 1e-3 -ar 30",
            "geo-adapt adapt a.mesh --metric m.sol --hmin 0.01 --hmax 1 --gradation 1.3 --hausdorff 1e-3 --ridge-angle 30 -o a.o.mesh",
        ),
        ("adapt -in a.mesh -sol m.sol -out b.mesh", "geo-adapt adapt a.mesh --metric m.sol -o b.mesh"),
        (
            "mmg3d a.mesh -sol m.sol -hgrad -1 -nr",
            "geo-adapt adapt a.mesh --metric m.sol --gradation off --ridge-angle none -o a.o.mesh",
        ),
    ] {
        assert_eq!(ours(line).as_deref(), Ok(expected), "{line}");
    }
}

#[test]
fn lines_of_refine_are_understood() {
    for (line, expected) in [
        (
            "ref adapt a.meshb -g m.egads -m m.solb -x b.meshb -s 30 -t",
            "geo-adapt adapt a.meshb --cad m.egads --metric m.solb -o b.meshb",
        ),
        ("ref bootstrap dir/wing.egads", "geo-adapt bootstrap dir/wing.egads -o wing-vol.meshb"),
        (
            "ref multiscale a.meshb mach.solb 50000 m.solb --norm-power 2 --gradation 1.5",
            "geo-adapt metric multiscale a.meshb mach.solb --complexity 50000 -o m.solb --norm 2 --gradation 1.5",
        ),
        ("ref translate a.meshb a.su2", "geo-adapt convert a.meshb a.su2"),
        ("ref interpolate a.meshb a.solb b.meshb b.solb", "geo-adapt transfer a.meshb a.solb b.meshb -o b.solb"),
        ("ref examine a.meshb", "geo-adapt inspect a.meshb"),
    ] {
        assert_eq!(ours(line).as_deref(), Ok(expected), "{line}");
    }
}

#[test]
fn what_has_no_counterpart_is_answered() {
    for (line, said) in [
        ("mmg3d a.mesh", "give -sol FILE, or -hsiz H"),
        ("mmg3d a.mesh -optim", "geo-adapt metric implied a.mesh -o a.own.solb"),
        ("mmg3d a.mesh -sol m.sol -nosurf", "--freeze"),
        ("mmg3d -sol m.sol", "-in MESH"),
        ("mmg3d a.mesh -sol m.sol -hmin", "-hmin wants a value"),
        ("mmg3d a.mesh -sol m.sol -hmin x", "-hmin x: give a number"),
        ("mmg3d a.mesh -sol m.sol -frobnicate", "-frobnicate: it is no option of mmg3d that is known here"),
        ("ref", "ref wants a command"),
        ("ref adapt a.meshb -x b.meshb", "geo-adapt metric implied a.meshb -o a.own.solb"),
        ("ref adapt a.meshb -m m.solb", "give -x OUT.meshb"),
        ("ref loop a b 1000", "geo-adapt cycle"),
        ("ref translate a.meshb", "it takes MESH OUT, and there are 1 words"),
        ("ref quilt a.egads", "ref quilt is not known here"),
    ] {
        let answer = ours(line).expect_err(line);
        assert!(answer.contains(said), "{line}: {answer}");
    }
}

#[test]
fn our_own_lines_are_left_alone() {
    for line in ["adapt a.meshb", "--help", "-h", "-V", "model a.step", ""] {
        let words: Vec<OsString> = line.split_whitespace().map(OsString::from).collect();
        assert_eq!(translated(&words), None, "{line}");
    }
}

#[test]
fn a_line_is_typed_as_a_shell_takes_it() {
    let words = ["adapt", "my mesh.meshb", "it's", ""].map(OsString::from);
    assert_eq!(typed(&words), r"geo-adapt adapt 'my mesh.meshb' 'it'\''s' ''");
}

#[test]
fn our_own_lines_stay_as_they_are() {
    for line in [
        "adapt a.mesh --metric m.sol -o b.mesh -v",
        "adapt a.mesh --hmin 1 -out b.mesh",
        "adapt -h",
        "inspect -in a.mesh",
    ] {
        let words: Vec<OsString> = line.split_whitespace().map(OsString::from).collect();
        assert_eq!(translated(&words), None, "{line}");
    }
}
