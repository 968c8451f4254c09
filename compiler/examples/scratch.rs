//! scratch
use compiler::*;
struct D(String);
impl Loader for D {
    fn load(&self, name: &str) -> Result<String, LoadError> {
        std::fs::read_to_string(format!("{}/{}", self.0, name)).map_err(|_| LoadError {
            message: format!("there is no file `{name}`"),
        })
    }
}
fn main() {
    let dir = std::env::args().nth(1).unwrap();
    let name = std::env::args().nth(2).unwrap();
    let mode = std::env::args().nth(3).unwrap_or_default();
    let c = compile(&name, &D(dir)).unwrap();
    if mode == "json" {
        println!("{}", diag::to_json(&c.diagnostics, &c.sources));
        return;
    }
    print!(
        "{}",
        diag::to_text(&c.diagnostics, &c.sources, diag::Color::Plain)
    );
    for p in &c.programs {
        println!("{} {}", p.title(), p.hash());
        if mode == "x" && p.variant.is_none() {
            println!("{}", serde_json::to_string_pretty(p).unwrap());
            for s in &p.stages {
                for m in render::messages(p, s, render::Values::Typed).unwrap() {
                    println!("--- {:?}\n{}", m.speaker, m.text);
                }
            }
        }
    }
    for t in &c.tests {
        let p = c
            .programs
            .iter()
            .find(|p| p.task == t.task && p.variant.is_none())
            .unwrap();
        let r = trial::run(p, t);
        println!("{} {} {}", t.name, r.is_expected, r.finding);
    }
}
