//! Writes the first corpus of every target: small valid files. Run it in this folder: `cargo run --example seeds`.

#[path = "../../tests/support/bodies.rs"]
mod bodies;
#[path = "../../tests/support/samples.rs"]
mod samples;

fn main() -> std::io::Result<()> {
    for (target, files) in samples::all().into_iter().chain(bodies::all()) {
        let folder = std::path::Path::new("corpus").join(target);
        std::fs::create_dir_all(&folder)?;
        for (number, file) in files.iter().enumerate() {
            std::fs::write(folder.join(format!("seed-{number}")), file)?;
        }
    }
    Ok(())
}
