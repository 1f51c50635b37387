//! Quadrilaterals from triangles: pairs are joined where the result is well shaped; then every quadrilateral is divided
//! into four and every triangle that is left into three, so that no triangle remains.

use std::collections::HashMap;

use nalgebra::{Point3, Vector3};

use super::super::quality::scaled_jacobian;
use super::super::topology::{Edge, directed, undirected};
use super::Polygon;

/// Least scaled Jacobian of two triangles joined: that of three quadrilaterals in an equilateral triangle is 0.87.
const JOINED: f64 = 0.6;

/// The quadrilaterals in `triangles`, about half as large, and their nodes.
pub(super) fn quadrilaterals(
    mut nodes: Vec<Point3<f64>>,
    triangles: &[[u32; 3]],
    polygon: &Polygon,
) -> (Vec<Point3<f64>>, Vec<[u32; 4]>) {
    let mut uses: HashMap<Edge, u32> = HashMap::new();
    for edge in triangles.iter().flat_map(|triangle| directed(triangle)) {
        *uses.entry(undirected(edge)).or_default() += 1;
    }
    let outlines = joined(&nodes, triangles);
    let mut middles: HashMap<Edge, u32> = HashMap::new();
    let mut out = vec![];
    for outline in &outlines {
        let sum: Vector3<f64> = outline.iter().map(|node| nodes[*node as usize].coords).sum();
        let centre = nodes.len() as u32;
        nodes.push(Point3::from(sum / outline.len() as f64));
        let mut middle = |edge: [u32; 2]| {
            *middles.entry(undirected(edge)).or_insert_with(|| {
                let [a, b] = edge.map(|node| nodes[node as usize]);
                nodes.push(match uses[&undirected(edge)] {
                    // The outline may turn between the two nodes.
                    1 => polygon.middle([a.xy(), b.xy()]).coords.push(0.0).into(),
                    _ => nalgebra::center(&a, &b),
                });
                nodes.len() as u32 - 1
            })
        };
        let halves: Vec<u32> = directed(outline).map(&mut middle).collect();
        let count = outline.len();
        out.extend((0..count).map(|i| [outline[i], halves[i], centre, halves[(i + count - 1) % count]]));
    }
    (nodes, out)
}

/// Triangles, and quadrilaterals of two of them: the best shaped pairs first.
fn joined(nodes: &[Point3<f64>], triangles: &[[u32; 3]]) -> Vec<Vec<u32>> {
    let mut beside: HashMap<Edge, usize> = HashMap::new();
    let mut pairs: Vec<(f64, [usize; 2], [u32; 4])> = vec![];
    for (here, triangle) in triangles.iter().enumerate() {
        for edge in directed(triangle) {
            let Some(other) = beside.insert(undirected(edge), here) else { continue };
            let apex = |of: usize| triangles[of].into_iter().find(|node| !edge.contains(node));
            let (Some(own), Some(far)) = (apex(here), apex(other)) else { continue };
            let quad = [own, edge[0], far, edge[1]];
            let quality = scaled_jacobian(&quad.map(|node| nodes[node as usize]));
            if quality > JOINED {
                pairs.push((quality, [other, here], quad));
            }
        }
    }
    // Greedy in place of a matching: triangles that are left become quadrilaterals by the division into three.
    pairs.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut is_taken = vec![false; triangles.len()];
    let mut out: Vec<Vec<u32>> = vec![];
    for (_, pair, quad) in pairs {
        if pair.iter().all(|triangle| !is_taken[*triangle]) {
            pair.iter().for_each(|triangle| is_taken[*triangle] = true);
            out.push(quad.to_vec());
        }
    }
    let left = triangles.iter().zip(&is_taken).filter(|(_, is_taken)| !**is_taken);
    out.extend(left.map(|(triangle, _)| triangle.to_vec()));
    out
}
