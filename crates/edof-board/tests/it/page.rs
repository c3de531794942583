//! docs/host.md says of registers what the program does.

use edof_device::registers::markdown;

#[test]
fn the_register_map_of_the_page_is_the_programs() {
    let page = include_str!("../../../../docs/host.md");
    let (_, rest) = page.split_once("<!-- registers -->\n").unwrap();
    let (found, _) = rest.split_once("<!-- end -->").unwrap();
    let expected = markdown::page().replace("# Registers\n\n", "").replace("\n## ", "\n### ");
    assert_eq!(found, expected, "docs/host.md: must have between its marks:\n{expected}");
}
