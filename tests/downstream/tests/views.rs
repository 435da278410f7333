//! Fields as arrays and matrices of other crates: the lines of docs/guide/results.md.

use viscocontact::prelude::*;

#[test]
fn fields_are_viewed_as_arrays_and_matrices() -> Result<(), Box<dyn std::error::Error>> {
    let mut contact = ViscoelasticContact::builder(Grid::new([24, 16], [4.0e-3, 3.0e-3])?)
        .geometry(&Sphere::new(10.0e-3)?)
        .material(Material::incompressible(Maxwell::new(1.0e6, 1.0e6)?))
        .build()?;
    contact.step(0.0, Load::force(0.1))?;

    let [n1, n2] = contact.grid().cells();
    let pressure = ndarray::ArrayView2::from_shape((n1, n2), contact.pressure())?;
    let matrix = faer::MatRef::from_row_major_slice(contact.pressure(), n1, n2);

    assert!(contact.fields().max_pressure() > 0.0);
    for (i, j) in (0..n1).flat_map(|i| (0..n2).map(move |j| (i, j))) {
        let p = contact.pressure()[i * n2 + j];
        assert!(pressure[[i, j]] == p && matrix[(i, j)] == p);
    }
    let page = include_str!("../../../docs/guide/results.md");
    let own = include_str!("views.rs").lines().take_while(|line| !line.contains("include_str"));
    for line in own.map(str::trim).filter(|line| line.starts_with("let ") && line.contains("n1, n2")) {
        assert!(page.contains(line), "the guide does not show {line}");
    }
    Ok(())
}
