//! The sizes of meshes in the scenes: the transforms of their nodes, and why sizes may change.

use std::collections::BTreeSet;

use serde::Deserialize;
use serde_json::Value;

/// The matrix M^T M of the linear part M of a transform. |M x|^2 = x^T (M^T M) x, whatever rotation M contains.
pub type Metric = [[f64; 3]; 3];

/// Most metrics that are kept for one mesh. With more, a single upper bound replaces all of them.
const MAX_METRICS: usize = 64;

/// The sizes of a mesh in the scenes of a document.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Placement {
    /// No node of a scene draws the mesh.
    #[default]
    Absent,
    /// Metrics of the nodes that draw the mesh. Each node has a metric in the list that is at least its own.
    At(Vec<Metric>),
    /// The size of the mesh may change.
    Unsteady(Unsteady),
}

/// Why the size of a mesh may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unsteady {
    /// Morph targets move its vertices.
    #[error("morph targets move its vertices")]
    Morph,
    /// The joints of a skin move its vertices.
    #[error("a skin moves its vertices")]
    Skin,
    /// `EXT_mesh_gpu_instancing` with `SCALE`.
    #[error("its instances have scales of their own")]
    Instances,
    /// An animation of a node's scale.
    #[error("an animation changes its scale")]
    Scale,
}

/// A node that cannot be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("node {0} cannot be read")]
pub struct BadNode(pub usize);

/// Returns the placement of each mesh of `root`, the document's JSON, in all scenes together.
///
/// # Errors
/// [`BadNode`] for a node of a scene that glTF 2.0 does not allow.
pub fn placements(root: &Value) -> Result<Vec<Placement>, BadNode> {
    let list = |name: &str| root.get(name).and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let (nodes, motion) = (list("nodes"), Motion::of(root));
    let mut placements = vec![Placement::default(); list("meshes").len()];
    let mut is_visited = vec![false; nodes.len()];
    let roots = list("scenes").iter().filter_map(|scene| scene.get("nodes")?.as_array()).flatten();
    let index = |node: &Value| node.as_u64().and_then(|n| usize::try_from(n).ok()).unwrap_or(usize::MAX);
    let mut open: Vec<(usize, Result<Metric, Unsteady>)> = roots.map(|node| (index(node), Ok(IDENTITY))).collect();
    while let Some((index, parent)) = open.pop() {
        let node = nodes.get(index).and_then(|node| Node::deserialize(node).ok()).ok_or(BadNode(index))?;
        // A node has one parent, so a node that comes again is in several scenes, or in a cycle.
        if std::mem::replace(&mut is_visited[index], true) {
            continue;
        }
        let metric = match parent {
            _ if motion.scaled_nodes.contains(&index) => Err(Unsteady::Scale),
            // Under a rotation that changes, a stretch of one axis may become a stretch of any axis.
            Ok(parent) if motion.rotated_nodes.contains(&index) => Ok(node.metric(uniform_bound(parent))),
            parent => parent.map(|parent| node.metric(parent)),
        };
        if let Some(placement) = node.mesh.and_then(|mesh| placements.get_mut(mesh)) {
            placement.add(match metric {
                _ if node.skin.is_some() => Err(Unsteady::Skin),
                _ if node.scales_instances() => Err(Unsteady::Instances),
                metric => metric,
            });
        }
        open.extend(node.children.iter().map(|child| (*child, metric)));
    }
    for (placement, mesh) in placements.iter_mut().zip(list("meshes")) {
        if has_targets(mesh) {
            placement.add(Err(Unsteady::Morph));
        }
    }
    Ok(placements)
}

fn has_targets(mesh: &Value) -> bool {
    let primitives = mesh.get("primitives").and_then(Value::as_array);
    primitives.into_iter().flatten().any(|primitive| primitive.get("targets").is_some())
}

/// Returns the materials for which an animation changes the scale or the rotation of a texture transform.
pub fn moving_coordinates(root: &Value) -> BTreeSet<usize> {
    Motion::of(root).transformed_materials
}

/// Returns the materials for which an animation changes the scale of bumps.
pub fn animated_bumps(root: &Value) -> BTreeSet<usize> {
    Motion::of(root).scaled_bumps
}

impl Placement {
    fn add(&mut self, metric: Result<Metric, Unsteady>) {
        match (&mut *self, metric) {
            (Self::Unsteady(_), _) => {}
            (_, Err(reason)) => *self = Self::Unsteady(reason),
            (Self::Absent, Ok(metric)) => *self = Self::At(vec![metric]),
            (Self::At(metrics), Ok(metric)) if metrics.contains(&metric) => {}
            (Self::At(metrics), Ok(metric)) if metrics.len() < MAX_METRICS => metrics.push(metric),
            (Self::At(metrics), Ok(metric)) => {
                let sizes = metrics.iter().chain([&metric]).map(|m| uniform_bound(*m)[0][0]);
                let largest = sizes.fold(0.0, f64::max);
                *metrics = vec![uniform(largest)];
            }
        }
    }
}

