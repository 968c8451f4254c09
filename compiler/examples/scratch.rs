//! scratch
use compiler::*;
struct D;
impl Loader for D { fn load(&self, name: &str) -> Result<String, LoadError> { std::fs::read_to_string(name).map_err(|e| LoadError{message: format!("{name}: {e}")}) } }
fn main() {
    let name = std::env::args().nth(1).unwrap();
    let c = compile(&name, &D).unwrap();
    print!("{}", diag::to_text(&c.diagnostics, &c.sources, diag::Color::Plain));
    for p in &c.programs { println!("{} {}", p.title(), p.hash());
      if std::env::args().nth(2).is_some() && p.variant.is_none() { println!("{}", serde_json::to_string_pretty(p).unwrap());
        for s in &p.stages { for m in render::messages(p, s, render::Values::Typed).unwrap() { println!("--- {:?}\n{}", m.speaker, m.text); } } } }
    println!("{:?}", c.tests);
}
