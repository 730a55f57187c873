//! Small valid files of every format: the property tests mutate them, and the fuzz targets start from them.

/// A format's name and its samples.
pub(crate) fn all() -> Vec<(&'static str, Vec<Vec<u8>>)> {
    vec![
        ("text", texts()),
        ("tressfx3", vec![tressfx3(2, 3), tressfx3(1, 2)]),
        ("tressfx4", vec![tressfx4(2, 3), tressfx4(1, 2)]),
        ("hair", vec![hair(&[1, 0, 3], 0b11111), hair(&[2, 2], 0b00010)]),
        ("obj", obj()),
    ]
}

/// Text of 2013, with and without the third texture coordinate; 2.0 with commas and CRLF.
fn texts() -> Vec<Vec<u8>> {
    let guide = "numStrands 2 is_sorted 0\n\
                 strand 0 numVerts 3 texcoord 0.5 0.25 0.0\n0 0 0\n0 1 0\n0.1 2 -0.0\n\
                 strand 1 numVerts 2 texcoord 0.75 0.125 0.0\n1 0 0\n1 1e-3 -1.5e2\n";
    let version_2 = "version 2.0\nscale 2.0\nrotation 0 90 0\ntranslation 1 2 3\nbothEndsImmovable 1\n\
                     maxNumVerticesInStrand 4\nnumFollowHairsPerGuideHair 4\nmaxRadiusAroundGuideHair 1.5\n\
                     numStrands 1\nis sorted 1\nstrand 0 numVerts 2 texcoord 0.000000 000000\n\
                     -7.929126, 21.516727, 52.696167\n-7.999047,24.712219,57.104229\n";
    let bare = "numStrands 1\nstrand 0 numVerts 1\n0 0 0\n";
    vec![guide.into(), version_2.replace('\n', "\r\n").into(), version_2.into(), bare.into()]
}

/// Lines with two vertices each, one with many, a negative index, and a mesh around them.
fn obj() -> Vec<Vec<u8>> {
    let blender = "# comment\nmtllib a.mtl\no Mesh\nv 0 0 0\nv 0 1 0\nv 0 2 0\nv 1 0 0\nv 1 1 0\nl 1 2\nl 2 3\nl 4 5\n";
    let mixed =
        "v 0 0 0 1\nv 0 1 0 1\nv 0 2 0 1\nvt 0 0\nvn 0 1 0\nl 3/1 2/1 1/1\nv 5 5 5\nv 6 6 6\nl -1 -2\nf 1 2 3\n";
    vec![blender.into(), mixed.into()]
}

/// A 4.x file with every array.
pub(crate) fn tressfx4(strands: u32, vertices: u32) -> Vec<u8> {
    let (header, total) = (160, strands * vertices);
    let uv = header + 16 * total;
    let vertex_uv = uv + 8 * strands;
    let thickness = vertex_uv + 8 * total;
    let color = thickness + 4 * strands;
    let mut file = 4.0f32.to_le_bytes().to_vec();
    push_u32(&mut file, &[strands, vertices, header, uv, vertex_uv, thickness, color]);
    file.resize(header as usize, 0);
    for vertex in 0..total {
        let w = if vertex % vertices < 2 { 0.0 } else { 1.0 };
        push_f32(&mut file, &[vertex as f32, 0.5, -0.25, w]);
    }
    push_ramp(&mut file, 2 * strands + 2 * total + strands);
    push_shares(&mut file, 4 * total);
    file
}

/// A 3.x file with every array.
fn tressfx3(strands: u32, vertices: u32) -> Vec<u8> {
    let (header, total) = (296, strands * vertices);
    let thickness = header + 12 * total;
    let uv = thickness + 4 * strands;
    let color = uv + 8 * strands;
    let guide_index = color + 16 * total;
    let vertex_uv = guide_index + 4 * strands;
    let mut file = 3.0f32.to_le_bytes().to_vec();
    push_u32(&mut file, &[strands, vertices, 4, 1]);
    file.resize(144, 0);
    push_u32(&mut file, &[header, thickness, uv, color, guide_index, vertex_uv]);
    file.resize(header as usize, 0);
    push_ramp(&mut file, 3 * total + strands + 2 * strands);
    push_shares(&mut file, 4 * total);
    (0..strands).for_each(|strand| push_u32(&mut file, &[strand]));
    push_ramp(&mut file, 2 * total);
    file
}

/// A `.hair` file with the arrays whose bits are set; without the segments, all strands must have as many as the first.
fn hair(segments: &[u16], bits: u32) -> Vec<u8> {
    let points: u32 = segments.iter().map(|&s| u32::from(s) + 1).sum();
    let mut file = b"HAIR".to_vec();
    push_u32(&mut file, &[segments.len() as u32, points, bits, segments[0].into()]);
    push_f32(&mut file, &[0.1, 0.0, 1.0, 0.5, 0.25]);
    file.resize(128, b' ');
    if bits & 1 != 0 {
        segments.iter().for_each(|s| file.extend(s.to_le_bytes()));
    }
    for (bit, width) in [(1, 3), (2, 1), (3, 1), (4, 3)] {
        let push = if bit < 3 { push_ramp } else { push_shares };
        if bits & (1 << bit) != 0 {
            push(&mut file, points * width);
        }
    }
    file
}

fn push_u32(file: &mut Vec<u8>, values: &[u32]) {
    file.extend(values.iter().flat_map(|value| value.to_le_bytes()));
}

fn push_f32(file: &mut Vec<u8>, values: &[f32]) {
    file.extend(values.iter().flat_map(|value| value.to_le_bytes()));
}

/// Numbers from 0 to 1.
fn push_shares(file: &mut Vec<u8>, count: u32) {
    (0..count).for_each(|i| push_f32(file, &[(i % 9) as f32 * 0.125]));
}

fn push_ramp(file: &mut Vec<u8>, count: u32) {
    (0..count).for_each(|i| push_f32(file, &[i as f32 * 0.125]));
}
