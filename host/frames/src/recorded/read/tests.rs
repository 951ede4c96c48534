use super::*;
use crate::array::{file::Content, mat};
use npyz::WriterBuilder;
use proptest::prelude::*;
use std::{
    ffi::OsStr,
    io::{self, Cursor},
};

fn npy_bytes<T: npyz::AutoSerialize>(shape: &[u64], order: npyz::Order, values: &[T]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let options = npyz::WriteOptions::new().default_dtype().shape(shape).order(order);
    let mut writer = options.writer(&mut bytes).begin_nd().unwrap();
    writer.extend(values).unwrap();
    writer.finish().unwrap();
    bytes
}

fn c_npy<T: npyz::AutoSerialize>(shape: &[u64], values: &[T]) -> Vec<u8> {
    npy_bytes(shape, npyz::Order::C, values)
}

fn npz_bytes(arrays: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let mut archive = npyz::npz::NpzWriter::new(&mut file);
    for (name, bytes) in arrays {
        archive.zip_writer().start_file(format!("{name}.npy"), Default::default()).unwrap();
        io::Write::write_all(archive.zip_writer(), bytes).unwrap();
    }
    drop(archive);
    file.into_inner()
}

/// A header as a forger would write it, and data.
fn forged(header: &str, data: &[u8]) -> Vec<u8> {
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    bytes
}

fn parse(content: Content, bytes: &[u8]) -> Result<Frames, Problem> {
    frames_of(content.parse(bytes, None)?)
}

fn problem(content: Content, bytes: &[u8]) -> String {
    parse(content, bytes).unwrap_err().to_string()
}

fn real(frames: &Frames) -> Vec<f64> {
    frames.values.iter().map(|value| value.re).collect()
}

#[test]
fn every_kind_of_number_is_read() {
    let expect = |bytes: &[u8], complex: bool, values: [Complex64; 2]| {
        let frames = parse(Content::Npy, bytes).unwrap();
        assert_eq!(frames, Frames { values: values.to_vec(), frames: 1, measurements: 2, complex });
    };
    let real = [Complex64::new(-3.0, 0.0), Complex64::new(100.0, 0.0)];
    expect(&c_npy(&[2], &[-3.0_f64, 100.0]), false, real);
    expect(&c_npy(&[2], &[-3.0_f32, 100.0]), false, real);
    expect(&c_npy(&[2], &[-3_i8, 100]), false, real);
    expect(&c_npy(&[2], &[-3_i16, 100]), false, real);
    expect(&c_npy(&[2], &[-3_i32, 100]), false, real);
    expect(&c_npy(&[2], &[-3_i64, 100]), false, real);
    expect(&c_npy(&[2], &[3_u8, 200]), false, [3.0.into(), 200.0.into()]);
    expect(&c_npy(&[2], &[3_u64, 200]), false, [3.0.into(), 200.0.into()]);
    let complex = [Complex64::new(1.5, -2.0), Complex64::new(0.0, 4.0)];
    expect(&c_npy(&[2], &complex), true, complex);
    expect(
        &c_npy(&[2], &complex.map(|v| num_complex::Complex32::new(v.re as f32, v.im as f32))),
        true,
        complex,
    );
}

#[test]
fn big_endian_numbers_are_read() {
    let header = "{'descr': '>i2', 'fortran_order': False, 'shape': (2,)}";
    let frames = parse(Content::Npy, &forged(header, &[0xFF, 0xFE, 0x01, 0x00])).unwrap();
    assert_eq!(real(&frames), [-2.0, 256.0]);
}

#[test]
fn allowed_shapes_become_frames_of_measurements() {
    let shape = |shape: &[u64]| {
        let values = vec![1.0; shape.iter().product::<u64>() as usize];
        parse(Content::Npy, &c_npy(shape, &values)).map(|frames| (frames.frames, frames.measurements))
    };
    assert_eq!(shape(&[208]).unwrap(), (1, 208));
    assert_eq!(shape(&[5, 208]).unwrap(), (5, 208));
    assert_eq!(shape(&[5, 16, 16]).unwrap(), (5, 256));
    assert_eq!(shape(&[16, 16]).unwrap(), (16, 16));
    assert_eq!(shape(&[208, 1]).unwrap(), (1, 208), "one column");
    for bad in [&[5, 16, 13][..], &[1, 2, 3, 4], &[]] {
        assert!(matches!(shape(bad), Err(Problem::Shape { .. })), "{bad:?}");
    }
    assert!(shape(&[0, 208]).unwrap_err().to_string().contains("empty: shape (0, 208)"));
}