const IDENTITY: Metric = uniform(1.0);

const fn uniform(square: f64) -> Metric {
    [[square, 0.0, 0.0], [0.0, square, 0.0], [0.0, 0.0, square]]
}

/// Returns a uniform metric that stretches by at least as much as `metric` in any direction. The largest eigenvalue is
/// at most the largest sum of magnitudes of a row (Gershgorin), and equal to it if the metric is uniform.
fn uniform_bound(metric: Metric) -> Metric {
    uniform(metric.iter().map(|row| row.iter().map(|x| x.abs()).sum()).fold(0.0, f64::max))
}

#[derive(Deserialize)]
struct Node {
    mesh: Option<usize>,
    skin: Option<Value>,
    #[serde(default)]
    children: Vec<usize>,
    /// Values column by column.
    matrix: Option<[f64; 16]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
    #[serde(default)]
    extensions: serde_json::Map<String, Value>,
}

impl Node {
    /// Returns L^T `parent` L, where L is the linear part of the node's transform.
    fn metric(&self, parent: Metric) -> Metric {
        // The columns of L.
        let columns: [[f64; 3]; 3] = match &self.matrix {
            Some(m) => [[m[0], m[1], m[2]], [m[4], m[5], m[6]], [m[8], m[9], m[10]]],
            None => {
                let axes = axes(self.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]));
                let scale = self.scale.unwrap_or([1.0; 3]);
                std::array::from_fn(|i| axes[i].map(|x| x * scale[i]))
            }
        };
        columns.map(|a| columns.map(|b| product(a, parent, b)))
    }

    fn scales_instances(&self) -> bool {
        let attributes = self.extensions.get("EXT_mesh_gpu_instancing").and_then(|e| e.get("attributes"));
        attributes.is_some_and(|a| a.get("SCALE").is_some())
    }
}

/// Returns a^T `metric` b.
pub fn product(a: [f64; 3], metric: Metric, b: [f64; 3]) -> f64 {
    let image = metric.map(|row| row[0] * b[0] + row[1] * b[1] + row[2] * b[2]);
    a[0] * image[0] + a[1] * image[1] + a[2] * image[2]
}

/// Returns the axes rotated by the unit quaternion (x, y, z, w) (glTF 2.0, section 3.5.3).
fn axes([x, y, z, w]: [f64; 4]) -> [[f64; 3]; 3] {
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)],
        [2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)],
        [2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y)],
    ]
}

/// What the animations of a document change.
#[derive(Default)]
struct Motion {
    /// Nodes whose scale changes.
    scaled_nodes: BTreeSet<usize>,
    /// Nodes whose rotation changes.
    rotated_nodes: BTreeSet<usize>,
    /// Materials with a `KHR_texture_transform` whose scale or rotation changes.
    transformed_materials: BTreeSet<usize>,
    /// Materials whose bumps change their scale.
    scaled_bumps: BTreeSet<usize>,
}

impl Motion {
    fn of(root: &Value) -> Self {
        let mut motion = Self::default();
        let animations = root.get("animations").and_then(Value::as_array).into_iter().flatten();
        let channels = animations.filter_map(|a| a.get("channels")?.as_array()).flatten();
        for target in channels.filter_map(|channel| channel.get("target")) {
            let node = target.get("node").and_then(Value::as_u64).and_then(|n| usize::try_from(n).ok());
            match (target.get("path").and_then(Value::as_str), node) {
                (Some("scale"), Some(node)) => drop(motion.scaled_nodes.insert(node)),
                (Some("rotation"), Some(node)) => drop(motion.rotated_nodes.insert(node)),
                (Some("pointer"), _) => motion.add_pointer(target),
                _ => {}
            }
        }
        motion
    }

    /// Adds what the pointer of a `KHR_animation_pointer` changes.
    fn add_pointer(&mut self, target: &Value) {
        let pointer = target.pointer("/extensions/KHR_animation_pointer/pointer").and_then(Value::as_str);
        let mut parts = pointer.unwrap_or_default().trim_start_matches('/').split('/');
        let (array, index) = (parts.next(), parts.next().and_then(|i| i.parse().ok()));
        let Some(index) = index else { return };
        match (array, parts.next_back()) {
            (Some("nodes"), Some("scale")) => drop(self.scaled_nodes.insert(index)),
            (Some("nodes"), Some("rotation")) => drop(self.rotated_nodes.insert(index)),
            (Some("materials"), Some("scale" | "rotation")) if parts.any(|p| p == "KHR_texture_transform") => {
                self.transformed_materials.insert(index);
            }
            (Some("materials"), Some("scale")) => drop(self.scaled_bumps.insert(index)),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests;
