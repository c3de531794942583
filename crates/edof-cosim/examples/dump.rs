fn main() {
    let mut args = std::env::args().skip(1);
    let (design, out) = (args.next().unwrap(), args.next().unwrap());
    let design = edof_device::Design::load(std::path::Path::new(&format!("designs/{design}.json"))).unwrap();
    let network = edof_random::for_design(&design, 1);
    let project = edof_hdl::project::spacious(|| edof_hdl::project::calculator(&design, [&network, &network]).unwrap());
    std::fs::create_dir_all(&out).unwrap();
    for (name, text) in &project.verilog {
        std::fs::write(format!("{out}/{name}"), text).unwrap();
    }
}
