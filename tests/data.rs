//! The tables in `data/` are those whose provenance `data/SOURCES.md` states.

use std::fs;
use std::path::Path;

/// FNV-1a, 64 bits: enough to notice an edit.
fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |h, b| {
        (h ^ u64::from(*b)).wrapping_mul(0x100_0000_01b3)
    })
}

const TABLES: &[(&str, u64)] = &[
    ("cie1931_2deg.csv", 0xbd1a_8467_f72c_4050),
    ("cie_s011_standard_general_sky.csv", 0xe984_95cf_b1bd_363c),
    ("diakite_colour.json", 0x01c8_4051_2601_3cbc),
    ("ephemeris/delta_t.csv", 0xeb4a_b841_b0c6_894e),
    ("ephemeris/truth.csv", 0xcc62_1448_8dae_186b),
    ("hosek2012_rgb.bin", 0x45b9_9493_2253_7efc),
    ("ozone_iqbal1983.csv", 0xe2c3_7ac0_ee97_f384),
    ("perez1990_efficacy.json", 0x6bc3_9111_9b41_7a33),
    ("perez1993_coefficients.csv", 0x0d6b_ec99_b044_b22e),
    ("places.csv", 0x4b6d_736e_3e90_78dc),
    ("preetham1999.json", 0xd8ae_475b_318f_54a1),
    ("sun_spectrum.csv", 0x18a3_e9e5_d99b_c2fb),
    ("twilight.bin", 0x86f3_8060_748b_eb15),
    ("twilight_illuminance.json", 0xd1c0_eb26_a383_72cb),
];

#[test]
fn every_table_is_the_one_whose_source_is_stated() {
    assert_eq!(checksum(b""), 0xcbf2_9ce4_8422_2325);
    assert_ne!(checksum(b"0.5"), checksum(b"0.6"));
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data");
    let sources = fs::read_to_string(folder.join("SOURCES.md")).unwrap();
    let mut found = 0;
    let names = |part: &str| -> Vec<String> {
        fs::read_dir(folder.join(part))
            .unwrap()
            .map(|entry| part.to_owned() + &entry.unwrap().file_name().into_string().unwrap())
            .collect()
    };
    for name in names("").into_iter().chain(names("ephemeris/")) {
        if !["csv", "json", "bin"]
            .iter()
            .any(|e| name.ends_with(&format!(".{e}")))
        {
            continue;
        }
        let sum = checksum(&fs::read(folder.join(&name)).unwrap());
        let stated = TABLES.iter().find(|(n, _)| *n == name);
        assert_eq!(
            stated.map(|(_, s)| *s),
            Some(sum),
            "data/{name} has checksum {sum:#018x}: state it here and its source in data/SOURCES.md"
        );
        assert!(
            sources.contains(&format!("`{name}`")),
            "data/SOURCES.md does not name {name}"
        );
        found += 1;
    }
    assert_eq!(found, TABLES.len(), "a table is missing");
}