#[test]
fn an_array_as_large_as_the_electrodes_squared_is_one_frame() {
    let shape = |rows: u64, columns: u64, electrodes, steps| {
        let values = vec![1.0; (rows * columns) as usize];
        let frames = parse(Content::Npy, &c_npy(&[rows, columns], &values)).unwrap();
        let frames = frames.with_square(electrodes, steps);
        (frames.frames, frames.measurements)
    };
    assert_eq!(shape(16, 16, 16, 208), (1, 256));
    assert_eq!(shape(8, 8, 8, 40), (1, 64));
    assert_eq!(shape(16, 16, 8, 40), (16, 16), "not of 8 electrodes");
    assert_eq!(shape(5, 208, 16, 208), (5, 208));
    assert_eq!(shape(16, 16, 16, 16), (16, 16), "frames of 16 steps");
}

#[test]
fn a_first_line_is_a_header_only_if_it_names_every_column() {
    let read = |text: &str| parse(Content::Table, text.as_bytes()).map(|frames| real(&frames));
    assert_eq!(read("v_0,_x,Kanal 3\n1,2,3\n").unwrap(), [1.0, 2.0, 3.0]);
    assert_eq!(read("\"v0\",\"v1\"\n1,2\n").unwrap(), [1.0, 2.0]);
    for (text, cell) in [
        ("1,5,5;2,5\n1;2\n", "line 1, column 1: `1,5,5`"),
        ("-;-\n1;2\n", "line 1, column 1: `-`"),
        (",\n1,2\n", "line 1, column 1: ``"),
        ("a,2\n1,2\n", "line 1, column 1: `a`"),
        ("3V,4V\n1,2\n", "line 1, column 1: `3V`"),
        ("n/a,n/a\n1,2\n", "line 1, column 1: `n/a`"),
        ("a,b\nc,d\n1,2\n", "line 2, column 1: `c`"),
    ] {
        let problem = read(text).unwrap_err().to_string();
        assert!(problem.contains(cell), "{text:?}: {problem}");
    }
    assert!(
        read("nan,inf\n1,2\n").unwrap_err().to_string().contains("frame 0"),
        "numbers, though not finite"
    );
}

#[test]
fn fortran_order_is_turned_into_c_order() {
    let stored: Vec<f64> = (0..18).map(f64::from).collect();
    let frames = parse(Content::Npy, &npy_bytes(&[2, 3, 3], npyz::Order::Fortran, &stored)).unwrap();
    // Element (i, j, k) lies at i + 2 j + 6 k.
    assert_eq!(real(&frames)[..4], [0.0, 6.0, 12.0, 2.0]);
    assert_eq!(real(&frames)[9..12], [1.0, 7.0, 13.0]);
}

#[test]
fn forged_headers_are_refused_without_allocating() {
    let header = |shape: &str| format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
    let claim = problem(Content::Npy, &forged(&header("(10000000000, 256)"), &[0; 16]));
    assert!(
        claim.contains("(10000000000, 256) needs 20480000000000 bytes of data, the file holds 16"),
        "{claim}"
    );
    let overflow = problem(Content::Npy, &forged(&header("(9999999999, 9999999999)"), &[0; 16]));
    assert!(overflow.contains("more than 2^64"), "{overflow}");
    let mut long = b"\x93NUMPY\x02\x00".to_vec();
    long.extend(u32::MAX.to_le_bytes());
    assert!(problem(Content::Npy, &long).contains("claims 4294967295 bytes, at most 10000"));
}

#[test]
fn wrong_files_say_what_is_wrong() {
    let good = c_npy(&[4], &[1.0, 2.0, 3.0, 4.0]);
    let truncated = problem(Content::Npy, &good[..good.len() - 3]);
    assert!(truncated.contains("shape (4,) needs 32 bytes of data, the file holds 29"), "{truncated}");
    assert!(problem(Content::Npy, b"PK\x03\x04").contains("does not start with"));
    assert!(problem(Content::Npy, b"").contains("does not start with"));
    assert!(problem(Content::Npy, b"\x93NUMPY\x09\x00").contains("version 9.0"));
    assert!(problem(Content::Npy, &good[..40]).contains("`length`"));
    assert!(problem(Content::Npz, &good).contains("not a readable .npz archive"));
    assert!(problem(Content::Npz, &npz_bytes(&[])).contains("no array"));
    let text = forged("{'descr': '<U7', 'fortran_order': False, 'shape': (1,)}", &[0; 28]);
    assert!(problem(Content::Npy, &text).contains("type `<U7`, allowed are float64"));
    let fields = forged("{'descr': [('a', '<f8')], 'fortran_order': False, 'shape': (1,)}", &[0; 8]);
    assert!(problem(Content::Npy, &fields).contains("`structured`"));
}

