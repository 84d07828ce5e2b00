//! Skew and mesh as each firmware is told them. In: both. Out: files, and how they are loaded.
//!
//! Facts: see the readers in [`saved`](crate::controller::saved). Klipper's profile is written with `mesh_x_pps = 0`, so that it
//! puts no points of its own between these.

use std::fmt::Write;

use super::file;
use crate::controller::decimal::decimal;
use crate::controller::job::Written;
use crate::controller::saved::{HEIGHTS, Mesh, Skew};

/// The height over which `M556` is told deviations, mm. The deviations scale with it, so that any height tells the same.
const HEIGHT: f64 = 100.0;

/// The name of the profiles in Klipper's file.
const PROFILE: &str = "abbe";

/// `M852`, and the mesh point by point.
pub(super) fn marlin(skew: &Skew, mesh: Option<&Mesh>) -> Written {
    let [xy, xz, yz] = skew.factors().map(|factor| decimal(factor, 9));
    let mut text = format!("M852 I{xy} J{xz} K{yz}\n");
    let mut loading = vec![
        "the firmware must be built with SKEW_CORRECTION, SKEW_CORRECTION_FOR_Z and SKEW_CORRECTION_GCODE; send the file, then M500"
            .to_owned(),
    ];
    if let Some(mesh) = mesh {
        for (row, heights) in mesh.rows().enumerate() {
            for (column, height) in heights.iter().enumerate() {
                let _ = writeln!(text, "M421 I{column} J{row} Z{}", decimal(*height, 5));
            }
        }
        let [x, y] = mesh.nodes();
        loading.push(format!(
            "the firmware must have the same mesh: GRID_MAX_POINTS_X {} from {} to {} mm, GRID_MAX_POINTS_Y {} from {} to {} mm",
            x.len(), end(x.first()), end(x.last()), y.len(), end(y.first()), end(y.last())
        ));
        loading.push(
            "M421 writes into an existing mesh (run G29 first); M420 S1 Z0 switches it on without fading"
                .to_owned(),
        );
    }
    Written { files: vec![file("abbe.gcode", text, about(mesh))], loading, left_out: Vec::new() }
}

/// Profiles of a skew and of a mesh.
pub(super) fn klipper(skew: &Skew, mesh: Option<&Mesh>) -> Written {
    let [xy, xz, yz] = skew.factors().map(|factor| decimal(factor, 9));
    let mut text = format!("[skew_correction {PROFILE}]\nxy_skew = {xy}\nxz_skew = {xz}\nyz_skew = {yz}\n");
    let mut loading = vec![
        "include the file in printer.cfg, which must also have [skew_correction], and restart".to_owned(),
        format!("run SKEW_PROFILE LOAD={PROFILE} at the start of a print"),
    ];
    if let Some(mesh) = mesh {
        let [x, y] = mesh.nodes();
        let _ = writeln!(text, "\n[bed_mesh {PROFILE}]\nversion = 1\npoints =");
        for heights in mesh.rows() {
            let row: Vec<String> = heights.iter().map(|height| decimal(*height, 6)).collect();
            let _ = writeln!(text, "  {}", row.join(", "));
        }
        let _ = writeln!(
            text,
            "x_count = {}\ny_count = {}\nmesh_x_pps = 0\nmesh_y_pps = 0\nalgo = lagrange\ntension = 0.2",
            x.len(),
            y.len()
        );
        for (name, place) in
            [("min_x", x.first()), ("max_x", x.last()), ("min_y", y.first()), ("max_y", y.last())]
        {
            let _ = writeln!(text, "{name} = {}", end(place));
        }
        loading.push(format!(
            "run BED_MESH_PROFILE LOAD={PROFILE}; printer.cfg must also have [bed_mesh], without fade_end, since a mesh that fades out corrects only the foot of a part"
        ));
    }
    Written { files: vec![file("abbe.cfg", text, about(mesh))], loading, left_out: Vec::new() }
}

/// `M556`, and a height map.
pub(super) fn reprap(skew: &Skew, mesh: Option<&Mesh>) -> Written {
    let [x, y, z] = skew.tangents().map(|tangent| decimal(tangent * HEIGHT, 7));
    let text = format!("M556 S{HEIGHT} X{x} Y{y} Z{z} P0\n");
    let mut files = vec![file("abbe.g", text, "the skew (M556)".to_owned())];
    let mut loading = vec!["copy the line of abbe.g into config.g, and replace any M556 there".to_owned()];
    if let Some(mesh) = mesh {
        let [along, across] = mesh.nodes();
        let step = |nodes: &[f64]| match nodes {
            [first, second, ..] => decimal(second - first, 6),
            _ => decimal(0.0, 6),
        };
        let mut text = format!(
            "{HEIGHTS} v2 written by abbe\naxis0,axis1,min0,max0,min1,max1,radius,spacing0,spacing1,num0,num1\nX,Y,{},{},{},{},-1.00,{},{},{},{}\n",
            end(along.first()),
            end(along.last()),
            end(across.first()),
            end(across.last()),
            step(along),
            step(across),
            along.len(),
            across.len()
        );
        for heights in mesh.rows() {
            let row: Vec<String> =
                heights.iter().map(|height| format!("{:>7}", decimal(*height, 4))).collect();
            let _ = writeln!(text, "{}", row.join(","));
        }
        let count = format!("the mesh of {} x {} points", along.len(), across.len());
        files.push(file("heightmap.csv", text, count));
        loading.push(
            "copy heightmap.csv to /sys, then run G29 S1, and M376 H0 so that the mesh does not fade out"
                .to_owned(),
        );
    }
    Written { files, loading, left_out: Vec::new() }
}

fn about(mesh: Option<&Mesh>) -> String {
    match mesh.map(Mesh::nodes) {
        Some([x, y]) => format!("the skew and a mesh of {} x {} points", x.len(), y.len()),
        None => "the skew; Z needs no mesh".to_owned(),
    }
}

/// An end of a mesh.
fn end(place: Option<&f64>) -> String {
    let text = decimal(place.copied().unwrap_or(f64::NAN), 6);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
