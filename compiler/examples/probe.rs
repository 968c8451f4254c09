//! probe
use compiler::*;
struct D(std::path::PathBuf);
impl Loader for D {
    fn load(&self, n: &str) -> Result<String, LoadError> {
        std::fs::read_to_string(self.0.join(n)).map_err(|_| LoadError {
            message: format!("there is no file `{n}`"),
        })
    }
}
fn main() {
    for f in std::env::args().skip(1) {
        let p = std::path::Path::new(&f);
        let c = compile(
            p.file_name().unwrap().to_str().unwrap(),
            &D(p.parent().unwrap().into()),
        )
        .unwrap();
        if std::env::var("J").is_ok() {
            println!("{}", diag::to_json(&c.diagnostics, &c.sources));
            continue;
        }
        print!(
            "{}",
            diag::to_text(&c.diagnostics, &c.sources, diag::Color::Plain)
        );
        for p in &c.programs {
            println!("program {} {}", p.task, p.hash());
            if std::env::var("V").is_ok() {
                println!("{}", serde_json::to_string_pretty(p).unwrap());
                let b = render::placeholders(p);
                for s in &p.stages {
                    for m in render::messages(p, s, &b).unwrap() {
                        println!("--- {:?} {:?}\n{}", m.speaker, m.pictures, m.text);
                    }
                }
            }
        }
    }
}