#[test]
fn a_number_that_is_not_finite_is_named() {
    let nan = problem(Content::Npy, &c_npy(&[2, 3], &[1.0, 2.0, 3.0, 4.0, f64::NAN, 6.0]));
    assert!(nan.contains("frame 1, measurement 1 (counted from 0) is NaN"), "{nan}");
    let infinite = problem(Content::Table, b"1,2\n3,inf\n");
    assert!(infinite.contains("frame 1, measurement 1"), "{infinite}");
}

#[test]
fn an_archive_with_several_arrays_asks_which() {
    let bytes = npz_bytes(&[("v", c_npy(&[3, 208], &[1_f32; 624])), ("t", c_npy(&[3], &[1.0; 3]))]);
    let asked = problem(Content::Npz, &bytes);
    assert!(asked.contains("`t` (3,) <f8, `v` (3, 208) <f4"), "{asked}");
    assert_eq!(Content::Npz.parse(&bytes, Some("v")).unwrap().shape, [3, 208]);
    let missing = Content::Npz.parse(&bytes, Some("w")).err().unwrap().to_string();
    assert!(missing.contains("no array `w`; there are: `t` (3,)"), "{missing}");
    let single = npz_bytes(&[("only", c_npy(&[3], &[1.0; 3]))]);
    assert_eq!(parse(Content::Npz, &single).unwrap().measurements, 3);
}

#[test]
fn tables_are_read_whatever_separates_their_cells() {
    let read = |text: &str| {
        let frames = parse(Content::Table, text.as_bytes()).unwrap();
        ((frames.frames, frames.measurements), real(&frames))
    };
    let two_frames = ((2, 3), vec![1.0, 2.5, -3.0, 4.0, 5e-1, 6.0]);
    assert_eq!(read("1,2.5,-3\n4,5e-1,6\n"), two_frames);
    assert_eq!(read("# made by hand\nm0;m1;m2\r\n1;2.5;-3;\r\n4;5e-1;6;\r\n"), two_frames);
    assert_eq!(read("\u{feff}a\tb\tc\n1\t2.5\t-3\n\n# pause\n4\t5e-1\t6"), two_frames);
    assert_eq!(read("  1 2.5   -3\n4 5e-1 6 \n"), two_frames);
    assert_eq!(read("v\n1\n2\n3\n"), ((1, 3), vec![1.0, 2.0, 3.0]), "a column is one frame");
    let complex = parse(Content::Table, b"1+2j,(3.5e+00+-1e-1j)\n").unwrap();
    assert!(complex.complex);
    assert_eq!(complex.values, [Complex64::new(1.0, 2.0), Complex64::new(3.5, -0.1)]);
}

#[test]
fn damaged_tables_name_the_line() {
    let cell = problem(Content::Table, b"1,2\n3,x\n");
    assert!(cell.contains("line 2, column 2: `x` is not a number"), "{cell}");
    let row = problem(Content::Table, b"a,b\n1,2\n3\n");
    assert!(row.contains("line 3 has 1 columns, the lines before it have 2"), "{row}");
    assert!(problem(Content::Table, b"").contains("empty"));
    assert!(problem(Content::Table, b"a,b\n").contains("empty"));
}

#[test]
fn only_a_colon_after_npz_starts_a_key() {
    let split = |text: &str| {
        let source = Source::new(OsStr::new(text));
        (source.path.to_str().unwrap().to_owned(), source.key)
    };
    assert_eq!(split("run.npz:v"), ("run.npz".into(), Some("v".into())));
    assert_eq!(split(r"C:\run.NPZ:v"), (r"C:\run.NPZ".into(), Some("v".into())));
    assert_eq!(split(r"C:\run.npz"), (r"C:\run.npz".into(), None));
    assert_eq!(split("a:b.npy"), ("a:b.npy".into(), None));
    assert_eq!(Source::new(OsStr::new("run.npz:v")).to_string(), "run.npz:v");
}

#[test]
fn errors_name_the_file() {
    let error = read(&Source::new(OsStr::new("nowhere/run.npz:v"))).unwrap_err().to_string();
    assert!(error.starts_with("cannot read frames from `nowhere/run.npz:v`: "), "{error}");
    let ending = read(&Source::new(OsStr::new("run.xls"))).unwrap_err().to_string();
    assert!(ending.contains("must end in .npy, .npz, .csv, .txt, .mat, .eit or .get"), "{ending}");
}

