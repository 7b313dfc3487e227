//! Textures and images that are no longer needed when references have moved to new textures.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use serde_json::Value;

use super::texture::{NewTexture, references};

/// Textures and images that may be overwritten.
pub struct Freed {
    /// The old textures that become each new texture.
    pub replaced: Vec<Vec<usize>>,
    /// The new texture that each of these old textures becomes.
    pub becomes: BTreeMap<usize, usize>,
    /// Images that only these old textures name.
    pub images: BTreeSet<usize>,
}

impl Freed {
    /// Finds the unneeded objects of `root`, the document's JSON before any edit. If the references of an old texture
    /// move to several new textures, the old texture becomes the first of them that replaces no other texture, or else
    /// the first.
    pub fn of(root: &Value, textures: &[NewTexture]) -> Self {
        let mut targets = HashMap::new();
        for (new, texture) in textures.iter().enumerate() {
            for slot in &texture.slots {
                targets.entry(slot.pointer.as_str()).or_insert(new);
            }
        }
        let list = root.get("textures").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
        // The new textures to which all references of an old texture move, or `None` if some references stay.
        let mut moves: BTreeMap<usize, Option<Vec<usize>>> = BTreeMap::new();
        for (pointer, old) in references(root) {
            let all = moves.entry(old).or_insert_with(|| Some(Vec::new()));
            match (all, targets.get(pointer.as_str())) {
                (Some(news), Some(new)) => news.push(*new),
                (all, _) => *all = None,
            }
        }
        let mut replaced: Vec<Vec<usize>> = vec![Vec::new(); textures.len()];
        let mut becomes = BTreeMap::new();
        for (old, news) in moves.into_iter().filter(|(old, _)| *old < list.len()) {
            let Some(news) = news else { continue };
            let free = news.iter().find(|new| replaced[**new].is_empty());
            if let Some(new) = free.or(news.first()) {
                replaced[*new].push(old);
                becomes.insert(old, *new);
            }
        }
        let images = |kept: bool| -> BTreeSet<usize> {
            let textures = list.iter().enumerate().filter(|(index, _)| becomes.contains_key(index) != kept);
            textures.flat_map(|(_, texture)| images_of(texture)).collect()
        };
        let images = images(false).difference(&images(true)).copied().collect();
        Self { replaced, becomes, images }
    }
}

/// Returns the images that a texture names in any extension. The image of the core `source` is first.
pub fn images_of(texture: &Value) -> Vec<usize> {
    let extensions = texture.get("extensions").and_then(Value::as_object);
    let sources = extensions.into_iter().flat_map(|e| e.values()).filter_map(|e| e.get("source"));
    let all = texture.get("source").into_iter().chain(sources);
    all.filter_map(Value::as_u64).filter_map(|i| usize::try_from(i).ok()).collect()
}
