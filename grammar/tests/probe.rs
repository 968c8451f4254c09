#[test] fn probe(){
 let f=std::env::var("F").unwrap(); let t=std::fs::read_to_string(f).unwrap();
 let p=grammar::parse(&t);
 let back:String=p.tree.leaves().map(|l|l.text()).collect(); assert_eq!(back,t);
 for f in &p.faults { println!("{:?} {:?}",&t[f.span.clone()],f);}
}