/// A MATLAB file of matrices, perhaps each compressed.
fn mat_bytes(arrays: &[(&str, Array<'_>)], compressed: bool) -> Vec<u8> {
    let mut bytes = Vec::new();
    mat::write_header(&mut bytes).unwrap();
    for (name, array) in arrays {
        let mut element = Vec::new();
        mat::write_array(&mut element, name, array).unwrap();
        if compressed {
            let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
            io::Write::write_all(&mut encoder, &element).unwrap();
            let stream = encoder.finish().unwrap();
            element = [&15_u32.to_le_bytes()[..], &(stream.len() as u32).to_le_bytes(), &stream].concat();
        }
        bytes.extend(element);
    }
    bytes
}

#[test]
fn columns_of_a_matlab_matrix_are_frames() {
    let frames = || Array::table(3, 2, |measurement, frame| (10 * frame + measurement) as f64);
    for compressed in [false, true] {
        let read = parse(Content::Mat, &mat_bytes(&[("vv", frames())], compressed)).unwrap();
        assert_eq!((read.frames, read.measurements), (2, 3));
        assert_eq!(real(&read), [0.0, 1.0, 2.0, 10.0, 11.0, 12.0]);
        let complex = Array::table(2, 1, |row, _| Complex64::new(row as f64, -1.0));
        let several = mat_bytes(&[("vv", frames()), ("z", complex)], compressed);
        assert!(problem(Content::Mat, &several).contains("`vv` (2, 3), `z` (2,)"));
        let chosen = frames_of(Content::Mat.parse(&several, Some("z")).unwrap()).unwrap();
        assert_eq!(chosen.values, [Complex64::new(0.0, -1.0), Complex64::new(1.0, -1.0)]);
        let missing = Content::Mat.parse(&several, Some("v")).err().unwrap().to_string();
        assert!(missing.contains("no array `v`"), "{missing}");
        let cut = &several[..several.len() - 9];
        assert!(problem(Content::Mat, cut).contains("truncated or damaged"));
    }
}

#[test]
fn matlab_files_of_version_7_3_are_refused_with_what_to_do() {
    let hdf = [vec![0; 512], b"\x89HDF\r\n\x1a\n".to_vec()].concat();
    for bytes in [b"MATLAB 7.3 MAT-file, Platform".to_vec(), hdf] {
        let refused = problem(Content::Mat, &bytes);
        assert!(refused.contains("7.3") && refused.contains("'-v7'"), "{refused}");
    }
    assert!(problem(Content::Mat, b"junk").contains("not a MATLAB file"));
}

#[test]
fn decimal_commas_are_read_where_something_else_separates_cells() {
    let read = |text: &str| real(&parse(Content::Table, text.as_bytes()).unwrap());
    let expected = [1.5, -2.25, 3.0, 4e-3];
    for text in ["1,5;-2,25\n3;4e-3", "1,5\t-2,25\n3,0\t4,0e-3", "1,5 -2,25\n3,0 4,0e-3"] {
        assert_eq!(read(text), expected, "{text}");
    }
    assert_eq!(read("1,5,2\n"), [1.0, 5.0, 2.0]);
    assert_eq!(read("1, 5, 2\n"), [1.0, 5.0, 2.0]);
    let twice = problem(Content::Table, b"1,5;1,2,3\n");
    assert!(twice.contains("line 1, column 2: `1,2,3`"), "{twice}");
}

#[test]
fn a_table_of_phasors_is_one_frame() {
    let table = parse(Content::Table, b"n\tVr\tVi\tI\n1\t2\t4\t2\n2\t-3\t0\t1\n").unwrap();
    assert_eq!((table.frames, table.measurements, table.complex), (1, 2, true));
    assert_eq!(table.values, [Complex64::new(1.0, 2.0), Complex64::new(-3.0, 0.0)]);
    let plain = parse(Content::Table, b"Vr;Vi\n1,5;2\n").unwrap();
    assert_eq!(plain.values, [Complex64::new(1.5, 2.0)]);
    let none = problem(Content::Table, b"Vr,Vi,I\n1,2,1\n1,2,0\n");
    assert!(none.contains("line 3: the current I is zero"), "{none}");
    let instrument = b"Channel : 2\nFrequency : 10kHz\n\nData\n1 2 9 9\n3 4 9 9\n5 6 9 9\n7 8 9 9\n";
    let read = parse(Content::Table, instrument).unwrap();
    assert_eq!((read.frames, read.measurements), (1, 4));
    assert_eq!(read.values[3], Complex64::new(7.0, 8.0));
    assert!(parse(Content::Table, b"a : b\nData\n1\n").is_err());
}

#[test]
fn potentials_become_differences_and_columns_frames() {
    let steps: Vec<Step> =
        dermatome_shared::stimulation::pattern(4, 1, 1, dermatome_shared::stimulation::Driven::Measured)
            .collect();
    let square = parse(Content::Npy, &c_npy(&[1, 4, 4], &[1.0, 3.0, 6.0, 10.0].repeat(4))).unwrap();
    let apart = square.clone().apart(&steps, 4).unwrap();
    assert_eq!(real(&apart)[..4], [-2.0, -3.0, -4.0, 9.0]);
    let error = square.apart(&steps, 5).unwrap_err().to_string();
    assert!(error.contains("16") && error.contains("25"), "{error}");
    let turned = parse(Content::Table, b"1,2\n3,4\n5,6\n").unwrap().transposed();
    assert_eq!((turned.frames, turned.measurements), (2, 3));
    assert_eq!(real(&turned), [1.0, 3.0, 5.0, 2.0, 4.0, 6.0]);
}

#[test]
fn the_mean_of_frames_is_taken_per_measurement() {
    let frames = parse(Content::Table, b"1,2\n3,6\n").unwrap();
    assert_eq!(frames.mean(), [Complex64::new(2.0, 0.0), Complex64::new(4.0, 0.0)]);
}

fn parse_as_everything(bytes: &[u8]) {
    let _ = parse(Content::Npy, bytes);
    let _ = parse(Content::Table, bytes);
    let _ = parse(Content::Npz, bytes);
    let _ = parse(Content::Mat, bytes);
    let _ = parse(Content::Sciospec, bytes);
    let _ = parse(Content::Get, bytes);
    let _ = Content::Npz.parse(bytes, Some("v")).map(frames_of);
}

fn valid_files() -> Vec<Vec<u8>> {
    let array = c_npy(&[2, 2, 2], &[Complex64::new(1.0, -1.0); 8]);
    let several = npz_bytes(&[("v", array.clone()), ("w", c_npy(&[3], &[1_i16, 2, 3]))]);
    let table = b"# x\na,b\n1.5,2+1j\n-3e2,4\n".to_vec();
    let matrices = |compressed| mat_bytes(&[("v", Array::table(2, 2, |row, _| row as f64))], compressed);
    let eit = b"9\nsetup\n2025\n1\n1\n0\n1\n0.1\n1\n1 2\n1 2 3 4\n2 1\n5 6 7 8\n".to_vec();
    let phasors = b"Channel : 2\nData\n1 2\n3 4\n".to_vec();
    let get = [&b"---Draeger EIT-Software---\n\n\n"[..], &[0; 1024]].concat();
    vec![
        array.clone(),
        npz_bytes(&[("v", array)]),
        several,
        table,
        matrices(false),
        matrices(true),
        eit,
        phasors,
        get,
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn no_bytes_make_the_readers_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        parse_as_everything(&bytes);
        parse_as_everything(&[b"\x93NUMPY\x01\x00\x40\x00".as_slice(), &bytes].concat());
        parse_as_everything(&[b"PK\x03\x04".as_slice(), &bytes].concat());
    }

    #[test]
    fn no_damage_makes_the_readers_panic(
        file in 0..9_usize,
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        cut in prop::option::of(any::<prop::sample::Index>()),
    ) {
        let mut bytes = valid_files().swap_remove(file);
        for (place, value) in damage {
            let place = place.index(bytes.len());
            bytes[place] = value;
        }
        bytes.truncate(cut.map_or(bytes.len(), |cut| cut.index(bytes.len())));
        parse_as_everything(&bytes);
    }

    #[test]
    fn no_header_text_makes_the_reader_panic(header in "[{}()\\[\\]'\":, a-zé0-9<>|L]{0,80}", field in 0..3_usize) {
        let fields = ["'descr': ", "'fortran_order': ", "'shape': "];
        let mut complete = String::from("{'descr': '<f8', 'fortran_order': True, 'shape': (2,)}");
        complete.insert_str(complete.find(fields[field]).unwrap() + fields[field].len(), &header);
        parse_as_everything(&forged(&complete, &[0; 16]));
        parse_as_everything(&forged(&header, &[0; 16]));
    }
}
