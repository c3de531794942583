fn main() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let a: Vec<String> = std::env::args().collect();
    let design = edof_spec::Design::load(&root.join(format!("designs/{}.json", a[1]))).unwrap();
    let network =
        edof_spec::weight_file::load_fixed(&root.join(format!("weights/{}.fixed.safetensors", a[2])))
            .unwrap();
    let t = std::time::Instant::now();
    match edof_hdl::project::calculator(&design, [&network, &network]) {
        Err(e) => println!("{e}"),
        Ok(p) => {
            std::fs::create_dir_all(&a[3]).unwrap();
            for (n, t) in &p.verilog {
                std::fs::write(format!("{}/{n}", a[3]), t).unwrap();
            }
            std::fs::create_dir_all(format!("{}/mem", a[3])).unwrap();
            for (n, t) in &p.memory {
                std::fs::write(format!("{}/{n}", a[3]), t).unwrap();
            }
            println!("{:?} {}", t.elapsed(), p.verilog.iter().map(|x| x.1.len()).sum::<usize>());
        }
    }
}
