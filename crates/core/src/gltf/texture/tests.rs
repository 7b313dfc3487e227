use super::*;
use serde_json::json;

#[test]
fn stems_are_file_names_or_given_names() {
    let stem = |image: Value, texture: Value| {
        let root = json!({ "images": [image], "textures": [texture] });
        texture_source(&root, 0).unwrap().stem()
    };
    let unnamed = json!({ "source": 0 });
    let named = json!({ "source": 0, "name": "Bricks" });
    assert_eq!(stem(json!({ "uri": "maps/wall%20n.png", "name": "w" }), named.clone()), "wall n");
    assert_eq!(stem(json!({ "bufferView": 3, "name": "wall.v2.PNG" }), named.clone()), "wall.v2");
    assert_eq!(stem(json!({ "bufferView": 3, "name": "wall.v2" }), named.clone()), "wall.v2");
    assert_eq!(stem(json!({ "bufferView": 3, "name": "" }), named.clone()), "Bricks");
    assert_eq!(stem(json!({ "bufferView": 3, "name": ".png" }), unnamed.clone()), ".png");
    assert_eq!(stem(json!({ "bufferView": 3 }), unnamed.clone()), "image3");
    assert_eq!(stem(json!({ "uri": "data:,x", "name": "peel" }), unnamed.clone()), "peel");
    assert_eq!(stem(json!({ "uri": "data:,x" }), unnamed), "image");
}

#[test]
fn textures_with_equal_image_and_sampler_are_one() {
    let root = json!({
        "images": [{ "uri": "a.png" }, { "uri": "b.png" }, { "uri": "a.png" }],
        "samplers": [{}],
        "textures": [{ "source": 0 }, { "source": 2 }, { "source": 1 }, { "source": 0, "sampler": 0 }],
    });
    let mut textures = Textures::of(&root);
    let all: Vec<_> = (0..4).map(|i| textures.get(i).unwrap()).collect();
    assert!(Arc::ptr_eq(&all[0], &all[1]) && Arc::ptr_eq(&all[0], &textures.get(0).unwrap()));
    assert!(!Arc::ptr_eq(&all[0], &all[2]) && !Arc::ptr_eq(&all[0], &all[3]));
    assert!(Arc::ptr_eq(&all[0].location, &all[3].location));
}
