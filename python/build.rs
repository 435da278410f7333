//! Lets the linker of macOS leave to Python what the module takes from it.

fn main() {
    pyo3_build_config::add_extension_module_link_args();
}
